// Form factors of a PatchMesh, whichever kernel makes them.
// F(i, j) = 1/A_i int_i int_j V cos cos / (pi r^2): the fraction of what leaves patch i that reaches patch j.
// Every patch blocks from both sides, radiates and receives on its front. Openings are patches like any
// other: light that reaches them leaves.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compute/gpu/buffer.h"
#include "geometry/patch_mesh.h"

namespace heliodon::gpu {
class Device;
}

namespace heliodon::compute {

struct FormFactorOptions {
    std::string kernel = "auto"; // "auto", "hemicube", "exact", ...
    uint32_t resolution = 64;    // of the hemicube's top face, pixels along one side; even
    uint32_t points = 1;         // per patch, for kernels that sample the patch
    double maxError = 0;         // wanted RMS over rows of ||F_i - true||; 0: as resolution says
};

// Measured on the finished matrix, before any normalisation.
struct FormFactorReport {
    std::string kernel, why; // what was chosen and why
    uint32_t resolution = 0, points = 0;
    double seconds = 0;
    double closureMax = 0, closureRms = 0; // |sum_j F_ij - 1| over rows of closed rooms
    double reciprocityRms = 0;             // RMS over pairs of |A_i F_ij - A_j F_ji| / mean patch area
    double claimedRowError = 0;       // the kernel's own estimate of the RMS row error; 0 when it makes none
    std::vector<std::string> skipped; // what was not modelled, with the reason
};

struct FormFactors {
    uint32_t patchCount = 0;
    gpu::Buffer values; // float32, patchCount x patchCount, row-major
    FormFactorReport report;
};

// Fills in closure and reciprocity of a matrix. About 15 ms for 2000 patches.
void measureFormFactors(const geometry::PatchMesh& mesh, const gpu::Buffer& values, FormFactorReport& report);

// Names that FormFactorOptions::kernel takes, without "auto".
std::span<const std::string_view> formFactorKernels();

// Throws geometry::InputError on an unknown kernel name.
FormFactors computeFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                               const FormFactorOptions& options = {});

} // namespace heliodon::compute
