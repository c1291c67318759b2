#include "compute/outer_sides.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>

#include "geometry/bounds.h"
#include "geometry/clip_polygon.h"
#include "geometry/facing.h"
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

// Its middle, and towards its corners from there.
std::vector<dvec3> pointsOn(const ConvexRegion& region) {
    constexpr double kTowards = 0.7; // that round about half of the area
    dvec3 middle(0);
    for (const dvec3& p : region.corners) middle += p / double(region.corners.size());
    std::vector<dvec3> points{middle};
    for (const dvec3& p : region.corners) points.push_back(middle + kTowards * (p - middle));
    return points;
}

// `many` directions about a unit normal, as dense as the light that an even world sends: on a Fibonacci
// spiral.
std::vector<dvec3> raysAbout(dvec3 normal, size_t many) {
    const dvec3 u = geometry::perpendicular(normal), v = glm::cross(normal, u);
    std::vector<dvec3> rays;
    for (size_t k = 0; k < many; ++k) {
        const double radius2 = (static_cast<double>(k) + 0.5) / static_cast<double>(many),
                     round = 2 * std::numbers::pi * std::numbers::phi * static_cast<double>(k);
        rays.push_back(std::sqrt(radius2) * (std::cos(round) * u + std::sin(round) * v) +
                       std::sqrt(1 - radius2) * normal);
    }
    return rays;
}

std::vector<geometry::Bounds> boxesOf(std::span<const ConvexRegion> regions, double margin) {
    std::vector<geometry::Bounds> boxes;
    for (const ConvexRegion& region : regions) {
        const geometry::Bounds box = geometry::boundsOf(region.corners);
        boxes.push_back({box.low - margin, box.high + margin});
    }
    return boxes;
}

} // namespace

OuterSides outerSides(const geometry::PatchMesh& mesh) {
    OuterSides result;
    result.linings = mergedRegions(mesh, mesh.material, kMostCorners);
    const std::vector<ConvexRegion> inside =
        mergedRegions(mesh, std::vector<uint32_t>(mesh.patchCount(), 0), kMostCorners);
    const double size = geometry::boundsOf(mesh.vertices).diagonal();
    const std::vector<geometry::Bounds> boxes = boxesOf(inside, kSamePlane * size);
    geometry::PatchMesh outer;
    for (size_t k = 0; k < inside.size(); ++k) {
        const ConvexRegion& whole = inside[k];
        const dvec3 normal = normalOf(whole);
        const double least = 1e-9 * areaOf(whole.corners);
        std::vector<Polygon> parts{{whole.corners.rbegin(), whole.corners.rend()}}, rest;
        for (size_t m = 0; m < inside.size(); ++m) {
            const ConvexRegion& other = inside[m];
            if (m == k || !boxes[m].isNear(boxes[k], 0) || glm::dot(normalOf(other), normal) > 0 ||
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
            if (geometry::lookAtOneAnother(wall.corners, -normalOf(wall), opening.corners, outwards,
                                           tolerance))
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

OutsideRays::OutsideRays(std::span<const ConvexRegion> regions, double tolerance)
    : regions_(regions), boxes_(boxesOf(regions, tolerance)), tree_(boxes_), tolerance_(tolerance) {
    for (const ConvexRegion& region : regions) normals_.push_back(normalOf(region));
}

OutsideRays::Met OutsideRays::firstMet(dvec3 from, dvec3 way) const {
    double nearest = std::numeric_limits<double>::infinity();
    size_t met = SIZE_MAX;
    tree_.anyAlong(from, way, nearest, [&](uint32_t k) {
        const std::vector<dvec3>& corners = regions_[k].corners;
        const double towards = glm::dot(way, normals_[k]),
                     along = glm::dot(corners[0] - from, normals_[k]) / towards;
        // Of the two sides of a sheet the front is met, whichever rounding has first.
        if (!(along > 0 && along < nearest + (towards < 0 ? tolerance_ : -tolerance_))) return false;
        const dvec3 p = from + along * way;
        for (size_t c = 0; c < corners.size(); ++c)
            if (glm::dot(glm::cross(corners[(c + 1) % corners.size()] - corners[c], p - corners[c]),
                         normals_[k]) < 0)
                return false;
        nearest = along, met = towards < 0 ? k : SIZE_MAX;
        return false;
    });
    return {met, nearest};
}

double OutsideRays::gapBefore(const ConvexRegion& region) const {
    const dvec3 normal = normalOf(region);
    double gap = std::numeric_limits<double>::infinity();
    for (const dvec3& point : pointsOn(region))
        if (const Met met = firstMet(point + tolerance_ * normal, normal); met.front != SIZE_MAX)
            gap = std::min(gap, met.distance);
    return gap;
}

std::vector<bool> OutsideRays::seenFrom(std::span<const ConvexRegion> those) const {
    constexpr size_t kMostRays = 200'000, kRays = 2048, kLeastRays = 16; // the latter of each point
    size_t points = 0;
    for (const ConvexRegion& one : those) points += 1 + one.corners.size();
    const size_t rays = std::clamp(kMostRays / std::max<size_t>(points, 1), kLeastRays, kRays);
    std::vector<bool> seen(regions_.size(), false);
    for (const ConvexRegion& one : those) {
        const dvec3 normal = normalOf(one);
        const std::vector<dvec3> ways = raysAbout(normal, rays);
        for (const dvec3& point : pointsOn(one))
            for (const dvec3& way : ways)
                if (const size_t met = firstMet(point + tolerance_ * normal, way).front; met != SIZE_MAX)
                    seen[met] = true;
    }
    return seen;
}

bool inPlaneOf(const ConvexRegion& region, const ConvexRegion& other, double tolerance) {
    const dvec3 normal = normalOf(region);
    return std::abs(glm::dot(normal, normalOf(other))) > 0.999 &&
           std::ranges::all_of(other.corners, [&](const dvec3& p) {
               return std::abs(glm::dot(p - region.corners[0], normal)) <= tolerance;
           });
}

bool lookAtOneAnother(const ConvexRegion& a, const ConvexRegion& b, double tolerance) {
    return geometry::lookAtOneAnother(a.corners, normalOf(a), b.corners, normalOf(b), tolerance);
}

} // namespace heliodon::compute
