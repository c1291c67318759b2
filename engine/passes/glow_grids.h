// The grids of compute::LightDetail on triangles that are drawn: on those that lie on a patch its grid, as it
// is. Others, which outlines of projectors cut anew, go over several patches: they have what grids say at
// their corners.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "compute/lighting.h"
#include "engine/passes/draw_mesh.h"
#include "geometry/patch_mesh.h"

namespace heliodon::passes {

class GlowGrids {
public:
    // All must outlive this. `perLux`: what is drawn per lux, by patch.
    GlowGrids(const geometry::PatchMesh& mesh, const VertexLight& vertexLight,
              std::span<const compute::PatchGlow> grids, std::span<const glm::vec3> perLux);

    // Light over one triangle, at the places of a grid in which its corners lie `at`.
    struct OnTriangle {
        std::array<glm::vec2, 3> at{};
        std::array<glm::vec3, io::kGlowPlaces> light{};
    };
    // None where there is no light of grids.
    std::optional<OnTriangle> on(const DrawMesh& drawn, size_t triangle) const;

private:
    glm::vec3 atCorner(const DrawMesh& drawn, size_t corner) const;

    const geometry::PatchMesh& mesh_;
    std::span<const glm::vec3> perLux_;
    std::vector<const compute::PatchGlow*> gridOf_; // per patch; or null
    std::vector<glm::vec3> atPair_;                 // light at vertices of the mesh
};

} // namespace heliodon::passes
