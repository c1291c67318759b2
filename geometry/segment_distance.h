// How far a point lies from a segment, in the plane or in space.
#pragma once

#include <algorithm>

#include <glm/geometric.hpp>

namespace heliodon::geometry {

// Of the nearest of its points, from a on; a segment without length is one point. Vector: glm::dvec2 or
// glm::dvec3.
template<class Vector> double placeOnSegment(Vector p, Vector a, Vector b) {
    const Vector d = b - a;
    const double square = glm::dot(d, d);
    return square > 0 ? std::clamp(glm::dot(p - a, d) / square, 0.0, 1.0) : 0;
}

template<class Vector> double distanceToSegment(Vector p, Vector a, Vector b) {
    return glm::length(p - a - placeOnSegment(p, a, b) * (b - a));
}

} // namespace heliodon::geometry
