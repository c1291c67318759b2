// How far a point of the plane lies from a segment.
#pragma once

#include <algorithm>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace heliodon::geometry {

// To the nearest of its points; a segment without length is one point.
inline double distanceToSegment(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
    const glm::dvec2 d = b - a;
    const double square = glm::dot(d, d),
                 t = square > 0 ? std::clamp(glm::dot(p - a, d) / square, 0.0, 1.0) : 0;
    return glm::length(p - a - t * d);
}

} // namespace heliodon::geometry
