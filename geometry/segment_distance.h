// How far a point lies from a segment, in the plane or in space.
#pragma once

#include <algorithm>

#include <glm/geometric.hpp>

namespace heliodon::geometry {

// To the nearest of its points; a segment without length is one point. Vector: glm::dvec2 or glm::dvec3.
template<class Vector> double distanceToSegment(Vector p, Vector a, Vector b) {
    const Vector d = b - a;
    const double square = glm::dot(d, d),
                 t = square > 0 ? std::clamp(glm::dot(p - a, d) / square, 0.0, 1.0) : 0;
    return glm::length(p - a - t * d);
}

} // namespace heliodon::geometry
