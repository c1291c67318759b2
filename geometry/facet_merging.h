// Curved walls of models with facets much narrower than triangles: as wide as those, as a sketch's are.
#pragma once

#include <vector>

#include "geometry/building.h"
#include "geometry/mesh_domains.h"

namespace heliodon::geometry {

// Where a wall that is unrolled whole, from floor to ceiling, has facets narrower than 0.62 `edge` (metres),
// some of the folds between them are left out, above and below at once: what stays are facets of two or more,
// about 0.93 edges wide. Not where the wall turns by more than 0.25 radians along an edge: that would take
// more of the room than 1 or 2 %. Folds stay where anything else has a corner, or would be cut off.
void mergeFacets(const Building& building, std::vector<MeshDomain>& domains, double edge);

} // namespace heliodon::geometry
