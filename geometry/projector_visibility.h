// Which projector can paint which part of the rooms' surfaces.
// After the virtual heliodon's display step: the surfaces are meshed anew along the exact outlines of the
// shadows that walls cast for each projector and along the borders of its picture, and each triangle is
// labelled. How projectors share what several of them reach: projector_blend.h.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/patch_mesh.h"
#include "geometry/rig.h"

namespace heliodon::geometry {

struct ProjectorOptions {
    // A surface is painted only where n . d (d: unit vector to the projector) is larger. On curved surfaces n
    // turns smoothly from facet to facet, so that what is painted does not end in teeth.
    double leastCosine = 0.2;
    uint32_t atAnyAngle = 0; // as bits, devices without this limit: cameras, which see all that faces them
};

struct SurfaceReach {
    uint32_t surface = 0;
    double area = 0, unreachable = 0; // m2 of its projection patches; of those, what no projector reaches
};

struct ProjectorMesh {
    static constexpr uint32_t kCorner = 0xffffffff;
    std::vector<glm::dvec3>
        vertices; // metres; a corner where surfaces meet is one vertex per surface, bit for bit alike
    // Light at a vertex = sum over k of sourceWeight[k] * light at PatchMesh vertex sourceVertex[k], on its
    // surface.
    std::vector<std::array<uint32_t, 3>> sourceVertex;
    std::vector<glm::vec3> sourceWeight; // sums to one
    std::vector<uint32_t> vertexPatch;   // per vertex: where it lies; kCorner at the PatchMesh's own
    std::vector<uint32_t> triangles;     // three indices each, counter-clockwise seen from the air
    std::vector<uint32_t> sourcePatch;   // per triangle: the patch under its middle
    std::vector<uint32_t> visible;       // per triangle: bit p is set where projector p sees it
    std::vector<SurfaceReach> surfaces;  // by surface id

    size_t triangleCount() const { return visible.size(); }
};

// Without occluders the mesh's own surfaces hide one another (standing_faces.h).
// Only patches of role `projection` appear. At most 32 projectors. Projectors are ideal pinholes whose
// picture is the largest four-sided cone within the lens's true border, so nothing is labelled visible that
// the panel cannot reach. Surfaces without T-vertices stay so.
// Shadows thinner than 0.1 mm and lines within that of one another are not told apart. Away from borders and
// outlines the triangles are those of the mesh; outlines have points about an edge length apart. Cost: 2 ms
// for four projectors and a room of six walls at 2000 patches, 5 ms with 20 walls.
ProjectorMesh splitByProjectorVisibility(const PatchMesh& mesh, const Occluders& occluders,
                                         std::span<const OpticalDevice> projectors,
                                         const ProjectorOptions& options = {});

} // namespace heliodon::geometry
