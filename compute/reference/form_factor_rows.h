// Single rows of F of meshes too large for the whole matrix: the oracle with its blockers merged, so that a
// wall of a thousand patches blocks as one polygon.
#pragma once

#include <vector>

#include "compute/reference/exact_form_factors.h"

namespace heliodon::compute::reference {

class FormFactorRows {
public:
    // Every patch of a room blocks from both sides.
    explicit FormFactorRows(const geometry::PatchMesh& mesh);

    // F_ij for all j, serial, double precision. `tolerance`: on the estimated error of each partly hidden
    // entry. Measured against the reference of a room with three partitions, 2088 patches: 2e-6 in the row's
    // L2 norm at 1e-7, in 0.1 to 0.5 s. May be called from several threads at once.
    std::vector<double> row(size_t i, double tolerance = 1e-7) const;

private:
    std::vector<Polygon> between(size_t i, size_t j) const;

    const geometry::PatchMesh* mesh_;
    std::vector<Polygon> polygons_;
    std::vector<glm::dvec3> areaVectors_;
    std::vector<std::vector<Polygon>> blockers_; // per room
};

} // namespace heliodon::compute::reference
