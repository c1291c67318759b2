// What calibrations report alike.
#pragma once

#include <nlohmann/json.hpp>

#include "geometry/rig.h"

namespace heliodon::app {

nlohmann::json lensReport(const geometry::Lens& lens);

} // namespace heliodon::app
