// Which points lie in a polygon of the plane.
#pragma once

#include <cstddef>
#include <vector>

#include <glm/vec2.hpp>

namespace heliodon::geometry {

// The ray from p towards +x crosses the edge from a to b. A point whose ray crosses an odd number of a
// polygon's edges lies in it.
inline bool rayCrosses(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
    return (a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x;
}

inline bool isInside(const std::vector<std::vector<glm::dvec2>>& loops, glm::dvec2 p) {
    bool inside = false;
    for (const auto& loop : loops)
        for (std::size_t k = 0; k < loop.size(); ++k)
            if (rayCrosses(p, loop[k], loop[(k + 1) % loop.size()])) inside = !inside;
    return inside;
}

} // namespace heliodon::geometry
