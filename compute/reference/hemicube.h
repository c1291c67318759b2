// The hemicube in serial double precision: one ray through each pixel's middle against every patch. The
// oracle of shaders/hemicube.comp; O(pixels x patches).
#pragma once

#include <vector>

#include "compute/hemicube.h"

namespace heliodon::compute::reference {

struct HemicubeRow {
    std::vector<double> factors; // per patch
    std::vector<double> sky;     // per channel and element; empty when division is 0
    double lost = 0;             // on back sides and through cracks
};

HemicubeRow hemicubeRow(const geometry::PatchMesh& mesh, const Viewpoint& view, uint32_t resolution,
                        uint32_t skyDivision = 0, uint32_t channels = 1);

} // namespace heliodon::compute::reference
