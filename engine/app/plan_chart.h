// A plan of the rooms seen from above with values of sensors as colours and lines of equal value.
#pragma once

#include <span>
#include <string>

#include "engine/app/chart.h"
#include "engine/app/scene_input.h"

namespace heliodon::app {

struct Plan {
    Chart chart;
    size_t shown; // sensors; without any there are the walls alone
};
inline constexpr const char* kEmptyPlan =
    "the plan shows no sensor: none of them looks up and stands over a floor";

// Sensors that look up and stand over a floor are shown, the first of several at one place; between them the
// value is smooth and within the range of the sensors around (plan_field.h), towards the walls that of the
// nearest sensors. Coloured is what the sensors of a room surround and, within the room, as far around that
// as a sensor is from the next (half a building metre at least). Up to twelve sensors have their numbers
// beside them and, unless they cover the floor so, colours only between them and no lines. Blue are openings:
// windows, skylights, holes; white are the tops of walls within a room.
Plan planChart(const Scene& scene, std::span<const glm::dvec3> points, std::span<const glm::dvec3> normals,
               std::span<const double> values, const ValueScale& scale, const std::string& title,
               const std::string& subtitle);

} // namespace heliodon::app
