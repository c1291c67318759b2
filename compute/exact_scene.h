// What the `exact` kernels read: radiating pieces, then blockers, as faces with corners in two floats a
// coordinate.
#pragma once

#include <vector>

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
    std::vector<uint32_t> patchOfPiece;
    std::vector<float> area; // per piece
    gpu::Buffer cornerHigh, cornerLow, faceNormal, faceCentre,
        faceRange; // as in shaders/lib/exact_scene.glsl
};

ExactScene exactScene(gpu::Device& device, const geometry::PatchMesh& mesh);

} // namespace heliodon::compute
