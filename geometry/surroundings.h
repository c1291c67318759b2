// How near the parts of a domain's outline are to its corners.
#pragma once

#include <vector>

#include "geometry/mesh_domains.h"

namespace heliodon::geometry {

// Per corner of the domain's loops: how long the edges of triangles there may be, metres. As long as its two
// edges; a little longer than it is to the nearest part of the outline that it does not belong to. A corner
// may be where one domain is small and another is wide: each has its own.
std::vector<std::vector<double>> surroundingsOf(const MeshDomain& domain);

} // namespace heliodon::geometry
