// Sums of the records into both entries of the tile: reciprocal by construction.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/exact_form_factors.io.h"

layout(local_size_x = kExactGroup) in;
layout(set = 0, binding = 0) uniform samplerBuffer faceNormal; // w area
layout(set = 0, binding = 1) uniform usamplerBuffer faceRange; // w place in its tile
layout(set = 0, binding = 2, scalar) readonly buffer Records { ExactRecord records[]; };
layout(set = 0, binding = 3, scalar) readonly buffer Sums { uvec4 sums[]; };
layout(set = 0, binding = 4, scalar) writeonly buffer There { float there[]; }; // [row][column] of the tile
layout(set = 0, binding = 5, scalar) writeonly buffer Back { float back[]; };   // [column][row]
layout(push_constant, scalar) uniform Push { ExactFinishParams params; };

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    index += params.firstRecord;
    ExactRecord r = records[index];
    float fromOuter = (float(sums[index].x) + float(sums[index].y) / kExactFraction) / kExactOne;
    float fromInner =
        fromOuter * texelFetch(faceNormal, int(r.outer)).w / texelFetch(faceNormal, int(r.inner)).w;
    bool outerFirst = r.outer < r.inner;
    uint row = texelFetch(faceRange, int(min(r.outer, r.inner))).w,
         column = texelFetch(faceRange, int(max(r.outer, r.inner))).w;
    there[row * params.columns + column] = outerFirst ? fromOuter : fromInner;
    back[column * params.rows + row] = outerFirst ? fromInner : fromOuter;
}
