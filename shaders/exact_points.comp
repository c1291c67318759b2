// Form factors from points with a normal to pieces: Lambert's formula of what is visible, found exactly. One group: one point
// and kExactGroup pieces.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/io/exact_points.io.h"
#include "shaders/lib/lambert.glsl"
#include "shaders/lib/exact_scene.glsl"
#include "shaders/lib/visible_polygon.glsl"

layout(local_size_x = kExactPointGroup) in;
layout(set = 0, binding = 5, scalar) readonly buffer Points { ExactPoint points[]; };
layout(set = 0, binding = 6, scalar) buffer Lost { uint lost; };
layout(set = 0, binding = 7, scalar) writeonly buffer Factors { float factors[]; }; // [point][piece]
layout(push_constant, scalar) uniform Push { ExactPointsParams params; };

shared uint above[kExactPointWords]; // one bit a blocker that rises above the point's horizon

// Blockers past the shared words count as risen.
void findRisen(ExactPoint point, Origin o) {
    uint lane = gl_LocalInvocationID.x;
    if (lane < kExactPointWords) above[lane] = 0u;
    barrier();
    uint count = min(params.blockerCount, kExactPointWords * 32u);
    [[dont_unroll]] for (uint b = lane; b < count; b += kExactPointGroup) {
        Face blocker = faceAt(params.pieceCount + b);
        bool risen = false;
        [[dont_unroll]] for (uint k = 0u; k < blocker.count; ++k)
            risen = risen || heightOver(point.normal, cornerFrom(o, blocker.first + k)) > 0.0;
        if (risen && blocker.room == point.room) atomicOr(above[b / 32u], 1u << (b % 32u));
    }
    barrier();
}

bool mayBlock(uint b, uint room) {
    if (b < kExactPointWords * 32u) return (above[b / 32u] >> (b % 32u) & 1u) != 0u;
    return texelFetch(faceRange, int(params.pieceCount + b)).z == room;
}

// Form factor to what is lit of the piece already loaded and clipped.
float seen(ExactPoint point, Origin o, Frame f) {
    float size = pieceSize();
    lineCount = 0;
    bool hidden = false;
    NO_UNROLL for (uint b = 0u; b < params.blockerCount && !hidden; ++b)
        NO_UNROLL for (bool once = mayBlock(b, point.room); once; once = false)
            hidden = castShadow(f, o, faceAt(params.pieceCount + b), vec3(0.0), b, size);
    return hidden ? 0.0 : litFactor(f, vec3(0.0), point.normal, size);
}

void main() {
    uint row = gl_WorkGroupID.y, column = gl_GlobalInvocationID.x;
    ExactPoint point = points[row];
    Origin o = Origin(point.high, point.low);
    findRisen(point, o);
    if (column >= params.pieceCount) return;
    float factor = 0.0;
    Face face = faceAt(column);
    bool faces = face.area > 0.0 && face.room == point.room && heightOver(face.normal, -cornerFrom(o, face.first)) > 0.0;
    NO_UNROLL for (; faces; faces = false) {
        Frame f = frameOf(o, face);
        loadPiece(f, o, face);
        clipTo(f, point.normal, vec3(0.0));
        NO_UNROLL for (bool once = pieceCorners >= 3; once; once = false) factor = seen(point, o, f);
    }
    if (linesLost) atomicAdd(lost, 1u);
    factors[row * params.pieceCount + column] = max(0.0, factor);
}
