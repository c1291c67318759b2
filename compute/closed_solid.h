// What of a mesh bounds solids seen from their air, so that the backs of these patches need not be looked at.
#pragma once

#include <vector>

#include "compute/convex_regions.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

// Per region of blockingRegions: whether all that it covers belongs to closed surfaces (every edge used once
// in either direction) that no other of their room passes through, touches face to face, or lies behind, so
// that whoever starts from any patch meets their fronts before their backs. A box that stands on a floor
// which goes on beneath it is none: what the floor has there lies inside. Cost: edges x regions, and patches
// x separate surfaces round them.
std::vector<bool> regionsOfSolids(const geometry::PatchMesh& mesh, const std::vector<ConvexRegion>& regions);

// Whether that is so of all regions: then no backs at all need be looked at, from any patch.
bool onlyFrontsBlock(const geometry::PatchMesh& mesh);

// Whether all patches belong to such surfaces, crossings aside.
bool isClosedSolid(const geometry::PatchMesh& mesh);

// Of a closed solid: whether its faces are seen from outside what they enclose.
bool facesLookOutwards(const geometry::PatchMesh& mesh);

// What users are told of one.
constexpr const char* kFacesLookOutwards =
    "the faces look out of what they enclose: the side that counts is the one "
    "from which their corners run counter-clockwise, a room's inside";

} // namespace heliodon::compute
