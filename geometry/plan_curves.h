// Outlines along curved walls: facets of equal length from where a room's outline reaches a curved wall to
// where it leaves it, and folds at the sides of partitions rather than beside them, so that no sliver of a
// facet is left beside the wall that cuts it.
#pragma once

#include <vector>

#include "geometry/plan_rooms.h"

namespace heliodon::geometry {

// Only where facets differ in length, or a side of a partition meets one near its end. They stay within the
// chord error of the wall's own (as to WallPiece::widestFacet) and enclose the same area; what would cross or
// touch other outlines of the room stays as it is.
void evenFacets(const PlanWalls& plan, std::vector<OutlineLoop>& loops);

// Likewise of curved partitions from where outlines and other partitions cross their faces
// (WallPiece::corners).
void evenPartitions(PlanWalls& plan, const std::vector<RoomPlan>& rooms);

} // namespace heliodon::geometry
