// From pairs of clusters to links between them: host half of shaders/hierarchical_{links,leaves,rays}.comp.
// Each of the three takes pairs of one kind, so that neighbouring invocations have alike work: clusters are
// sorted out by what they exchange in the open, triangles are integrated (borders of both, or a product
// rule), and rays settle what share passes where something may stand between.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "compute/cluster_scene.h"
#include "compute/gpu/counters.h"
#include "compute/gpu/kernel.h"
#include "shaders/io/hierarchical.io.h"

namespace heliodon::compute {

struct LinkTolerance {
    double open = 0;    // of one form factor between clusters in the open
    double visible = 0; // and from what may stand between
};

// What happens to pairs, in the order in which they meet it.
enum class LinkStage { clusters, triangles, nearTriangles, rays, manyRays };
constexpr int kLinkStages = 5;

class LinkMaker {
public:
    // Has the kernels made while the caller does something else.
    static void prepareKernels(gpu::Device& device);

    // Both must outlive this.
    LinkMaker(gpu::Device& device, const ClusterScene& scene, const LinkTolerance& tolerance);

    // Of pairs that are added from now on.
    void setTolerance(const LinkTolerance& tolerance);

    // A pair of nodes to link, or their descendants. About 0.3 us of one core for each pair of clusters that
    // is looked at, 0.5 us for each of triangles, 0.1 us a ray.
    void add(uint32_t first, uint32_t second);

    // All pairs' links, by first and second node, the same on every run; some carry nothing and have an error
    // only.
    std::vector<io::HierarchicalLink> finish();

    uint64_t pairs() const { return pairCount_; } // of clusters that were looked at

private:
    void linkAcrossGaps(const PatchTree::Node& a, const PatchTree::Node& b);
    void work(size_t least);
    void run(LinkStage stage, const gpu::Buffer& in, uint32_t count);

    gpu::Device* device_;
    const ClusterScene* scene_;
    io::HierarchicalLinksParams params_{};
    std::vector<glm::uvec2> pending_, leafPairs_, nearPairs_;
    std::vector<io::HierarchicalDoubt> doubts_, longDoubts_; // the latter want many rays
    std::vector<io::HierarchicalLink> links_;
    uint64_t pairCount_ = 0;
    gpu::Buffer pairs_, doubted_;
    gpu::Counters counters_;
    gpu::Buffer next_, newLeafPairs_, newLinks_, newDoubts_, newLongDoubts_;
};

} // namespace heliodon::compute
