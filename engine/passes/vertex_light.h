// From one value per patch to one value per vertex, so that light can be drawn linear between vertices.
// At each vertex a plane is fitted to the values of the patches around it (weighted least squares over their
// centroids) and read off at the vertex: a field that is linear over a surface is reproduced exactly, at its
// border too. Then the vertices take up, a few times over, what the means drawn on the patches around them
// lack, by area (Cimmino's method), but not out of the range of the fit and of these patches: what is drawn
// on a patch comes near to the light that it has, and on a surface to all of its light. Values never mix
// across surfaces. What depends on geometry alone is worked out once; evaluating costs some twenty
// multiply-adds a corner.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/lighting.h"
#include "geometry/patch_mesh.h"

namespace heliodon::passes {

class VertexLight {
public:
    explicit VertexLight(const geometry::PatchMesh& mesh);

    // Number of (vertex, surface) pairs.
    size_t size() const { return first_.size() - 1; }
    // The pair that belongs to mesh.corners[corner].
    uint32_t ofCorner(size_t corner) const { return corners_[corner].pair; }
    // The pair of a vertex that some patch of the surface has as a corner.
    uint32_t pairOf(uint32_t vertex, uint32_t surface) const { return pairs_.at({vertex, surface}); }

    // Of the surface at the pair: cornerNormals() of geometry/patch_mesh.h.
    glm::dvec3 normal(uint32_t pair) const { return normal_[pair]; }

    // One value per pair, never negative. `patchValues` has one value per patch.
    std::vector<glm::vec3> evaluate(std::span<const glm::vec3> patchValues) const;

    // Adds light given at corners (in the order of PatchMesh::corners, the same at all corners of a pair),
    // times `perPatch`.
    void addCorners(std::span<const glm::vec3> perPatch, std::span<const glm::vec3> corners,
                    std::vector<glm::vec3>& values) const;

private:
    struct Corner {
        uint32_t pair;
        float share; // of the corner in the mean that is drawn on its patch
        float pull;  // of its patch among those that its pair belongs to
    };
    void findCorners(const geometry::PatchMesh& mesh, std::vector<std::vector<uint32_t>>& patchesAt,
                     std::vector<uint32_t>& vertexOf);
    void weighCorners(const geometry::PatchMesh& mesh);
    void keepMeans(std::span<const glm::vec3> patchValues, std::vector<glm::vec3>& values) const;

    std::map<std::pair<uint32_t, uint32_t>, uint32_t> pairs_;
    std::vector<uint32_t> firstCorner_; // of the mesh
    std::vector<Corner> corners_;
    std::vector<glm::dvec3> normal_;         // per pair
    std::vector<uint32_t> first_{0}, patch_; // pair i combines patch_[first_[i] .. first_[i + 1])
    std::vector<float> weight_;
};

// What is drawn per patch before the per-pixel sun is added: exitance minus the first bounce of the direct
// sun. Never negative; equals the exitance when no sun is modelled.
std::vector<glm::vec3> indirectExitance(const geometry::PatchMesh& mesh, const compute::Lighting& lighting);

// The illuminance behind that exitance: (exitance - own emission) / reflectance - direct sun. A channel that
// reflects nothing tells nothing and takes the mean of those that do; zero where none does.
std::vector<glm::vec3> indirectIlluminance(const geometry::PatchMesh& mesh,
                                           const compute::Lighting& lighting);

} // namespace heliodon::passes
