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

// Lambert's sum over what is visible of the piece already loaded and clipped.
float visibleSum(ExactPoint point, Origin o, Frame f, float size) {
    float sum = 0.0;
    waitingCount = 0;
    uint next = 0u;
    NO_UNROLL while (true) {
        bool remains = pieceCorners >= 3;
        NO_UNROLL for (; next < params.blockerCount && remains; ++next)
            if (mayBlock(next, point.room))
                remains = cutShadow(f, o, faceAt(params.pieceCount + next), vec3(0.0), next + 1u, size);
        if (remains) sum += lambertPiece(f, vec3(0.0), point.normal);
        if (waitingCount == 0) break;
        --waitingCount;
        pieceCorners = waitingCorners[waitingCount];
        NO_UNROLL for (int k = 0; k < pieceCorners; ++k) piece[k] = waiting[waitingCount * kPieceCap + k];
        next = waitingNext[waitingCount];
    }
    return sum;
}

void main() {
    uint row = gl_WorkGroupID.y, column = gl_GlobalInvocationID.x;
    ExactPoint point = points[row];
    Origin o = Origin(point.high, point.low);
    findRisen(point, o);
    if (column >= params.pieceCount) return;
    float sum = 0.0;
    Face face = faceAt(column);
    if (face.area > 0.0 && face.room == point.room && heightOver(face.normal, -cornerFrom(o, face.first)) > 0.0) {
        Frame f = frameOf(o, face);
        loadPiece(f, o, face);
        clipTo(f, point.normal, vec3(0.0));
        float size = 0.0;
        NO_UNROLL for (int k = 0; k < pieceCorners; ++k) size = max(size, length(piece[k]));
        if (pieceCorners >= 3) sum = visibleSum(point, o, f, size);
    }
    if (piecesLost) atomicAdd(lost, 1u);
    factors[row * params.pieceCount + column] = max(0.0, sum * 0.159154943092);
}
