// Kernel `exact`: pairs are proven not facing, hidden or visible, or their visible part is found exactly at
// cubature points; of far pairs, at row errors from 3e-5 on, along lines across them. Behind crowds, more
// than twelve blockers (64 where a pair may err by less than 1e-4) or borders of too many edges, a point
// samples along jittered lines; its error is estimated from how points differ. No rays: errors are those of
// cubature across the edges of shadows. The plan: coplanar patches merge into large convex blockers; pairs of
// clusters, then of patches, are sorted out by shafts that leave few of them; far pairs by a product rule,
// near ones by Lambert's formula over adaptively split cells, computed once per pair, so reciprocal by
// construction.
#pragma once

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "compute/form_factors.h"

namespace heliodon::compute {

struct ExactOptions {
    double maxError = 1e-4;   // wanted RMS over rows of ||F_i - true||_2; at least 1e-7
    uint32_t maxDepth = 14;   // halvings of a cell
    bool entryErrors = false; // exactFormFactors keeps an error of each entry too, as large as the matrix
    // For lists of blockers and cells of cubature; less takes more rounds. If not given 256 MiB, and more for
    // the large tiles of discrete devices. Room for those of 16 x 16 patches, 2 kB a blocker, is needed:
    // throws std::runtime_error.
    std::optional<uint64_t> workBytes;
    std::function<void(double share)> progress; // after each pair of tiles: of all pairs of patches
    // Told when more than `longFrom` seconds are expected to go on (refinement_forecast.h), and again when
    // all is expected to take twice as long as was told: few large patches behind crowds, at errors of 1e-5,
    // and thousands of patches between hundreds of boards take minutes.
    std::function<void(double secondsLeft)> longWork;
    double longFrom = 20;
};

// So many blockers stand between two patches that the device ends loops along them early (lavapipe, 65,535
// turns in all: from about 6000 on, fewer where they have more than four corners).
struct TooManyBlockers : std::runtime_error {
    using std::runtime_error::runtime_error;
};

struct ExactStatistics {
    uint64_t partial = 0; // something stands between
    uint64_t cells = 0;   // of cubature beyond one per pair
    uint64_t windows = 0; // rounds of blocks, as many as have room: where all have, one for each two tiles
    uint64_t depthFirstSteps = 0; // levels of cells that were refined in parts, for want of room
    uint32_t blockers = 0;
};

struct ExactFormFactors {
    FormFactors factors;         // report.claimedRowError is set
    std::vector<float> rowError; // per patch: estimated ||F_i - true||_2, conservative
    // If asked for, n x n: |F_ij - true| is below on 99 of 100 entries. What pairs were held to, and the
    // disagreement of their rules where they were integrated, of patches in several pieces the root of the
    // sum of their squares; nothing where they are proven to exchange nothing.
    std::vector<float> entryError;
    ExactStatistics statistics;
};

// Part of the matrix: F of rows [firstRow, firstRow + rows) and columns [firstColumn, firstColumn + columns).
struct ExactTile {
    uint32_t firstRow = 0, rows = 0, firstColumn = 0, columns = 0;
    const float* values = nullptr; // rows x columns, row-major; valid during the call
};

// Every patch of a room blocks from both sides; patches of different rooms exchange nothing. Patches must be
// planar and convex; degenerate ones have zero rows and columns. Memory: the dense matrix and about 0.5 GB,
// up to 3 GB of a discrete device's own.
// Throws TooManyBlockers.
ExactFormFactors exactFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                                  const ExactOptions& options = {});

// For matrices that do not fit: hands over every entry once, in tiles of at most about 2300 x 2300 (8200 x
// 8200 of discrete devices) in no set order (F of both halves comes from one computation, so a tile and its
// mirror image follow one another). Memory: about 0.5 GB, of discrete devices 2, however many patches.
// `factors.values` of the result is empty.
ExactFormFactors exactFormFactorTiles(gpu::Device& device, const geometry::PatchMesh& mesh,
                                      const ExactOptions& options,
                                      const std::function<void(const ExactTile&)>& take);

} // namespace heliodon::compute
