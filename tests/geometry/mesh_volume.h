#pragma once

#include <glm/geometric.hpp>

#include "geometry/patch_mesh.h"

namespace heliodon::geometry {

// Of the air, from a mesh: positive only when it is closed and its normals point inwards.
inline double volume(const PatchMesh& mesh) {
    double sum = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        sum -= glm::dot(0.5 * patchAreaVector(mesh, i), patchCentroid(mesh, i)) / 3;
    return sum;
}

} // namespace heliodon::geometry
