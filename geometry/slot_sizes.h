// Slots that light comes in by: walls that face one another across less than a triangle's edge beside an
// opening. Light falls off along them within about their width, which triangles as deep as the slot do not
// tell.
#pragma once

#include <vector>

#include "geometry/building.h"
#include "geometry/mesh_domains.h"

namespace heliodon::geometry {

// Per domain the longest edges that its triangles may have, metres: about 0.7 of the width of a slot, or as
// much more as keeps such triangles, with the smaller ones round the slot's mouth, at a third of `triangles`;
// infinity where that is no less than three quarters of `edge`, the length elsewhere. Openings between rooms,
// unrolled walls and walls much larger than the one that they face have none. Cost: next to nothing.
std::vector<double> slotSizes(const Building& building, const std::vector<MeshDomain>& domains, double edge,
                              double triangles);

} // namespace heliodon::geometry
