// What the `exact` kernels read: radiating pieces, blockers and clusters of pieces, as faces with corners in
// two floats a coordinate.
#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "compute/exact_clusters.h"
#include "compute/gpu/buffer.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

// Successive patches whose rows are worked on together; their pieces stand together, in the clusters' order.
struct ExactTileRange {
    uint32_t firstPatch = 0, patches = 0, firstPiece = 0, pieces = 0, firstCluster = 0, clusters = 0;
    bool piecesArePatches = false; // each patch is one piece, and nothing of it is covered
};

struct ExactScene {
    uint32_t patchCount = 0;
    uint32_t pieceCount = 0;  // of convex pieces of at most kExactPieceCorners corners
    uint32_t mostCorners = 3; // of a piece
    uint32_t blockerCount = 0;
    float samePlane = 0;  // kSamePlane of this mesh, metres
    glm::dvec3 centre{0}; // device coordinates are relative to it
    std::vector<ExactTileRange> tiles;
    std::vector<RadiatingPiece> pieces; // in the clusters' order
    std::vector<float> area;            // per piece
    std::vector<float> shareOfPatch;    // per piece: its area's in its patch; 0 without area
    std::vector<double> patchArea;      // of which pieces leave out what is covered
    // What patches cover of one another across narrow gaps (compute/narrow_gaps.h) is in no piece: it sends
    // all its light across, but for what passes the borders, `passes`, m2.
    struct Covered {
        uint32_t first = 0, second = 0; // patches
        double area = 0, passes = 0;
    };
    std::vector<Covered> covered;
    gpu::Buffer cornerHigh, cornerLow, faceNormal, faceCentre,
        faceRange;        // as in shaders/lib/exact_scene.glsl
    gpu::Buffer rowOfPiece; // patch and, as bits of a float, shareOfPatch
    gpu::Buffer clusters; // as in shaders/io/exact_form_factors.io.h
};

// At most `tilePieces` pieces a tile, but whole patches. With `cutsCrowds` few large patches behind many
// blockers are cut into about 500 triangles, needles across, at most 2000 in all.
ExactScene exactScene(gpu::Device& device, const geometry::PatchMesh& mesh, uint32_t tilePieces,
                      bool cutsCrowds = false);

} // namespace heliodon::compute
