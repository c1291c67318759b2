#include "compute/outer_sides.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "geometry/bounds.h"
#include "geometry/clip_polygon.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

using Polygon = std::vector<dvec3>;
constexpr uint32_t kMostCorners = 16;

double areaOf(std::span<const dvec3> polygon) {
    return polygon.size() < 3 ? 0 : 0.5 * glm::length(geometry::areaVector(polygon));
}

// Cuts a polygon along the sides of a convex one in its plane: returns what lies in it; the rest goes to
// `rest`, in convex parts of more than `least` area.
Polygon cutOut(Polygon polygon, std::span<const dvec3> hole, double least, std::vector<Polygon>* rest) {
    const dvec3 normal = geometry::areaVector(hole);
    Polygon in, out;
    for (size_t k = 0; k < hole.size() && !polygon.empty(); ++k) {
        const dvec3 inwards = glm::cross(normal, hole[(k + 1) % hole.size()] - hole[k]);
        const auto height = [&](const dvec3& p) { return glm::dot(p - hole[k], inwards); };
        if (rest) {
            geometry::clip<dvec3>(
                polygon, [&](const dvec3& p) { return -height(p); }, out);
            if (areaOf(out) > least) rest->push_back(out);
        }
        geometry::clip<dvec3>(polygon, height, in);
        polygon.swap(in);
    }
    return areaOf(polygon) > least ? polygon : Polygon{};
}

bool isPartBefore(std::span<const dvec3> corners, dvec3 at, dvec3 normal, double tolerance) {
    return std::ranges::any_of(corners, [&](const dvec3& p) { return glm::dot(p - at, normal) > tolerance; });
}

// Whether the line from `a` to `b` crosses the region between them.
bool isCrossed(const ConvexRegion& region, dvec3 normal, dvec3 a, dvec3 b, double tolerance) {
    const double before = glm::dot(a - region.corners[0], normal),
                 behind = glm::dot(b - region.corners[0], normal);
    if (std::min(std::abs(before), std::abs(behind)) <= tolerance || before * behind > 0) return false;
    const dvec3 p = a + before / (before - behind) * (b - a);
    for (size_t k = 0; k < region.corners.size(); ++k) {
        const dvec3 c = region.corners[k], d = region.corners[(k + 1) % region.corners.size()];
        if (glm::dot(glm::cross(d - c, p - c), normal) < 0) return false;
    }
    return true;
}

// Its middle, and towards its corners from there.
std::vector<dvec3> pointsOn(const ConvexRegion& region) {
    constexpr double kTowards = 0.7; // that round about half of the area
    dvec3 middle(0);
    for (const dvec3& p : region.corners) middle += p / double(region.corners.size());
    std::vector<dvec3> points{middle};
    for (const dvec3& p : region.corners) points.push_back(middle + kTowards * (p - middle));
    return points;
}

} // namespace

OuterSides outerSides(const geometry::PatchMesh& mesh) {
    OuterSides result;
    result.linings = mergedRegions(mesh, mesh.material, kMostCorners);
    const std::vector<ConvexRegion> inside =
        mergedRegions(mesh, std::vector<uint32_t>(mesh.patchCount(), 0), kMostCorners);
    const double size = geometry::boundsOf(mesh.vertices).diagonal();
    geometry::PatchMesh outer;
    for (const ConvexRegion& whole : inside) {
        const dvec3 normal = normalOf(whole);
        const double least = 1e-9 * areaOf(whole.corners);
        std::vector<Polygon> parts{{whole.corners.rbegin(), whole.corners.rend()}}, rest;
        for (const ConvexRegion& other : inside) {
            if (&other == &whole || glm::dot(normalOf(other), normal) > 0 ||
                !inPlaneOf(whole, other, kSamePlane * size))
                continue;
            rest.clear();
            for (Polygon& part : parts) cutOut(std::move(part), other.corners, least, &rest);
            parts.swap(rest);
        }
        for (const Polygon& part : parts) {
            std::vector<uint32_t> corners;
            for (const dvec3& p : part) {
                corners.push_back(static_cast<uint32_t>(outer.vertices.size()));
                outer.vertices.push_back(p);
            }
            outer.addPatch(corners, 0, geometry::Role::extra, 0, geometry::kNoRoom);
        }
    }
    result.regions = mergedRegions(outer, std::vector<uint32_t>(outer.patchCount(), 0), kMostCorners);
    return result;
}

