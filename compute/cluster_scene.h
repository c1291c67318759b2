// Clusters of coplanar triangles and what may stand between them, on the device: what links are refined over.
#pragma once

#include <cstdint>

#include "compute/bvh.h"
#include "compute/patch_tree.h"

namespace heliodon::compute {

struct ClusterScene {
    // The mesh has a patch at least (precondition) and is not kept. O(n log n) and an upload. Throws
    // gpu::Error.
    ClusterScene(gpu::Device& device, const geometry::PatchMesh& mesh);

    PatchTree tree;
    Bvh blockers; // of compute/convex_regions.h; nodeCount 0: nothing can stand between two patches
    uint32_t blockerCount = 0; // regions
    double diagonal = 0; // of the mesh, metres: rays begin anywhere in it, far from few small blockers, too
    gpu::Buffer nodes, leaves; // texels of shaders/io/hierarchical.io.h
};

} // namespace heliodon::compute
