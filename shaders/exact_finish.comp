// Sums of the records into both entries of the matrix: reciprocal by construction.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/exact_form_factors.io.h"

layout(local_size_x = kExactGroup) in;
layout(set = 0, binding = 0) uniform samplerBuffer faceNormal; // w area
layout(set = 0, binding = 1, scalar) readonly buffer Records { ExactRecord records[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Sums { uint sums[]; };
layout(set = 0, binding = 3, scalar) writeonly buffer Rows { float rows[]; };
layout(set = 0, binding = 4, scalar) writeonly buffer Columns { float columns[]; };
layout(push_constant, scalar) uniform Push { ExactFinishParams params; };

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    index += params.firstRecord;
    ExactRecord r = records[index];
    float fromOuter = (float(sums[3u * index]) + float(sums[3u * index + 1u]) / kExactFraction) / kExactOne;
    float fromInner =
        fromOuter * texelFetch(faceNormal, int(r.outer)).w / texelFetch(faceNormal, int(r.inner)).w;
    bool outerFirst = r.outer < r.inner;
    uint i = outerFirst ? r.outer : r.inner, j = outerFirst ? r.inner : r.outer;
    rows[(i - params.firstRow) * params.pieceCount + j] = outerFirst ? fromOuter : fromInner;
    columns[(j - params.firstColumn) * params.pieceCount + i] = outerFirst ? fromInner : fromOuter;
}
