#include "geometry/triangle_rays.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

namespace heliodon::geometry {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

std::vector<Bounds> boxesOf(const std::vector<ShellTriangle>& triangles, double tolerance) {
    std::vector<Bounds> out;
    for (const ShellTriangle& t : triangles) {
        const Bounds box = boundsOf(std::array{t.a, t.b, t.c});
        out.push_back({box.low - tolerance, box.high + tolerance});
    }
    return out;
}

} // namespace

TriangleRays::TriangleRays(std::vector<ShellTriangle> triangles, double tolerance)
    : triangles_(std::move(triangles)), boxes_(boxesOf(triangles_, tolerance)), tree_(boxes_) {}

double TriangleRays::nearest(glm::dvec3 from, glm::dvec3 way, double reach) const {
    double least = kInfinite;
    tree_.anyAlong(from, way, reach, [&](uint32_t i) {
        if (const auto at = distanceTo(triangles_[i], from, way); at && *at <= reach)
            least = std::min(least, *at);
        return false; // look at all
    });
    return least;
}

bool TriangleRays::anyWithin(glm::dvec3 from, glm::dvec3 way, double reach) const {
    return tree_.anyAlong(from, way, reach, [&](uint32_t i) {
        const auto at = distanceTo(triangles_[i], from, way);
        return at && *at <= reach;
    });
}

bool TriangleRays::enclose(glm::dvec3 p) const {
    size_t met = 0;
    tree_.anyAlong(p, kOddWay, kInfinite, [&](uint32_t i) {
        met += distanceTo(triangles_[i], p, kOddWay).has_value();
        return false; // count all
    });
    return met % 2 == 1;
}

} // namespace heliodon::geometry
