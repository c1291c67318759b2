// Raises the smallest angles of a triangulation that is even already.
#pragma once

#include <cstddef>

#include "geometry/planar_net.h"

namespace heliodon::geometry {

// Moves single points so that the smallest angle round them grows; where that is not enough, those near a bad
// triangle together, or adds a point there, where it helps. `edge`: of the triangles wanted. Returns how many
// points it added, at most `mostAdded`.
size_t raiseAngles(PlanarNet& net, double edge, size_t mostAdded);

} // namespace heliodon::geometry
