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

// What the back of a lining sees past all regions, whose normals are given: what is in a wall sees nothing
// outside. All outlive this.
class BackView {
public:
    BackView(const ConvexRegion& lining, std::span<const ConvexRegion> regions,
             std::span<const glm::dvec3> normals, double tolerance);
    // Whether it sees another region's front. Told by some points of each, so a slit may be missed.
    bool sees(const ConvexRegion& other);

private:
    bool isOpen(glm::dvec3 a, glm::dvec3 b);

    ConvexRegion back_;
    std::span<const ConvexRegion> regions_;
    std::span<const glm::dvec3> normals_;
    double tolerance_;
    size_t last_ = SIZE_MAX; // that was in the way, as it often is again
};

bool inPlaneOf(const ConvexRegion& region, const ConvexRegion& other, double tolerance); // facing either way

// Whether each has a part before the other's plane.
bool lookAtOneAnother(const ConvexRegion& a, const ConvexRegion& b, double tolerance);

} // namespace heliodon::compute
