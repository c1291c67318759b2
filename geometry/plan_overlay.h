// The outlines of rooms with other polygons laid over them: partitions on the floor, skylights in the
// ceiling.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>

#include "geometry/plan_arrangement.h"
#include "geometry/plan_rooms.h"

namespace heliodon::geometry {

// Tags below `outlineTags` are edges of the outlines, in the order of rooms, loops and edges; others, less
// that, index `shapeEdge`; what lies beyond it belongs to squares where polygons touch.
struct PlanOverlay {
    PlanArrangement map;
    std::vector<int> room;  // per cell: the room that it lies in, -1 outside
    std::vector<int> shape; // per cell: the first of the other polygons over it, -1 for none
    std::vector<int>
        label; // per cell: 2 room, + 1 under a polygon; -1 outside. Slips go with their neighbour
    std::vector<std::pair<size_t, size_t>> shapeEdge; // polygon and its edge
    int32_t outlineTags = 0;
};

// What becomes of polygons that touch one another, or an outline, in a point: a square of 0.1 in there
// belongs to both or to neither.
enum class Touching : uint8_t { joined, parted };

// Outlines stay where they are. What else comes within 0.005 in of a corner or an edge without touching it is
// moved on to it, so that nothing in the result is too thin to be built.
PlanOverlay overlay(const std::vector<RoomPlan>& rooms, const std::vector<std::vector<glm::dvec2>>& shapes,
                    Touching touching);

} // namespace heliodon::geometry
