// The triangles of a mesh's patches gathered into binary trees of coplanar clusters, one for each plane and
// room, for the hierarchical kernel.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/convex_regions.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

struct PatchTree {
    struct Node {
        glm::dvec3 centre{0}, normal{0, 1, 0}; // of area
        glm::dvec3 axisU{0}, axisV{0}; // in the plane: principal directions times standard deviations of area
        double area = 0, radius = 0;   // of a disc about the centre that holds the cluster
        double reachU = 0, reachV = 0; // of its triangles' middles along the axes, in units of them
        uint32_t firstLeaf = 0, leafCount = 0; // positions of its triangles, successive
        uint32_t child = 0;                    // the first of two successive nodes; 0: one triangle
        uint32_t parent = kNone;
        uint32_t room = 0;
        // Across a narrow gap (compute/narrow_gaps.h): its leaves exchange nothing but with their `across`.
        bool covered = false;
    };
    static constexpr uint32_t kNone = 0xffffffffu;

    struct Leaf {
        std::array<glm::dvec3, 3> corner;
        uint32_t patch = 0, node = 0;
        double area = 0;
        uint32_t across = kNone; // of a covered one: the leaf that covers it, of equal shape
        // And the share of its light that misses that, times the root of its share of the smaller patch of
        // both: the mean square over a patch's triangles is then that of the patch's row.
        double misses = 0;
    };

    std::vector<Node> nodes;          // level after level, roots first
    std::vector<uint32_t> levelFirst; // levels + 1 entries
    std::vector<Leaf> leaves;

    // Coordinates of a point of a cluster's plane, in standard deviations along its axes.
    static std::array<double, 2> coordinates(const Node& node, const glm::dvec3& point);
};

// Patches that others cover across narrow gaps are cut, and what is covered has clusters of its own. Clusters
// are cut along the feet of `blockers` (compute/convex_regions.h), whose two sides see different things, and
// elsewhere halved. Triangles without area are left out. n log n, and planes times blockers.
PatchTree buildPatchTree(const geometry::PatchMesh& mesh, std::span<const ConvexRegion> blockers);

} // namespace heliodon::compute
