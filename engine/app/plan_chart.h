// A plan of the rooms seen from above with values of sensors as colours and lines of equal value.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "compute/sun_patches.h"
#include "engine/app/chart.h"
#include "engine/app/scene_input.h"

namespace heliodon::app {

struct Plan {
    Chart chart;
    size_t shown; // sensors; without any there are the walls alone
};
inline constexpr const char* kEmptyPlan =
    "the plan shows no sensor: none of them looks up and stands over a floor";

// What sensors have, one a sensor.
struct PlanValues {
    std::span<const glm::dvec3> points, normals;
    std::span<const double> values;
    // Direct sun among the values, where its exact edges are to be drawn: `sun` is its part of each, and a
    // plane gets `sunLux` (on one that faces it) times what `sunPatches` has. Else empty and null.
    std::span<const double> sun;
    const compute::SunPatches* sunPatches = nullptr;
    double sunLux = 0;
};

// Sensors that look up and stand over a floor are shown, the first of several at one place; between them the
// value is smooth and within the range of the sensors around (plan_field.h), towards the walls that of the
// nearest sensors. Direct sun is drawn as the sun's polygons have it, on a plane through the sensors, in
// rooms whose sensors look straight up from at most a few heights; in others it is smoothed like the rest.
// Coloured is what the sensors of a room surround and, within the room, as far around that as a sensor is
// from the next (half a building metre at least). Up to twelve sensors have their numbers beside them and,
// unless they cover the floor so, colours only between them and no lines. Blue are openings: windows,
// skylights, holes; white are the tops of walls within a room and what
// their sensors' plane cuts. Storeys of which one lies over another are
// drawn side by side, each with the height of its floors; those without sensors only where none has some.
// Without a scale it is luxScale() of what is drawn.
Plan planChart(const Scene& scene, const PlanValues& values, std::optional<ValueScale> scale,
               const std::string& title, const std::string& subtitle);

} // namespace heliodon::app
