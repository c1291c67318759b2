// What the `exact` kernels read: radiating pieces, then blockers, as faces with corners in two floats a
// coordinate.
#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "compute/gpu/buffer.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

struct ExactScene {
    uint32_t patchCount = 0;
    uint32_t pieceCount =
        0; // of convex pieces of at most kExactPieceCorners corners; patchCount when none was cut
    uint32_t mostCorners = 3; // of a piece
    uint32_t blockerCount = 0;
    bool closed = false;
    glm::dvec3 centre{0}; // device coordinates are relative to it
    std::vector<uint32_t> patchOfPiece;
    std::vector<float> area; // per piece
    gpu::Buffer cornerHigh, cornerLow, faceNormal, faceCentre,
        faceRange; // as in shaders/lib/exact_scene.glsl
};

// A position from the scene's centre in two floats a coordinate.
void splitPosition(const glm::dvec3& relative, glm::vec3& high, glm::vec3& low);

ExactScene exactScene(gpu::Device& device, const geometry::PatchMesh& mesh);

} // namespace heliodon::compute
