// Which flat faces look at one another.
#pragma once

#include <algorithm>
#include <span>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace heliodon::geometry {

// Whether any of the corners lies before the plane through `at`, by more than `tolerance` (metres).
inline bool isPartBefore(std::span<const glm::dvec3> corners, glm::dvec3 at, glm::dvec3 normal,
                         double tolerance) {
    return std::ranges::any_of(corners, [&](glm::dvec3 p) { return glm::dot(p - at, normal) > tolerance; });
}

// Whether each of two faces has a part before the other's plane.
inline bool lookAtOneAnother(std::span<const glm::dvec3> a, glm::dvec3 normalOfA,
                             std::span<const glm::dvec3> b, glm::dvec3 normalOfB, double tolerance) {
    return isPartBefore(a, b[0], normalOfB, tolerance) && isPartBefore(b, a[0], normalOfA, tolerance);
}

} // namespace heliodon::geometry
