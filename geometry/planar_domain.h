// A polygon with holes whose boundary is already sampled.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "geometry/size_field.h"

namespace heliodon::geometry {

struct PlanarDomain {
    // Boundary points in loops: outline counter-clockwise, holes clockwise.
    std::vector<glm::dvec2> boundary;
    std::vector<uint32_t> loopStart{0}; // loop k is boundary[loopStart[k] .. loopStart[k + 1])
    glm::dvec2 direction{1, 0};         // of its longest straight side
    SizeField size;                     // of the edges wanted
    double apart = 0.35;                // of the size there: how far off the boundary refinement keeps
    bool dividesSlim = true;            // refinement divides slim triangles where sizes are not uniform
    bool graded = true;                 // beside what is small triangles are small too
    // Of an unrolled wall: x of the upright folds between its facets, ascending, with points of the boundary
    // where it meets them. Triangles do not lie across them, but, where `mayLean`, for the sake of angles.
    std::vector<double> folds;
    bool mayLean = false;

    bool operator==(const PlanarDomain&) const = default;
    size_t loopCount() const { return loopStart.size() - 1; }
    uint32_t next(size_t loop, uint32_t i) const {
        return i + 1 < loopStart[loop + 1] ? i + 1 : loopStart[loop];
    }
};

} // namespace heliodon::geometry
