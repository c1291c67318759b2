// Whether a triangle meets a cube, and which of its points is nearest to another one.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

#include "geometry/ray_triangle.h"
#include "geometry/segment_distance.h"

namespace heliodon::geometry {

// With faces along the axes, by separating axes (T. Akenine-Moeller, 2001); the triangle may be a segment or
// a point.
inline bool meetsCube(const ShellTriangle& t, glm::dvec3 middle, double half) {
    const glm::dvec3 a = t.a - middle, b = t.b - middle, c = t.c - middle;
    for (int k = 0; k < 3; ++k)
        if (std::min({a[k], b[k], c[k]}) > half || std::max({a[k], b[k], c[k]}) < -half) return false;
    const auto parts = [&](glm::dvec3 axis) {
        const double p = glm::dot(a, axis), q = glm::dot(b, axis), r = glm::dot(c, axis),
                     reach = half * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
        return std::min({p, q, r}) > reach || std::max({p, q, r}) < -reach;
    };
    const std::array edges{b - a, c - b, a - c};
    if (parts(glm::cross(edges[0], edges[1]))) return false;
    for (const glm::dvec3& e : edges)
        if (parts({0, -e.z, e.y}) || parts({e.z, 0, -e.x}) || parts({-e.y, e.x, 0})) return false;
    return true;
}

inline glm::dvec3 nearestPoint(const ShellTriangle& t, glm::dvec3 p) {
    const glm::dvec3 n = glm::cross(t.b - t.a, t.c - t.a);
    const double square = glm::dot(n, n);
    const auto isLeft = [&](glm::dvec3 a, glm::dvec3 b) {
        return glm::dot(glm::cross(b - a, p - a), n) >= 0;
    };
    if (square > 0 && isLeft(t.a, t.b) && isLeft(t.b, t.c) && isLeft(t.c, t.a))
        return p - glm::dot(p - t.a, n) / square * n;
    const auto on = [&](glm::dvec3 a, glm::dvec3 b) { return a + placeOnSegment(p, a, b) * (b - a); };
    return std::ranges::min(std::array{on(t.a, t.b), on(t.b, t.c), on(t.c, t.a)}, {},
                            [&](glm::dvec3 q) { return glm::length(q - p); });
}

inline double distance(const ShellTriangle& t, glm::dvec3 p) {
    return glm::length(nearestPoint(t, p) - p);
}

// Within `tolerance` of it: its box tells sooner where not.
inline bool isOn(const ShellTriangle& t, glm::dvec3 p, double tolerance) {
    const glm::dvec3 low = glm::min(glm::min(t.a, t.b), t.c), high = glm::max(glm::max(t.a, t.b), t.c);
    return glm::all(glm::greaterThanEqual(p, low - tolerance)) &&
           glm::all(glm::lessThanEqual(p, high + tolerance)) && distance(t, p) <= tolerance;
}

} // namespace heliodon::geometry
