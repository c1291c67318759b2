// How far points reach along an axis.
#pragma once

#include <algorithm>
#include <limits>
#include <span>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace heliodon::geometry {

struct Extent {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    double length() const { return high - low; }
};

inline Extent extentAlong(std::span<const glm::dvec3> points, glm::dvec3 axis) {
    Extent extent;
    for (const glm::dvec3& p : points) {
        const double at = glm::dot(p, axis);
        extent.low = std::min(extent.low, at), extent.high = std::max(extent.high, at);
    }
    return extent;
}

} // namespace heliodon::geometry
