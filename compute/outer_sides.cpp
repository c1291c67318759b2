#include "compute/outer_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>

#include "geometry/bounds.h"
#include "geometry/clip_polygon.h"
#include "geometry/perpendicular.h"

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

constexpr double kNever = std::numeric_limits<double>::infinity();

// How far a ray gets to a region, kNever past it.
double reach(const ConvexRegion& region, dvec3 normal, dvec3 from, dvec3 towards, double tolerance) {
    const double t = glm::dot(region.corners[0] - from, normal) / glm::dot(towards, normal);
    if (!(t > tolerance) || std::isinf(t)) return kNever;
    const dvec3 p = from + t * towards;
    for (size_t k = 0; k < region.corners.size(); ++k) {
        const dvec3 a = region.corners[k], b = region.corners[(k + 1) % region.corners.size()];
        if (glm::dot(glm::cross(b - a, p - a), normal) < 0) return kNever;
    }
    return t;
}

// Spread by the cosine to the normal, on a spiral.
std::vector<dvec3> directionsAbout(dvec3 normal) {
    constexpr int kCount = 32;
    const dvec3 u = geometry::perpendicular(normal), v = glm::cross(normal, u);
    std::vector<dvec3> all;
    for (int k = 0; k < kCount; ++k) {
        const double square = (k + 0.5) / kCount, turn = 2 * std::numbers::pi * std::numbers::phi * k;
        all.push_back(std::sqrt(square) * (std::cos(turn) * u + std::sin(turn) * v) +
                      std::sqrt(1 - square) * normal);
    }
    return all;
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

bool isOutdoors(const ConvexRegion& lining, std::span<const ConvexRegion> regions, size_t standing,
                double tolerance) {
    const dvec3 outwards = -normalOf(lining);
    struct Other {
        const ConvexRegion* region;
        dvec3 normal;
        bool stands;
    };
    std::vector<Other> before;
    for (size_t k = 0; k < regions.size(); ++k)
        if (isPartBefore(regions[k].corners, lining.corners[0], outwards, tolerance))
            before.push_back({&regions[k], normalOf(regions[k]), k < standing});
    dvec3 middle(0);
    for (const dvec3& p : lining.corners) middle += p / double(lining.corners.size());
    std::vector<dvec3> points{middle};
    for (const dvec3& p : lining.corners) points.push_back(middle + 0.9 * (p - middle));
    const auto isInWall = [&](const dvec3& point) {
        std::array<double, 2> nearest{kNever, kNever}; // front, back
        for (const auto& [region, normal, stands] : before)
            if (double& t = nearest[glm::dot(normal, outwards) > 0 ? 1 : 0]; stands)
                t = std::min(t, reach(*region, normal, point, outwards, tolerance));
        return nearest[1] + tolerance < nearest[0]; // a sheet has both
    };
    const std::vector<dvec3> directions = directionsAbout(outwards);
    return std::ranges::any_of(points, [&](const dvec3& point) {
        return !isInWall(point) && std::ranges::any_of(directions, [&](const dvec3& towards) {
            return std::ranges::all_of(before, [&](const Other& other) {
                return reach(*other.region, other.normal, point, towards, tolerance) == kNever;
            });
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
