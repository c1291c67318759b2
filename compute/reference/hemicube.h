// The hemicube in serial double precision: one ray through each pixel's middle against every patch. The
// oracle of shaders/hemicube.comp; O(pixels x patches).
#pragma once

#include <vector>

#include "compute/hemicube.h"

namespace heliodon::compute::reference {

struct HemicubeRow {
    std::vector<double> factors; // per patch
    double lost = 0;             // on back sides and through cracks
};

HemicubeRow hemicubeRow(const geometry::PatchMesh& mesh, const Viewpoint& view, uint32_t resolution);

} // namespace heliodon::compute::reference
