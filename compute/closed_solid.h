// Whether rooms are solids seen from their air, so that backs of patches need not be looked at.
#pragma once

#include <vector>

#include "compute/convex_regions.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

// Whether each room's patches form closed surfaces (every edge used once in either direction) that do not
// pass through one another, nor touch face to face, nor lie in one another's solid, so that whoever stands in
// front of a patch meets a front first. A box that stands on a floor which goes on beneath it is none: what
// the floor has there lies inside. `regions`: what of the mesh blocks, for crossings; without them none are
// looked for. Cost: edges x regions, and patches x separate surfaces round them.
bool isClosedSolid(const geometry::PatchMesh& mesh, const std::vector<ConvexRegion>& regions);

// Of a closed solid: whether its faces are seen from outside what they enclose.
bool facesLookOutwards(const geometry::PatchMesh& mesh);

// What users are told of one.
constexpr const char* kFacesLookOutwards =
    "the faces look out of what they enclose: the side that counts is the one "
    "from which their corners run counter-clockwise, a room's inside";

} // namespace heliodon::compute
