// Directions across one another, and what two of them span.
#pragma once

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace heliodon::geometry {

// A unit vector at right angles to the unit vector `n`; horizontal where n is not nearly vertical. With it
// and cross(n, it), in that order, n makes a right-handed frame.
inline glm::dvec3 perpendicular(glm::dvec3 n) {
    const glm::dvec3 across = std::abs(n.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    return glm::normalize(glm::cross(across, n));
}

// Signed area of the parallelogram of two vectors of a plane, positive where the second lies to the left.
inline double cross(glm::dvec2 u, glm::dvec2 v) {
    return u.x * v.y - u.y * v.x;
}

// As long, turned by a quarter counter-clockwise.
inline glm::dvec2 leftOf(glm::dvec2 d) {
    return {-d.y, d.x};
}

} // namespace heliodon::geometry
