// The last look at light before it is written or drawn: what is no number, or infinite, is an error of the
// program, and must not leave it as a row among others.
#pragma once

#include <cstddef>
#include <span>

#include "compute/daylight_transport.h"

namespace heliodon::app {

// Throws std::runtime_error naming the first place, a sensor or patch counted from 0, some part of whose
// light, or its error, is not finite.
void expectFinite(const compute::Moment& moment);

// The same of sensors from `first` on, `records` values of each.
void expectFinite(std::span<const float> lux, size_t first, size_t records);

} // namespace heliodon::app
