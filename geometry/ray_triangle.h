// Where a ray meets a triangle, after T. Moller and B. Trumbore (1997).
#pragma once

#include <algorithm>
#include <optional>

#include <glm/geometric.hpp>

namespace heliodon::geometry {

struct ShellTriangle {
    glm::dvec3 a, b, c;

    glm::dvec3 middle() const { return (a + b + c) / 3.0; }
};

// Whether its height over its longest side is `height` at most.
inline bool isThin(const ShellTriangle& t, double height) {
    const double longest =
        std::max({glm::distance(t.a, t.b), glm::distance(t.b, t.c), glm::distance(t.c, t.a)});
    return glm::length(glm::cross(t.b - t.a, t.c - t.a)) <= height * longest;
}

// No one's normal or edge: how often rays along it pass through a closed shell tells inside from outside.
constexpr glm::dvec3 kOddWay{0.5773, 0.6491, 0.4963};

// How far along `way`, in its lengths, from `from` on; none where the triangle is not met. Borders count as
// met, but for rays within the triangle's plane.
inline std::optional<double> distanceTo(const ShellTriangle& t, glm::dvec3 from, glm::dvec3 way) {
    const glm::dvec3 u = t.b - t.a, v = t.c - t.a, q = glm::cross(way, v), s = from - t.a;
    const double det = glm::dot(u, q);
    if (det == 0) return std::nullopt;
    const glm::dvec3 r = glm::cross(s, u);
    const double a = glm::dot(s, q) / det, b = glm::dot(way, r) / det, along = glm::dot(v, r) / det;
    if (!(a >= 0 && b >= 0 && a + b <= 1 && along > 0)) return std::nullopt;
    return along;
}

} // namespace heliodon::geometry
