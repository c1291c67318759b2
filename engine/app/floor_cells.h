// Which patches of a floor, seen from above, lie where.
#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "geometry/patch_mesh.h"

namespace heliodon::app {

class FloorCells {
public:
    // Of patches that look up; mesh must outlive this.
    FloorCells(const geometry::PatchMesh& mesh, const std::vector<size_t>& patches);

    // Whether x, z lies over one of them or on its edge. Cost: the few patches about there.
    bool covers(glm::dvec2 p) const;

private:
    // Not below 0 nor beyond the last.
    glm::ivec2 cellOf(glm::dvec2 p) const;
    size_t at(int x, int y) const { return static_cast<size_t>(y * side_ + x); }

    const geometry::PatchMesh& mesh_;
    glm::dvec2 low_{1e300}, high_{-1e300};   // of all that they cover, a little more
    int side_;                               // cells along each
    std::vector<std::vector<size_t>> cells_; // row by row, what reaches into each
};

} // namespace heliodon::app
