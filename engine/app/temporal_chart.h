// A year at a glance: days from left to right, hours from bottom to top.
#pragma once

#include <span>
#include <string>

#include "compute/daylight/weather.h"
#include "engine/app/chart.h"

namespace heliodon::app {

// `lux`: one value a record of the weather. Dark records are black, those that a file of less than a year
// lacks grey; weather and clock are named under the title.
Chart temporalChart(const daylight::Weather& weather, std::span<const float> lux, const ValueScale& scale,
                    const std::string& title);

} // namespace heliodon::app
