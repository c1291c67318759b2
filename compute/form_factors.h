// Form factors of a PatchMesh, whichever kernel makes them.
// F(i, j) = 1/A_i int_i int_j V cos cos / (pi r^2): the fraction of what leaves patch i that reaches patch j.
// Every patch blocks from both sides, radiates and receives on its front. Openings are patches like any
// other: light that reaches them leaves.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
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
    std::string kernel = "auto"; // "auto" or one of formFactorKernels()
    // Of `hemicube`: pixels along one side of the top face, odd ones rounded up. Of `montecarlo`: R x R rays
    // a patch, to the next power of two up to 65536. Others have none.
    uint32_t resolution = 64;
    uint32_t points = 1; // viewpoints a patch, of `hemicube`
    // Wanted RMS over rows of ||F_i - true||; 0: as resolution says, or 1e-3. Kernels with a resolution raise
    // it, and points, until the error that they claim is below; the others refine until theirs is.
    double maxError = 0;
    // Wanted error of radiosity over its largest value, for rooms whose largest reflectance is `reflectance`
    // (0: that of the mesh's materials, of any channel); used when positive, in place of maxError: rows are
    // asked to be within e (1 - rho) / rho. What errors of one sign do (rows that do not close) is more.
    double maxRadiosityError = 0, reflectance = 0;
    // The matrix is for light that goes round, to which sums of rows matter more than entries: `auto` takes
    // links, whose sums may be off by ten times the row error, for coarse errors only. Where no error is
    // asked and visible polygons would take minutes, behind crowds of blockers, rays to a row error of 5e-3.
    bool forLight = false;
    // Told how much of the work is done, by `exact` at more than about 2300 patches.
    std::function<void(double share)> progress;
    // Told by `exact` where it expects to take more than `longFrom` seconds more: ExactOptions::longWork.
    std::function<void(double secondsLeft)> longWork;
    double longFrom = 20;
};

// Rows of closed rooms whose sums are off by more are worth a warning.
constexpr double kClosureBound = 0.05;

// Of the finished matrix, before any normalisation.
struct FormFactorReport {
    std::string kernel, why;             // what was chosen and why
    uint32_t resolution = 0, points = 0; // as used; points of `montecarlo`: rays a patch
    // With the choice of the kernel; of a whole matrix without closure and reciprocity, which are measured
    // after.
    double seconds = 0;
    // |sum_j F_ij - 1| over all rows: errors only where rooms are closed.
    double closureMax = 0, closureRms = 0;
    // RMS over pairs of |A_i F_ij - A_j F_ji| / mean patch area; 0 where both are one number by construction,
    // none where that is not so and no whole matrix was there to measure.
    std::optional<double> reciprocityRms;
    // The kernel's own estimate of the RMS row error; of `hemicube`, `hierarchical` and `montecarlo`, which
    // sample theirs, its 99th percentile. 0 when it makes none.
    double claimedRowError = 0;
    // How many times what was asked the claim may be before it counts as missed: claims lie above the errors.
    double caution = 1.5;
    double claimedRadiosityError = 0; // what that gives of radiosity over its largest value, when asked for
    // Of `hierarchical` and `hemicube` (not streamed): what the worst row's sum may be off by; else 0. Both
    // claims are raised to what rows have above one, of any kernel, and a warning says so.
    double claimedRowSumError = 0;
    std::vector<std::string> skipped; // what was not modelled, with the reason
    std::vector<std::string> warnings;
};

struct FormFactors {
    uint32_t patchCount = 0;
    gpu::Buffer values; // float32, patchCount x patchCount, row-major
    FormFactorReport report;
};

// Groups of two and more patches of one room with the same corners the same way round, each in order, by
// their first. n log n.
std::vector<std::vector<uint32_t>> patchesInOnePlace(const geometry::PatchMesh& mesh);

// Fills in closure and reciprocity of a matrix; raises its claims where rows sum to more than one and where
// patches lie in one place (patchesInOnePlace). About 15 ms for 2000 patches.
void measureFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh, const gpu::Buffer& values,
                        FormFactorReport& report);

// Names that FormFactorOptions::kernel takes, without "auto".
std::span<const std::string_view> formFactorKernels();

// Rows of entries or a part of them, as they come.
struct FormFactorTile {
    uint32_t firstRow = 0, rows = 0, firstColumn = 0, columns = 0;
    std::span<const float> values; // rows x columns, row-major; valid during the call
};

// Every entry once (again from the start where `auto` cannot go on with visible polygons: what comes later
// counts), in tiles in no set order: for matrices that need not fit into memory, which stays below
// about 1 GB however many patches. `hemicube` and `montecarlo` give their rows without the averaging of both
// ends, and no reciprocity; `montecarlo` chooses its rays by a sample of the rows, `hemicube`, whose rows say
// nothing of their error, refuses maxError and maxRadiosityError. Throws as computeFormFactors.
FormFactorReport streamFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                                   const FormFactorOptions& options,
                                   const std::function<void(const FormFactorTile&)>& take);

// The whole matrix, in the device's memory, beside what its kernel needs (its header says). Throws
// geometry::InputError on an unknown kernel name, gpu::Error where there is no room, TooManyBlockers
// (exact_form_factors.h) by `exact` alone: `auto` goes on with links then.
FormFactors computeFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                               const FormFactorOptions& options = {});

} // namespace heliodon::compute
