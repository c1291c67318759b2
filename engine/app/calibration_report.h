// What calibrations report alike.
#pragma once

#include <optional>

#include <nlohmann/json.hpp>

#include "geometry/rig.h"

namespace heliodon::app {

nlohmann::json lensReport(const geometry::Lens& lens);
nlohmann::json orNull(std::optional<double> figure);

} // namespace heliodon::app
