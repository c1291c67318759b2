// Triangles ready to draw: corners one by one, flat normals, and for each corner how its light is mixed from
// the values at the mesh's vertices.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/passes/vertex_light.h"
#include "geometry/patch_mesh.h"

namespace heliodon::passes {

struct DrawCorner { // the vertex stream of shaders/scene.vert and solid.vert
    glm::vec3 position, normal, reflectance;
    glm::vec3 smoothNormal; // of the physical surface: that of a curved wall turns steadily over its facets
};

struct LightMix {
    std::array<uint32_t, 3> pair; // of VertexLight
    glm::vec3 weight;
};

struct DrawMesh {
    std::vector<DrawCorner> corners; // three a triangle
    std::vector<LightMix> light;     // one a corner
    std::vector<uint32_t> patch;     // one a triangle
    // One a corner, as ProjectorMesh::vertexPatch; empty where each triangle lies on its own patch.
    std::vector<uint32_t> cornerPatch;

    double area(size_t triangle) const;                                     // m2
    std::vector<glm::vec3> positions(std::span<const uint32_t> some) const; // of corners
    // The light stream: `scale` times the lux per pair.
    void mixLight(std::span<const glm::vec3> luxPerPair, float scale, std::span<glm::vec3> out) const;
};

// Where points lie on a triangle: weights of its second and third corner.
class TrianglePlaces {
public:
    TrianglePlaces(const geometry::PatchMesh& mesh, uint32_t patch);
    glm::vec2 of(glm::vec3 point) const;

private:
    glm::dvec3 origin_, second_, third_;
};

DrawMesh drawMesh(const geometry::PatchMesh& mesh, const VertexLight& vertexLight);

// Physical solids with flat normals.
std::vector<DrawCorner> drawSolids(const geometry::Occluders& occluders);
// A disc facing up.
std::vector<DrawCorner> drawDisc(glm::dvec3 centre, double radius);

} // namespace heliodon::passes
