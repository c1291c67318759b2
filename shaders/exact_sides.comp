// For each piece and cluster, one bit per blocker: piece wholly in front of its plane, wholly behind, blocker wholly
// behind the piece, and, of all pieces alike, blocker bounds a solid. A blocker in the piece's own plane counts as
// behind: rounding must not let a wall hide its own patches.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/io/exact_form_factors.io.h"
#include "shaders/lib/exact_scene.glsl"

layout(local_size_x = kExactGroup) in;
layout(set = 0, binding = 5, scalar) writeonly buffer Sides { uvec4 sides[]; }; // [row][word]
layout(push_constant, scalar) uniform Push { ExactSidesParams params; };

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= (params.pieces + params.clusters) * params.words) return;
    uint row = index / params.words, word = index % params.words;
    Face self = faceAt(row < params.pieces
                           ? params.firstPiece + row
                           : params.pieceCount + params.blockerCount + params.firstCluster + row - params.pieces);
    uvec4 bits = uvec4(0u);
    [[dont_unroll]] for (uint bit = 0u; bit < 32u && word * 32u + bit < params.blockerCount; ++bit) {
        uint face = params.pieceCount + word * 32u + bit;
        Face blocker = faceAt(face);
        vec2 own = heightsOver(blocker, self);
        vec2 its = heightsOver(self, blocker);
        float facing = dot(blocker.normal, self.normal);
        // Wholly before one another, by more than rounding: a gap between two bodies, and the blocker covers the piece.
        bool gap = facing < 0.0 && own.x > 0.0 && its.x > 0.0;
        bool same = max(abs(own.x), abs(own.y)) <= params.samePlane && abs(facing) > 0.99999 && !gap;
        if (own.x >= 0.0) bits.x |= 1u << bit;
        if (own.y <= 0.0) bits.y |= 1u << bit;
        // Rooms do not see one another: as good as below.
        if (its.y <= 0.0 || same || blocker.room != self.room) bits.z |= 1u << bit;
        bits.w |= texelFetch(faceRange, int(face)).w << bit;
    }
    // Past the last blocker everything is below.
    uint known = params.blockerCount - min(params.blockerCount, word * 32u);
    if (known < 32u) bits.z |= ~((1u << known) - 1u);
    sides[index] = bits;
}
