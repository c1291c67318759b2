// For each piece, one bit per blocker: piece wholly in front of its plane, wholly behind, blocker wholly behind the piece.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/io/exact_form_factors.io.h"
#include "shaders/lib/exact_scene.glsl"

layout(local_size_x = kExactGroup) in;
layout(set = 0, binding = 5, scalar) writeonly buffer Sides { uint sides[]; }; // [piece][word][front, back, below]
layout(push_constant, scalar) uniform Push { ExactSidesParams params; };

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.pieceCount * params.words) return;
    uint piece = index / params.words, word = index % params.words;
    Face self = faceAt(piece);
    uint front = 0u, back = 0u, below = 0u;
    [[dont_unroll]] for (uint bit = 0u; bit < 32u && word * 32u + bit < params.blockerCount; ++bit) {
        Face blocker = faceAt(params.pieceCount + word * 32u + bit);
        vec2 own = heightsOver(blocker, self);
        vec2 its = heightsOver(self, blocker);
        if (own.x >= 0.0) front |= 1u << bit;
        if (own.y <= 0.0) back |= 1u << bit;
        // Rooms do not see one another: as good as below.
        if (its.y <= 0.0 || blocker.room != self.room) below |= 1u << bit;
    }
    sides[3u * index] = front;
    sides[3u * index + 1u] = back;
    sides[3u * index + 2u] = below;
}
