// The smallest box along the axes round points, in their unit.
#pragma once

#include <span>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vector_relational.hpp>

namespace heliodon::geometry {

struct Bounds {
    glm::dvec3 low{0}, high{0};

    glm::dvec3 centre() const { return 0.5 * (low + high); }
    double diagonal() const { return glm::length(high - low); }
    // Whether the boxes overlap, or lie no farther apart than this along any axis.
    bool isNear(const Bounds& other, double apart) const {
        return glm::all(glm::lessThanEqual(low, other.high + apart)) &&
               glm::all(glm::greaterThanEqual(high, other.low - apart));
    }
};

// Of no points: a point at the origin. Points are finite (precondition).
inline Bounds boundsOf(std::span<const glm::dvec3> points) {
    if (points.empty()) return {};
    Bounds box{points[0], points[0]};
    for (const glm::dvec3& p : points) {
        box.low = glm::min(box.low, p);
        box.high = glm::max(box.high, p);
    }
    return box;
}

inline Bounds united(const Bounds& a, const Bounds& b) {
    return {glm::min(a.low, b.low), glm::max(a.high, b.high)};
}

} // namespace heliodon::geometry
