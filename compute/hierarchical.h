// Kernel `hierarchical`: form factors as links between clusters of coplanar triangles, at the level where
// what they exchange varies little. Host half of shaders/hierarchical_*.comp. Memory and time grow about as n
// log n; A_i F_ij = A_j F_ji by construction. P. Hanrahan, D. Salzman, L. Aupperle, "A Rapid Hierarchical
// Radiosity Algorithm", 1991; here links vary linearly over both ends. Visibility is that of rays between
// both ends against the merged blockers of compute/convex_regions.h.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "compute/cluster_scene.h"
#include "compute/form_factor_operator.h"
#include "compute/form_factors.h"
#include "compute/gpu/commands.h"
#include "compute/gpu/kernel.h"
#include "shaders/io/hierarchical.io.h"

namespace heliodon::compute {

class LinkClaims;

struct HierarchicalOptions {
    // Wanted RMS over rows of ||F_i - true||. Where the estimate of what was reached is above (the claim,
    // FormFactorReport::claimedRowError, is its 99th percentile), the links that err most are made again with
    // less tolerance, up to twice; below kLeastErrorOfLinks not where pairs may be partly hidden: `exact`
    // goes on from there. Links of rows whose sums may be off by more than kSumOverRow times as much are
    // taken apart, in a few rounds; FormFactorReport::claimedRowSumError says what was reached.
    double maxError = 5e-3;
    // A claim above which they are not wanted, 0: any is. Where an eighth of the pairs, or all of them at
    // first, let a higher one be expected, no more are made: HierarchicalFormFactors::gaveUp.
    double mostClaim = 0;
};

constexpr double kSumOverRow = 10;
// The row error that samples of visibility reach in useful time.
constexpr double kLeastErrorOfLinks = 5e-4;

struct HierarchicalStatistics {
    uint64_t links = 0; // once for each pair
    uint64_t pairs = 0; // of clusters that were looked at
    uint32_t nodes = 0, blockers = 0;
    uint32_t again = 0; // rounds in which those that err most were made again
    size_t bytes = 0;   // of the links, as kept on the device
};

class HierarchicalFormFactors : public FormFactorOperator {
public:
    HierarchicalFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                            const HierarchicalOptions& options = {});

    uint32_t patchCount() const override { return patchCount_; }

    // About 4 ns a link and column on two cores of a CPU device.
    void gather(std::span<const float> in, std::span<float> out, uint32_t columns) override;

    // Rows [first, first + count) as a dense matrix would have them: count x patchCount. From any thread.
    void rows(uint32_t first, uint32_t count, std::span<float> values) const;

    // Per patch: ||F_i - true|| is below on 99 of 100, from what rays and bends leave open.
    std::span<const float> rowError() const { return rowError_; }
    // Per patch: |sum_j F_ij - true| is below on 99 of 100.
    std::span<const float> rowSumError() const { return rowSumError_; }
    // Above mostClaim, as the report has it: links are missing, there is nothing to gather.
    bool gaveUp() const { return gaveUp_; }
    const HierarchicalStatistics& statistics() const { return statistics_; }
    const FormFactorReport& report() const { return report_; }

private:
    void uploadTree();
    void makeLinks(const HierarchicalOptions& options);
    void setErrors(const LinkClaims& claims);
    void makeEntries(std::span<const io::HierarchicalLink> links);
    void makeOperator();

    // The parts of a gather: light up the trees, across the links, down to the patches. `columns`: at most
    // kMostColumns.
    void recordMoments(gpu::Commands& commands, uint32_t columns);
    void recordLinks(gpu::Commands& commands, uint32_t columns);
    void recordSpread(gpu::Commands& commands, uint32_t columns);
    struct Sweep {
        uint32_t begin, end, columns; // nodes, or patches
    };
    // An invocation for each of them and column.
    void sweep(gpu::Commands& commands, const gpu::Kernel& kernel,
               std::initializer_list<gpu::Binding> resources, Sweep over);

    // What rows() needs of a cluster and of a triangle, close together.
    struct Extent {
        glm::dvec3 centre, u, v; // axes over their squared lengths
        uint32_t firstLeaf, leafCount;
    };
    struct Spot {
        glm::dvec3 middle;
        double area;
        uint32_t patch;
    };
    void addToRow(const Extent& at, double density, double here, uint32_t slope, std::span<double> row) const;

    gpu::Device* device_;
    uint32_t patchCount_ = 0;
    bool gaveUp_ = false;
    ClusterScene scene_;
    HierarchicalStatistics statistics_;
    FormFactorReport report_;
    std::vector<uint32_t> firstEntry_, firstLeaf_,
        leafNodes_;               // per node; per patch; nodes of each patch's triangles
    std::vector<Extent> extents_; // per node
    std::vector<Spot> spots_;     // per leaf
    std::vector<double> patchArea_;
    std::vector<float> rowError_, rowSumError_;
    std::vector<glm::uvec4> hostEntries_; // of entries_, where the host does not see them
    gpu::Buffer family_, frames_, parents_, firstEntryTexels_, entries_, firstLeafTexels_, leafNodeTexels_,
        momentTexels_, received_, light_, gathered_;
};

} // namespace heliodon::compute
