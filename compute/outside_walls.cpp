#include "compute/outside_walls.h"

#include <algorithm>

#include <glm/geometric.hpp>

#include "geometry/bounds.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

bool isAround(const ConvexRegion& region, dvec3 normal, dvec3 p, double tolerance) {
    for (size_t k = 0; k < region.corners.size(); ++k) {
        const dvec3 a = region.corners[k], b = region.corners[(k + 1) % region.corners.size()];
        if (glm::dot(glm::cross(normal, glm::normalize(b - a)), p - a) < -tolerance) return false;
    }
    return true;
}

// Where lines between two convex polygons on either side of a plane cross it lies in the hull of where those
// between their corners do.
bool hides(const ConvexRegion& wall, const ConvexRegion& from, const ConvexRegion& to, double tolerance) {
    const dvec3 normal = normalOf(wall);
    for (const dvec3& a : from.corners)
        for (const dvec3& b : to.corners) {
            const double before = glm::dot(normal, a - wall.corners[0]),
                         behind = -glm::dot(normal, b - wall.corners[0]);
            if (before < -tolerance || behind < -tolerance || before + behind <= tolerance) return false;
            if (!isAround(wall, normal, a + before / (before + behind) * (b - a), tolerance)) return false;
        }
    return true;
}

} // namespace

std::vector<const ConvexRegion*> seenFrom(const ConvexRegion& opening, std::span<const ConvexRegion> outside,
                                          double tolerance) {
    constexpr size_t kNearest = 16;
    std::vector<const ConvexRegion*> facing, seen;
    for (const ConvexRegion& wall : outside) {
        const dvec3 normal = normalOf(wall);
        if (std::ranges::any_of(opening.corners, [&](const dvec3& p) {
                return glm::dot(normal, p - wall.corners[0]) > tolerance;
            }))
            facing.push_back(&wall);
    }
    const dvec3 middle = geometry::boundsOf(opening.corners).centre();
    std::ranges::stable_sort(facing, {}, [&](const ConvexRegion* wall) {
        return glm::length(geometry::boundsOf(wall->corners).centre() - middle);
    });
    for (const ConvexRegion* wall : facing) {
        const auto nearest = std::span(facing).first(std::min(kNearest, facing.size()));
        if (std::ranges::none_of(nearest, [&](const ConvexRegion* other) {
                return other != wall && hides(*other, opening, *wall, tolerance);
            }))
            seen.push_back(wall);
    }
    return seen;
}

} // namespace heliodon::compute
