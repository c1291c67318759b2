// Two straight walls enclose nothing, nor do they where a room opens to the air between them: the path along
// a garden wall, the alley between two houses. Nor does one before walls of other rooms.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/plan_arrangement.h"
#include "geometry/plan_lines.h"
#include "geometry/plan_walls.h"

namespace heliodon::geometry {

// A half-edge along a wall, with air on its left.
struct SeenWall {
    uint32_t half = 0;
    int piece = 0;
};

// Takes the cells of such paths out of those inside: behind openings of straight sides, between walls side by
// side that do not end together (where they do at both ends, it is a corridor or a porch), and between one
// straight wall and those of other rooms, where both its ends are a door's width from these.
void dropPaths(const PlanWalls& plan, const PlanLines& lines, const PlanArrangement& map,
               const std::vector<bool>& solid, const std::vector<SeenWall>& seen, std::vector<bool>& inside);

} // namespace heliodon::geometry
