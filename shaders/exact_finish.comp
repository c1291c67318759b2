// Sums of the records into both entries of their pairs, reciprocal by construction, and the squares of their errors into
// both rows.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/io/exact_form_factors.io.h"

layout(local_size_x = kExactGroup) in;
layout(set = 0, binding = 0) uniform samplerBuffer faceNormal; // w area
layout(set = 0, binding = 1) uniform usamplerBuffer faceRange; // w place in its tile
layout(set = 0, binding = 2, scalar) readonly buffer Records { ExactRecord records[]; };
layout(set = 0, binding = 3, scalar) readonly buffer Sums { uvec4 sums[]; };
layout(set = 0, binding = 4, scalar) writeonly buffer There { float there[]; }; // [row][column]
layout(set = 0, binding = 5, scalar) writeonly buffer Back { float back[]; };   // [column][row]
layout(set = 0, binding = 6) uniform usamplerBuffer rowOfPiece; // x patch, y float: the piece's area over the patch's
// Of each row: squares of errors, then of those of crowds. Three words each, whole ones first: never comes round.
layout(set = 0, binding = 7, scalar) buffer Claims { uint claims[]; };
layout(push_constant, scalar) uniform Push { ExactFinishParams params; };

const float kWord = 4294967296.0;

float valueOf(uvec2 fixed_) { return (float(fixed_.x) + float(fixed_.y) / kExactFraction) / kExactOne; }

// Of fixed point, so that sums do not depend on their order.
void add(uint word, uint added) {
    if (added == 0u) return;
    [[dont_unroll]] do { // carried on
        uint before = atomicAdd(claims[word], added);
        added = before > ~0u - added ? 1u : 0u;
        --word;
    } while (added != 0u);
}

// `square` of an entry's error, at most 1: no form factor is farther off.
void claim(uint piece, float square, bool crowd) {
    uvec2 row = texelFetch(rowOfPiece, int(piece)).xy;
    float share = min(square, 1.0) * uintBitsToFloat(row.y), middle = share * kWord;
    uint word = kExactClaimWords * row.x + (crowd ? 3u : 0u);
    if (share >= 1.0) {
        add(word, 1u);
        return;
    }
    add(word + 2u, uint((middle - floor(middle)) * kWord));
    add(word + 1u, uint(middle));
}

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    index += params.firstRecord;
    ExactRecord r = records[index];
    uvec4 sum = sums[index];
    float outerArea = texelFetch(faceNormal, int(r.outer)).w, innerArea = texelFetch(faceNormal, int(r.inner)).w;
    float fromOuter = valueOf(sum.xy), fromInner = fromOuter * outerArea / innerArea;
    bool outerFirst = r.outer < r.inner;
    uint row = texelFetch(faceRange, int(min(r.outer, r.inner))).w,
         column = texelFetch(faceRange, int(max(r.outer, r.inner))).w;
    ExactHalves h = params.halves;
    there[h.firstThere + row * h.strideThere + column] = outerFirst ? fromOuter : fromInner;
    back[h.firstBack + column * h.strideBack + row] = outerFirst ? fromInner : fromOuter;
    bool crowd = r.listed > params.mostExact;
    float error = valueOf(sum.zw), square = crowd ? error : error * error, ratio = outerArea / innerArea;
    if (square <= 0.0) return;
    claim(r.outer, square, crowd);
    claim(r.inner, square * ratio * ratio, crowd);
}
