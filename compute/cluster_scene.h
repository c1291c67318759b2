// Clusters of coplanar triangles and what may stand between them, on the device; and what pairs of triangles
// exchange, by shaders/hierarchical_leaves.comp: the integral round both borders times the visible share of
// rays.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "compute/bvh.h"
#include "compute/gpu/kernel.h"
#include "compute/patch_tree.h"
#include "shaders/io/hierarchical.io.h"

namespace heliodon::compute {

struct ClusterScene {
    ClusterScene(gpu::Device& device, const geometry::PatchMesh& mesh);

    PatchTree tree;
    Bvh blockers; // of compute/convex_regions.h; nodeCount 0: nothing can stand between two patches
    uint32_t blockerCount = 0; // regions
    gpu::Buffer nodes, leaves; // texels of shaders/io/hierarchical.io.h
};

class LeafExchanges {
public:
    LeafExchanges(gpu::Device& device, const ClusterScene& scene);

    // Links of pairs of leaf nodes that exchange anything, in no set order. About 1 us of one core a pair
    // with blockers, 0.2 us without, more where a pair is partly hidden. `tolerance`: of one form factor.
    void run(std::span<const glm::uvec2> pairs, double tolerance, std::vector<io::HierarchicalLink>& links);

private:
    gpu::Device* device_;
    const ClusterScene* scene_;
    gpu::Kernel kernel_;
    gpu::Buffer pairs_, counters_, links_;
};

} // namespace heliodon::compute
