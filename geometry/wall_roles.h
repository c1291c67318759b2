// What became of each wall of a sketch, and of those that take no part, why.
#pragma once

#include <string>
#include <vector>

#include "geometry/building.h"
#include "geometry/plan_rooms.h"
#include "geometry/plan_walls.h"
#include "geometry/sketch.h"

namespace heliodon::geometry {

// By id, shorter ones first. `spaces.seen` and `partitionUsed` are empty where the plan has no rooms. Walls
// that came to nothing (`ignored`) have their reason; of the others those outside the rooms, and those that
// lie within another wall of the sketch, whose role they share, are given one.
std::vector<WallRole> wallRoles(const Sketch& sketch, const PlanWalls& plan, const PlanRooms& spaces,
                                const std::vector<bool>& partitionUsed,
                                const std::vector<IgnoredWall>& ignored);

} // namespace heliodon::geometry
