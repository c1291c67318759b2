// Curved walls of models with facets much narrower than triangles: as wide as those, as a sketch's are.
#pragma once

#include <vector>

#include "geometry/building.h"
#include "geometry/mesh_domains.h"

namespace heliodon::geometry {

// Where such a wall has facets narrower than 0.62 `edge` (metres), some of the folds between them are left
// out, above and below at once: what stays are facets of two or more, about 0.93 edges wide, and narrower
// where they would turn by more than 0.25 radians: chords take up to 1 % of the room. Folds stay where
// anything else has a corner, or would be cut off.
void mergeFacets(const Building& building, std::vector<MeshDomain>& domains, double edge);

} // namespace heliodon::geometry
