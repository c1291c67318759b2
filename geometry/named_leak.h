// A refusal of a model that does not close names the hole that matters.
#pragma once

#include "geometry/raw_model.h"

namespace heliodon::geometry {

// Where the error says that the model is open, the same with the place where the air of its largest room gets
// out (geometry/air_leak), unless that is the hole that it names. `extent`: of the model, world metres.
InputError withLeak(const InputError& error, const RawModel& model, double extent, double worldPerBuilding);

} // namespace heliodon::geometry
