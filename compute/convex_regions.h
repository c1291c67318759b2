// Coplanar patches merged into few large convex polygons: what blocks does not depend on how it was meshed,
// and a wall of a thousand triangles blocks as one rectangle.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "geometry/outline_area.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

struct ConvexRegion {
    std::vector<glm::dvec3>
        corners; // counter-clockwise about the patches' normal, no corner on a straight edge
    uint32_t room = 0;
    uint32_t group = 0; // as given to mergedRegions; of blockingPlanes the plane, as planeNumbers has it
};
inline glm::dvec3 normalOf(const ConvexRegion& region) {
    return glm::normalize(geometry::areaVector(region.corners));
}

// A patch this near to a region's plane, as a share of the mesh's diagonal, and parallel to it lies in that
// plane: the region, which may be the patch's own wall, cannot hide anything from it. A board whose front
// lies this near to a wall hides nothing of that: both are seen.
constexpr double kSamePlane = 4e-6;

// And of those put together, which may lie on either side of their region's own plane.
constexpr double kOnePlane = 1e-6;

// A number for each patch; patches of one room and one oriented plane (to within rounding) share it.
std::vector<uint32_t> planeNumbers(const geometry::PatchMesh& mesh);

// Covers the patches of each plane and room; regions that cannot stand between any two points of their room
// (all of it on one side) are left out. At most `maxCorners` corners each (at least 4). Where patches of one
// plane overlap, each is its own region. Cost about n log n.
struct BlockingPlanes {
    std::vector<ConvexRegion> regions;
    uint32_t planes = 0; // of all patches, whether they block or not
};
BlockingPlanes blockingPlanes(const geometry::PatchMesh& mesh, uint32_t maxCorners);
std::vector<ConvexRegion> blockingRegions(const geometry::PatchMesh& mesh, uint32_t maxCorners);

// Of PatchMesh::outside: in no room, at most `maxCorners` corners each; group: material, 0 where it has none.
std::vector<ConvexRegion> outsideRegions(const geometry::PatchMesh& mesh, uint32_t maxCorners);

// Every patch whose group is not kNoGroup, merged with those of its plane, room and group.
constexpr uint32_t kNoGroup = UINT32_MAX;
std::vector<ConvexRegion> mergedRegions(const geometry::PatchMesh& mesh, std::span<const uint32_t> group,
                                        uint32_t maxCorners);

} // namespace heliodon::compute
