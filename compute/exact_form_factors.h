// Kernel `exact`: pairs are proven not facing, hidden or visible, or their visible part is found exactly at
// cubature points. No sampling of visibility, so no noise: errors are those of cubature across the edges of
// shadows. The plan: coplanar patches merge into large convex blockers; per pair a shaft leaves few of them;
// far pairs by a product rule, near ones by Lambert's formula over adaptively split cells, computed once per
// pair, so reciprocal by construction.
#pragma once

#include <string>
#include <vector>

#include "compute/form_factors.h"

namespace heliodon::compute {

struct ExactOptions {
    double maxError = 1e-4; // wanted RMS over rows of ||F_i - true||_2; at least 1e-7
    uint32_t maxDepth = 14; // halvings of a cell
};

struct ExactStatistics {
    uint64_t pairs = 0;     // of patches, once each
    uint64_t visible = 0;   // near and proven visible: adaptive
    uint64_t partial = 0;   // something stands between
    uint64_t cells = 0;     // of cubature beyond one per pair
    uint64_t overflows = 0; // places where a capacity ran out; results there are less exact than claimed
    uint32_t blockers = 0;
    bool closed = false; // rooms are closed solids: only fronts block
    double setupSeconds = 0, sidesSeconds = 0, classifySeconds = 0, cubatureSeconds = 0;
};

struct ExactFormFactors {
    FormFactors factors;         // report.claimedRowError is set
    std::vector<float> rowError; // per patch: estimated ||F_i - true||_2, conservative
    ExactStatistics statistics;
};

// Every patch of a room blocks from both sides; patches of different rooms exchange nothing. Needs a storage
// range of 64 x 4 n bytes at least. Patches must be planar and convex; degenerate ones have zero rows and
// columns.
ExactFormFactors exactFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                                  const ExactOptions& options = {});

} // namespace heliodon::compute
