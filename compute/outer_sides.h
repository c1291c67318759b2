// What a building shows of its own rooms to the outside: the other sides of their walls, floors, ceilings and
// windows.
#pragma once

#include <span>
#include <vector>

#include "compute/convex_regions.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

struct OuterSides {
    // Facing outwards, merged whatever their room or material, of at most sixteen corners, in no room;
    // without what lies on another room's surface.
    std::vector<ConvexRegion> regions;
    // All that rooms show inside, facing inwards; group: material.
    std::vector<ConvexRegion> linings;
};
OuterSides outerSides(const geometry::PatchMesh& mesh);

// Whether any wall (facing inwards) lies before the glass of any opening, beyond the plane of that, and looks
// at it with its outer side: no convex building has one. `tolerance`: metres.
bool anyWallBefore(std::span<const ConvexRegion> openings, std::span<const ConvexRegion> walls,
                   double tolerance);

// Of these regions of one plane facing either way, shares of the area of a convex polygon in that plane.
struct MaterialShare {
    uint32_t material;
    double share;
};
std::vector<MaterialShare> materialsOn(std::span<const glm::dvec3> polygon,
                                       std::span<const ConvexRegion* const> linings);

// Whether sky or ground are seen from the back of a lining past all regions, and no outer face of its wall
// lies behind it: the first of the regions stand outside. By rays from a few points.
bool isOutdoors(const ConvexRegion& lining, std::span<const ConvexRegion> regions, size_t standing,
                double tolerance);

bool inPlaneOf(const ConvexRegion& region, const ConvexRegion& other, double tolerance); // facing either way

// Whether each has a part before the other's plane.
bool lookAtOneAnother(const ConvexRegion& a, const ConvexRegion& b, double tolerance);

} // namespace heliodon::compute
