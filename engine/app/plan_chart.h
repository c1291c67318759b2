// A plan of the rooms seen from above with values of sensors as colours and lines of equal value.
#pragma once

#include <span>
#include <string>

#include "engine/app/chart.h"
#include "engine/app/scene_input.h"

namespace heliodon::app {

// Sensors that look up and stand over a floor are shown, the first of several at one place; between them the
// value is smooth and within the range of the sensors around (plan_field.h), out to the walls that of the
// nearest sensors. Blue are openings: windows, skylights, holes; white
// are the tops of walls within a room.
Chart planChart(const Scene& scene, std::span<const glm::dvec3> points, std::span<const glm::dvec3> normals,
                std::span<const double> values, const ValueScale& scale, const std::string& title,
                const std::string& subtitle);

} // namespace heliodon::app
