// The walls of a plan as closed convex solids of their true size: one a straight wall, one a chord of an arc.
// Where rooms see a curved wall its solids have the facets of their outlines, and straight ones end where
// these do (plan_outline), so that none stands out of the room's own wall.
#pragma once

#include <vector>

#include "geometry/building.h"
#include "geometry/plan_rooms.h"

namespace heliodon::geometry {

Occluders occluderSolids(const PlanWalls& plan, const std::vector<RoomPlan>& rooms);

} // namespace heliodon::geometry
