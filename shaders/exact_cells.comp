// Cubature of pairs of any convex pieces behind any blockers, one cell an invocation.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_vote : require
#include "shaders/io/exact_form_factors.io.h"
#include "shaders/lib/constants.glsl"
#include "shaders/lib/lambert.glsl"
#include "shaders/lib/exact_scene.glsl"
#include "shaders/lib/exact_cubature.glsl"
#include "shaders/lib/visible_polygon.glsl"
#include "shaders/lib/hidden_stretches.glsl"
#include "shaders/lib/monte_carlo_points.glsl"
#include "shaders/lib/near_blockers.glsl"
#include "shaders/lib/lit_along_lines.glsl"

// Of lines: their errors fall faster than their cost rises, but where they do not matter a few are enough, and behind
// many blockers so many would be too much at once (loop_limit.glsl).
uint foursFor(uint listed) {
    uint wanted = demand < 32.0 ? 1u : demand < 256.0 ? 4u : 16u;
    return min(wanted, listed > 640u ? 1u : listed > 160u ? 4u : 16u);
}

// `piece` is what of the inner piece lies above the outer one's plane.
Face outerFace;
Frame outerFrame;
Frame innerFrame;
Origin origin;

void loadPair(uint record) {
    pair.record = record;
    pair.r = records[record];
    outerFace = faceAt(pair.r.outer);
    Face face = faceAt(pair.r.inner);
    origin = originAt(outerFace.first);
    outerFrame = frameOf(origin, outerFace);
    innerFrame = frameOf(origin, face);
    pair.outerArea = outerFace.area;
    pair.innerArea = face.area;
    pair.worst = max(1.0, outerFace.area / face.area);
    outerCorners = 3;
    if (wholePair) {
        loadPiece(outerFace);
        clipTo(outerFrame, face.normal, cornerFrom(origin, face.first));
        outerCorners = pieceCorners;
        NO_UNROLL for (int k = 0; k < pieceCorners; ++k) outer[k] = piece[k];
    }
    loadPiece(face);
    clipTo(innerFrame, outerFace.normal, cornerFrom(origin, outerFace.first));
    outerCorners = pieceCorners < 3 ? 0 : outerCorners;
    pair.innerSize = pieceSize();
}

void lookFrom(vec2 a, vec2 b, vec2 c) {
    findNear(innerFrame, origin, vec3[3](lift(outerFrame, a), lift(outerFrame, b), lift(outerFrame, c)));
}

float openFrom(vec2 at) {
    return kInverseTwoPi * max(0.0, wholeSum(innerFrame, lift(outerFrame, at), outerFace.normal));
}

float seen(vec2 at) {
    vec3 point = lift(outerFrame, at);
    lineCount = 0;
    linesLost = crowded() && nearCount > 0u;
    bool hidden = false;
    NO_UNROLL for (uint m = 0u; m < nearCount && !hidden && !linesLost; ++m)
        hidden = castShadow(innerFrame, origin, faceAt(blockerAt(m)), point, m, pair.innerSize);
    float share = 1.0;
    NO_UNROLL for (bool once = linesLost && !hidden; once; once = false) {
        share = litShareAlongLines(innerFrame, origin, point, outerFace.normal, pair.r.inner, nearCount,
                                   foursFor(nearCount));
        lineCount = 0;
    }
    float lit = hidden ? 0.0 : share * max(0.0, litFactor(innerFrame, point, outerFace.normal, pair.innerSize));
    views |= lit <= 0.0 ? kSeesNothing : lineCount == 0 && share == 1.0 ? kSeesAll : kSeesPart;
    return lit;
}

vec3 fromInner(vec2 at) { return lift(outerFrame, at) - innerFrame.origin; }

float gapAt(vec2 at) {
    bool straight = dot(outerFace.normal, innerFrame.n) < -kStraight;
    return straight ? abs(dot(innerFrame.n, fromInner(at))) : kHuge;
}

float segmentDistance(vec3 p, vec3 a, vec3 b) {
    vec3 ab = b - a;
    float length2 = dot(ab, ab);
    return length(p - a - (length2 > 0.0 ? clamp(dot(p - a, ab) / length2, 0.0, 1.0) : 0.0) * ab);
}

// An edge in the outer piece's own plane bends what is seen only at its ends.
float bendDistance(vec2 at) {
    vec3 point = lift(outerFrame, at), normal = outerFace.normal;
    float nearest = kHuge;
    vec3 a = lift(innerFrame, piece[pieceCorners - 1]);
    float flat_ = kInPlane * (pair.innerSize + sqrt(pair.outerArea));
    NO_UNROLL for (int k = 0; k < pieceCorners; ++k) {
        vec3 b = lift(innerFrame, piece[k]);
        bool inPlane = abs(dot(normal, a - point)) <= flat_ && abs(dot(normal, b - point)) <= flat_;
        nearest = min(nearest, inPlane ? min(length(a - point), length(b - point)) : segmentDistance(point, a, b));
        a = b;
    }
    return nearest;
}
