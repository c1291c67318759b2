// The walls of a plan as closed convex solids of their true size: one a straight wall, one a chord of an arc.
#pragma once

#include <vector>

#include "geometry/building.h"
#include "geometry/plan_walls.h"

namespace heliodon::geometry {

Occluders occluderSolids(const PlanWalls& plan);

} // namespace heliodon::geometry
