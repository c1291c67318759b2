// Which kernel `auto` stands for, and why.
#pragma once

#include <string>

#include "compute/form_factors.h"

namespace heliodon::compute {

struct KernelChoice {
    std::string kernel, why;
    double maxError = 0;      // of rows, to ask that kernel for; 0: as its other options say
    double amplification = 0; // of rows' errors into radiosity; 0: not asked
};

// Of `auto` the kernel that gets there soonest on this kind of device, by what was measured (the table in
// docs/form-factors.md); another name stays. Cost: that of blockingRegions and planeNumbers.
KernelChoice chooseKernel(const gpu::Device& device, const geometry::PatchMesh& mesh,
                          const FormFactorOptions& options);

// The row error from which links between clusters cost less than visible polygons on a CPU device. Rays
// between clusters cost the same whatever stands between, visible polygons more with every blocker; where
// surfaces are curved, `exact` finds no patches of one plane to classify together.
// blockers: that a pair of patches has in its room, on the average of pairs. curved: few patches a plane.
double errorFromWhichLinksPay(double blockers, bool curved);

} // namespace heliodon::compute
