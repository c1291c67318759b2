// How far a point lies from a segment, in the plane or in space.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

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

// To the nearest edge of a closed outline; infinite where it has no corners.
template<class Vector> double distanceToLoop(Vector p, const std::vector<Vector>& loop) {
    double least = std::numeric_limits<double>::infinity();
    for (size_t k = 0; k < loop.size(); ++k)
        least = std::min(least, distanceToSegment(p, loop[k], loop[(k + 1) % loop.size()]));
    return least;
}

} // namespace heliodon::geometry
