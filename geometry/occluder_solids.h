// The walls of a plan as closed solids of their true size.
#pragma once

#include <vector>

#include "geometry/building.h"
#include "geometry/plan_walls.h"

namespace heliodon::geometry {

Occluders occluderSolids(const PlanWalls& plan, double chordError);

} // namespace heliodon::geometry
