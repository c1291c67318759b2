#include "geometry/air_pocket.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>

#include "geometry/bounds.h"
#include "geometry/face_soup.h"
#include "geometry/shell_nesting.h"
#include "geometry/triangle_rays.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr int kSteps = 10; // along each axis of the box
constexpr int kWays = 40, kFineWays = 1000;
constexpr double kEnclosed = 0.85; // of the ways: a yard is open to the sky, half of them

// Evenly over the sphere (Fibonacci's spiral).
dvec3 way(int k, int count) {
    const double y = 1 - (2 * k + 1.0) / count, turn = k * std::numbers::pi * (3 - std::sqrt(5.0));
    return {std::sqrt(1 - y * y) * std::cos(turn), y, std::sqrt(1 - y * y) * std::sin(turn)};
}

class PocketFinder {
public:
    PocketFinder(const std::vector<ShellTriangle>& triangles, double tolerance)
        : box_{triangles[0].a, triangles[0].a}, rays_(triangles, tolerance),
          volume_(volumeWithin(triangles)) {
        for (const ShellTriangle& t : triangles) box_ = united(box_, boundsOf(std::array{t.a, t.b, t.c}));
        reach_ = glm::length(box_.high - box_.low);
    }

    std::optional<AirPocket> find() const {
        const dvec3 size = box_.high - box_.low;
        int count = 0, most = 0;
        dvec3 best(0); // where one sees most of the outside
        for (int k = 0; k < kSteps * kSteps * kSteps; ++k) {
            const dvec3 step(k % kSteps, k / kSteps % kSteps, k / kSteps / kSteps),
                p = box_.low + (step + 0.5) / double(kSteps) * size;
            if (rays_.enclose(p)) continue;
            const int open = openWays(p);
            if (open > (1 - kEnclosed) * kWays) continue;
            ++count;
            if (open > most) most = open, best = p;
        }
        const double share = count / double(kSteps * kSteps * kSteps);
        if (most == 0 || share * size.x * size.y * size.z < volume_) return std::nullopt;
        return holeSeenFrom(best);
    }

private:
    int openWays(dvec3 p) const {
        int open = 0;
        for (int k = 0; k < kWays; ++k) open += !rays_.anyWithin(p, way(k, kWays), reach_);
        return open;
    }

    // In the side of the box through which most of the outside is seen.
    AirPocket holeSeenFrom(dvec3 p) const {
        std::array<std::vector<dvec3>, 6> through;
        for (int k = 0; k < kFineWays; ++k) {
            const dvec3 w = way(k, kFineWays);
            if (rays_.anyWithin(p, w, reach_)) continue;
            int side = 0;
            double least = 1e300;
            for (int axis = 0; axis < 3; ++axis) {
                const double t = ((w[axis] > 0 ? box_.high : box_.low)[axis] - p[axis]) / w[axis];
                if (t < least) least = t, side = 2 * axis + (w[axis] > 0 ? 1 : 0);
            }
            through[static_cast<size_t>(side)].push_back(p + least * w);
        }
        const auto& points =
            *std::ranges::max_element(through, {}, [](const auto& all) { return all.size(); });
        if (points.empty()) return {p, 0, 0};
        const Bounds hole = boundsOf(points);
        const dvec3 size = hole.high - hole.low;
        const bool level = size.y < std::min(size.x, size.z); // in a floor or ceiling
        return {(hole.low + hole.high) / 2.0, level ? size.x : std::max(size.x, size.z),
                level ? size.z : size.y};
    }

    Bounds box_;
    TriangleRays rays_;
    double volume_, reach_ = 0;
};

} // namespace

std::optional<AirPocket> airPocket(const Building& building, double tolerance) {
    std::vector<ShellTriangle> triangles;
    for (const Face& face : building.faces) {
        if (building.materials[face.material].isOpening()) return std::nullopt;
        for (const auto& t : triangulateFace(building, face))
            triangles.push_back({building.vertices[t[0]], building.vertices[t[1]], building.vertices[t[2]]});
    }
    if (triangles.empty()) return std::nullopt;
    return PocketFinder(triangles, tolerance).find();
}

} // namespace heliodon::geometry
