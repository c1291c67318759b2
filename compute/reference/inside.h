// For rays of the references: where a patch is met.
#pragma once

#include <glm/geometric.hpp>

#include "geometry/patch_mesh.h"

namespace heliodon::compute::reference {

// Whether a point of a patch's plane lies in the patch or on its edge; `normal`: the patch's, of any length.
inline bool isInside(const geometry::PatchMesh& mesh, size_t patch, glm::dvec3 normal, glm::dvec3 p) {
    const auto corners = mesh.patch(patch);
    for (size_t k = 0; k < corners.size(); ++k) {
        const glm::dvec3 a = mesh.vertices[corners[k]], b = mesh.vertices[corners[(k + 1) % corners.size()]];
        if (!(glm::dot(glm::cross(b - a, p - a), normal) >= 0)) return false;
    }
    return true;
}

} // namespace heliodon::compute::reference
