// What to say of walls that make no room: by name those that matter, and of many only some.
#pragma once

#include <string>
#include <vector>

#include "geometry/plan_rooms.h"
#include "geometry/plan_walls.h"

namespace heliodon::geometry {

// "a, b, c", and of more than eight "a, b, ... and 3 others": the first ones, by name.
std::string someOf(std::vector<std::string> ids);

// The ids of the walls nearest to what lies between the two edges of the outline, by name.
std::vector<std::string> wallsBeside(const PlanWalls& plan, const OutlineLoop& loop, size_t first,
                                     size_t end);

// Of a plan without rooms: the widest opening of the space that is nearest to one, or what makes it narrow.
std::string whyNotEnclosed(const PlanWalls& plan, const PlanRooms& found);

// Of rooms that could not be proven closed: their walls, and the low ones in them.
std::string whyNotProven(const PlanWalls& plan, const std::vector<RoomPlan>& rooms);

} // namespace heliodon::geometry
