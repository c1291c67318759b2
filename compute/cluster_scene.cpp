#include "compute/cluster_scene.h"

#include <glm/vec4.hpp>

#include "compute/convex_regions.h"
#include "compute/texel.h"
#include "geometry/bounds.h"

namespace heliodon::compute {

namespace {

constexpr uint32_t kBlockerCorners = 8;

} // namespace

ClusterScene::ClusterScene(gpu::Device& device, const geometry::PatchMesh& mesh) {
    const std::vector<ConvexRegion> regions = blockingRegions(mesh, kBlockerCorners);
    tree = buildPatchTree(mesh, regions);
    blockerCount = static_cast<uint32_t>(regions.size());
    diagonal = geometry::boundsOf(mesh.vertices).diagonal();
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
        nodeTexels.push_back({node.child, node.room, bitsOf(node.reachU), bitsOf(node.reachV)});
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

} // namespace heliodon::compute