bool anyWallBefore(std::span<const ConvexRegion> openings, std::span<const ConvexRegion> walls,
                   double tolerance) {
    for (const ConvexRegion& opening : openings) {
        const dvec3 outwards = -normalOf(opening);
        for (const ConvexRegion& wall : walls)
            if (isPartBefore(wall.corners, opening.corners[0], outwards, tolerance) &&
                isPartBefore(opening.corners, wall.corners[0], -normalOf(wall), tolerance))
                return true;
    }
    return false;
}

std::vector<MaterialShare> materialsOn(std::span<const dvec3> polygon,
                                       std::span<const ConvexRegion* const> linings) {
    std::vector<MaterialShare> shares;
    const double whole = areaOf(polygon);
    const geometry::Bounds box = geometry::boundsOf(polygon);
    for (const ConvexRegion* lining : linings) {
        if (!geometry::boundsOf(lining->corners).isNear(box, 1e-3 * box.diagonal())) continue;
        const double share =
            areaOf(cutOut({polygon.begin(), polygon.end()}, lining->corners, 1e-9 * whole, nullptr)) / whole;
        if (share <= 0) continue;
        const auto found = std::ranges::find(shares, lining->group, &MaterialShare::material);
        if (found != shares.end())
            found->share += share;
        else
            shares.push_back({lining->group, share});
    }
    return shares;
}

BackView::BackView(const ConvexRegion& lining, std::span<const ConvexRegion> regions,
                   std::span<const dvec3> normals, double tolerance)
    : back_(lining), regions_(regions), normals_(normals), tolerance_(tolerance) {
    std::ranges::reverse(back_.corners);
}

bool BackView::isOpen(dvec3 a, dvec3 b) {
    const auto crosses = [&](size_t k) { return isCrossed(regions_[k], normals_[k], a, b, tolerance_); };
    if (last_ < regions_.size() && crosses(last_)) return false;
    for (size_t k = 0; k < regions_.size(); ++k)
        if (crosses(k)) {
            last_ = k;
            return false;
        }
    return true;
}

bool BackView::sees(const ConvexRegion& other) {
    if (!lookAtOneAnother(back_, other, tolerance_)) return false;
    const dvec3 here = normalOf(back_), there = normalOf(other);
    const std::vector<dvec3> points = pointsOn(back_), targets = pointsOn(other);
    return std::ranges::any_of(points, [&](const dvec3& a) {
        return std::ranges::any_of(targets, [&](const dvec3& b) {
            return glm::dot(b - a, here) > tolerance_ && glm::dot(a - b, there) > tolerance_ && isOpen(a, b);
        });
    });
}

bool inPlaneOf(const ConvexRegion& region, const ConvexRegion& other, double tolerance) {
    const dvec3 normal = normalOf(region);
    return std::abs(glm::dot(normal, normalOf(other))) > 0.999 &&
           std::ranges::all_of(other.corners, [&](const dvec3& p) {
               return std::abs(glm::dot(p - region.corners[0], normal)) <= tolerance;
           });
}

bool lookAtOneAnother(const ConvexRegion& a, const ConvexRegion& b, double tolerance) {
    return isPartBefore(a.corners, b.corners[0], normalOf(b), tolerance) &&
           isPartBefore(b.corners, a.corners[0], normalOf(a), tolerance);
}

} // namespace heliodon::compute
