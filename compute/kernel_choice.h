// Which kernel `auto` stands for, and why.
#pragma once

#include <string>

#include "compute/form_factors.h"

namespace heliodon::compute {

struct KernelChoice {
    std::string kernel, why;
    double maxError = 0;      // of rows, to ask that kernel for; 0: as its other options say
    double ofLinks = 1;       // share of maxError to ask links for, so that they keep it
    double amplification = 0; // of rows' errors into radiosity; 0: not asked
    std::string missed;       // once made: what was asked that no kernel kept, for a warning
};

// Of `auto` the kernel that gets there soonest on this kind of device, by what was measured (the table in
// docs/form-factors.md); another name stays. Cost: that of blockingPlanes.
KernelChoice chooseKernel(gpu::Device& device, const geometry::PatchMesh& mesh,
                          const FormFactorOptions& options);

// What decides between both, as means over pairs of patches of one room.
struct Obstacles {
    double blockers = 0;           // of that room
    double patchesABlocker = 0;    // of that room; anything without blockers
    bool fewPatchesAPlane = false; // as curved surfaces have
    double blockerShare = 0;       // of that room's area that a blocker has, on the mean by blockers' area
};

// The row error from which links between clusters cost less than visible polygons on a CPU device. Rays
// between clusters cost the same whatever stands between, visible polygons more with every blocker that comes
// between two patches: few where patches are small beside blockers, or where these are so large that one
// hides all. Where few patches share a plane, `exact` finds none to classify together. Where each blocker is
// a patch or two, links find no clusters either: each pair takes its own rays, up to hundreds.
double errorFromWhichLinksPay(const Obstacles& obstacles);

} // namespace heliodon::compute
