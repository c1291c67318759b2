// What a building shows of its own rooms to the outside: the other sides of their walls, floors, ceilings and
// windows.
#pragma once

#include <span>
#include <vector>

#include "compute/convex_regions.h"
#include "geometry/box_tree.h"
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

// Which regions see which, by rays among them: what none meets gives each about as little of its light as one
// ray of all stands for. The regions outlive this. Cost: about 1 us a ray.
class OutsideRays {
public:
    OutsideRays(std::span<const ConvexRegion> regions, double tolerance);
    OutsideRays(const OutsideRays&) = delete;
    OutsideRays& operator=(const OutsideRays&) = delete;
    // For each region, whether the front of one of these sees its front: by 2048 rays from the middle of each
    // and from beside its corners, by fewer where there would be more than 200,000, but sixteen.
    std::vector<bool> seenFrom(std::span<const ConvexRegion> those) const;
    // Metres straight before this one to the nearest front, from the same places; infinite where there is
    // none.
    double gapBefore(const ConvexRegion& region) const;

private:
    struct Met {
        size_t front = SIZE_MAX; // none where that is a back or nothing
        double distance = 0;
    };
    Met firstMet(glm::dvec3 from, glm::dvec3 way) const;

    std::span<const ConvexRegion> regions_;
    std::vector<glm::dvec3> normals_;
    std::vector<geometry::Bounds> boxes_;
    geometry::BoxTree tree_; // of these
    double tolerance_;
};

bool inPlaneOf(const ConvexRegion& region, const ConvexRegion& other, double tolerance); // facing either way

// Whether each has a part before the other's plane.
bool lookAtOneAnother(const ConvexRegion& a, const ConvexRegion& b, double tolerance);

} // namespace heliodon::compute
