#include "compute/cluster_scene.h"

#include <algorithm>

#include <glm/vec4.hpp>

#include "compute/convex_regions.h"
#include "compute/gpu/commands.h"
#include "compute/gpu/device.h"
#include "compute/texel.h"
#include "spirv/hierarchical_leaves_comp.h"

namespace heliodon::compute {

namespace {

constexpr uint32_t kBatch = 1u << 16; // pairs of one dispatch
constexpr uint32_t kBlockerCorners = 8;
constexpr uint32_t kLeafRays = 512; // at most: loops of one invocation stay far below 65535 turns
constexpr VkFormat kUvec4 = VK_FORMAT_R32G32B32A32_UINT;

} // namespace

ClusterScene::ClusterScene(gpu::Device& device, const geometry::PatchMesh& mesh)
    : tree(buildPatchTree(mesh)) {
    const std::vector<ConvexRegion> regions = blockingRegions(mesh, kBlockerCorners);
    blockerCount = static_cast<uint32_t>(regions.size());
    std::vector<BvhTriangle> triangles;
    for (const ConvexRegion& region : regions)
        for (size_t k = 1; k + 1 < region.corners.size(); ++k)
            triangles.push_back(
                {{region.corners[0], region.corners[k], region.corners[k + 1]}, 0, region.room});
    blockers = buildBvh(device, triangles);
    // Positions relative to the same centre as the blockers'.
    std::vector<glm::uvec4> nodeTexels, leafTexels;
    nodeTexels.reserve(5 * tree.nodes.size());
    for (const PatchTree::Node& node : tree.nodes) {
        nodeTexels.push_back(texelOf(node.centre - blockers.centre, bitsOf(node.radius)));
        nodeTexels.push_back(texelOf(node.normal, bitsOf(node.area)));
        nodeTexels.push_back(texelOf(node.axisU, node.firstLeaf));
        nodeTexels.push_back(texelOf(node.axisV, node.leafCount));
        nodeTexels.push_back({node.child, node.room, 0, 0});
    }
    for (const PatchTree::Leaf& leaf : tree.leaves) {
        const glm::dvec3 corner = leaf.corner[0] - blockers.centre,
                         rest = corner - glm::dvec3(glm::vec3(corner));
        leafTexels.push_back(texelOf(corner, bitsOf(rest.x)));
        leafTexels.push_back(texelOf(leaf.corner[1] - leaf.corner[0], bitsOf(rest.y)));
        leafTexels.push_back(texelOf(leaf.corner[2] - leaf.corner[0], bitsOf(rest.z)));
    }
    nodes = gpu::Buffer::from(device, nodeTexels, "cluster nodes");
    leaves = gpu::Buffer::from(device, leafTexels, "cluster leaves");
}

LeafExchanges::LeafExchanges(gpu::Device& device, const ClusterScene& scene)
    : device_(&device), scene_(&scene), kernel_(device, hierarchical_leaves_comp, "hierarchical leaves"),
      pairs_(device, kBatch * sizeof(glm::uvec2), "leaf pairs"),
      counters_(device, io::kHierarchicalCounters * sizeof(uint32_t), "leaf counters", gpu::Place::host),
      links_(device, kBatch * sizeof(io::HierarchicalLink), "leaf links", gpu::Place::host) {}

void LeafExchanges::run(std::span<const glm::uvec2> pairs, double tolerance,
                        std::vector<io::HierarchicalLink>& links) {
    io::HierarchicalLinksParams params{};
    params.nodeCount = scene_->blockers.nodeCount;
    params.flatness = static_cast<float>(5e-7 * scene_->blockers.diagonal);
    params.visibilityTolerance = static_cast<float>(tolerance);
    params.leafRays = kLeafRays;
    for (size_t first = 0; first < pairs.size(); first += kBatch) {
        const std::span<const glm::uvec2> part =
            pairs.subspan(first, std::min<size_t>(kBatch, pairs.size() - first));
        pairs_.upload(part);
        params.pairCount = static_cast<uint32_t>(part.size());
        gpu::Commands commands(*device_);
        commands.fill(counters_, 0);
        commands.barrier(gpu::Stage::transfer, gpu::Stage::compute);
        commands.dispatch(kernel_,
                          {gpu::texel(scene_->nodes, kUvec4), gpu::texel(scene_->leaves, kUvec4),
                           gpu::texel(scene_->blockers.nodes, kUvec4),
                           gpu::texel(scene_->blockers.triangles, kUvec4), pairs_, counters_, links_},
                          params, gpu::groupsFor(part.size(), io::kHierarchicalGroup));
        commands.barrier(gpu::Stage::compute, gpu::Stage::host);
        device_->submitAndWait(std::move(commands));
        const auto made = links_.mapped<io::HierarchicalLink>();
        links.insert(links.end(), made, made + counters_.mapped<uint32_t>()[io::kHierarchicalLinks]);
    }
}

} // namespace heliodon::compute
