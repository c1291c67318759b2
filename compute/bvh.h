// A bounding volume hierarchy over the triangles of a mesh, for rays in compute shaders
// (shaders/lib/bvh.glsl). Built on the host by binned surface-area heuristic (I. Wald, "On fast Construction
// of SAH-based Bounding Volume Hierarchies", 2007). Nodes lie in depth-first order with the node to go on
// with when a box is missed, so rays need no stack; one such order for each octant of directions visits near
// children first.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "compute/gpu/buffer.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

struct BvhTriangle {
    std::array<glm::dvec3, 3> corner; // metres, counter-clockwise about the patch's normal
    uint32_t patch = 0, room = 0;
};

struct Bvh {
    glm::dvec3 centre{0};   // subtracted from all positions before they become float32
    double diagonal = 1;    // of the box of all triangles, at least 1e-30
    uint32_t nodeCount = 0; // of one octant's order
    gpu::Buffer nodes;      // uvec4 texels, two a node; octant after octant
    // uvec4 texels, four a triangle: corner, patch | normal, room | what a place from the corner has as its
    // product with these is its share of the one edge there, and of the other. A normal made in shaders from
    // edges would be off by their rounding over a sliver's width.
    gpu::Buffer triangles;
};

// Patches as fans of triangles.
std::vector<BvhTriangle> bvhTriangles(const geometry::PatchMesh& mesh);

// n log n: about 1 us a triangle. No triangles make a hierarchy that every ray misses.
Bvh buildBvh(gpu::Device& device, std::vector<BvhTriangle> triangles);

} // namespace heliodon::compute
