// Kernel `hemicube` as a matrix: rows of hemicubes, the entries of near pairs, which one point cannot see
// right, in closed form, and both measurements of each other pair averaged.
#pragma once

#include "compute/form_factors.h"

namespace heliodon::compute {

struct RefinedHemicubeOptions {
    uint32_t resolution = 64;
    // Viewpoints a patch. Four times as many where row sums as the patch's own points and as the others see
    // them differ by more than pixels explain, as beside the edges of blockers: of few rows.
    uint32_t points = 1;
    // Pairs whose sizes (roots of area, more of patches that are long) together exceed this share of their
    // distance count as near. Lower costs time and hardly lowers the error, since pixels are what is left.
    double near = 0.7;
    // Of a near pair's form factor. The default is well below what 64 pixels leave over a row.
    double pairTolerance = 2e-3;
};

// Parts of the claimed row error, a 99th percentile (their squares sum to its square): of near pairs, which
// the tolerance lowers, and of the others, which pixels and points lower.
struct RefinedHemicube {
    FormFactors factors;
    double nearError = 0, farError = 0;
};

// A_i F_ij = A_j F_ji. Rows then close to about the error of their entries, no longer by construction.
RefinedHemicube refinedHemicubeFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                                           const RefinedHemicubeOptions& options);

} // namespace heliodon::compute
