// Cubature of pairs with at most two blockers, all faces of at most four corners: most of the work, nearly without
// arrays.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_vote : require
#include "shaders/io/exact_form_factors.io.h"
#include "shaders/lib/constants.glsl"
#include "shaders/lib/lambert.glsl"
#include "shaders/lib/exact_scene.glsl"

layout(constant_id = 0) const int kCorners = 3; // most of a piece
layout(constant_id = 2) const uint kBlockers = 2u;

#include "shaders/lib/convex_shadows.glsl"
#include "shaders/lib/exact_cubature.glsl"

// Of the outer piece's plane, in the frame of the inner piece.
vec3 outerOrigin;
vec3 outerU;
vec3 outerV;
Blocker blocker[kExactFew];

vec3 turned(Frame f, vec3 v) { return vec3(dot(v, f.u), dot(v, f.v), dot(v, f.n)); }

Blocker blockerAt(Frame f, Origin o, uint index) {
    Face face = faceAt(index);
    Blocker b;
    b.normal = turned(f, face.normal);
    b.sight = sightOf(face);
    [[unroll]] for (uint k = 0u; k < kExactFewCorners; ++k)
        b.corner[k] = turned(f, cornerFrom(o, face.first + min(k, face.count - 1u)) - f.origin);
    return b;
}

// What of the outer piece lies above the inner one's plane.
void setOuter(vec2 corner[kRim], float height[kRim]) {
    outerCorners = 0;
    [[unroll]] for (int k = 0; k < kCorners; ++k) {
        vec2 along = corner[(k + 1) % kCorners] - corner[k];
        float h = height[k], g = height[(k + 1) % kCorners];
        if (h >= 0.0) outer[outerCorners++] = corner[k];
        if (h > 0.0 && g < 0.0 || h < 0.0 && g > 0.0) outer[outerCorners++] = corner[k] + h / (h - g) * along;
    }
}

void loadPair(uint record) {
    pair.record = record;
    pair.r = records[record];
    Face outerFace = faceAt(pair.r.outer), face = faceAt(pair.r.inner);
    Origin origin = originAt(outerFace.first);
    Frame own = frameOf(origin, outerFace), frame = frameOf(origin, face);
    pair.outerArea = outerFace.area;
    pair.innerArea = face.area;
    pair.worst = max(1.0, outerFace.area / face.area);
    pair.innerSize = 0.0;
    vec2 corner[kRim], outerCorner[kRim];
    float height[kRim], outerHeight[kRim];
    [[unroll]] for (uint k = 0u; k < kCorners; ++k) {
        uint there = outerFace.first + min(k, outerFace.count - 1u), here = face.first + min(k, face.count - 1u);
        vec3 p = cornerFrom(origin, there), q = cornerFrom(origin, here);
        outerCorner[k] = cornerInFrame(there);
        outerHeight[k] = heightOver(face.normal, p - frame.origin);
        corner[k] = cornerInFrame(here);
        height[k] = heightOver(outerFace.normal, q - own.origin);
        pair.innerSize = max(pair.innerSize, length(corner[k]));
    }
    setPiece(corner, height);
    setOuter(outerCorner, outerHeight);
    outerOrigin = turned(frame, own.origin - frame.origin);
    outerU = turned(frame, own.u);
    outerV = turned(frame, own.v);
    facing = turned(frame, own.n);
    [[unroll]] for (uint m = 0u; m < kBlockers; ++m) {
        blocker[m] = blockerAt(frame, origin, lists[pair.r.firstListed + min(m, pair.r.listed - 1u)]);
        if (m >= pair.r.listed) blocker[m].normal = vec3(0.0); // casts no shadow
    }
}

vec3 fromInner(vec2 at) { return outerOrigin + at.x * outerU + at.y * outerV; }

// Twice pi times the form factor of what of the piece, which has `whole`, is in shadow. `hidden` when one blocker hides
// all. Of a shadow as thin as rounding, as thin slabs cast that are seen edge-on, one border may count as another's and
// the other not: what both cover is held to what one covers.
float shadowsSum(float whole, out bool hidden) {
    Shadow one, other;
    uint shadows = 0u, m = 0u;
    hidden = false;
    float sum = 0.0, least = whole;
    [[dont_unroll]] do {
        Shadow s;
        bvec2 found = castShadow(blocker[m], s);
        hidden = hidden || found.y;
        if (!found.x && !found.y) {
            float covered = clamp(shadowSum(s), 0.0, whole);
            sum += covered;
            least = min(least, covered);
            other = one;
            one = s;
            ++shadows;
        }
        ++m;
    } while (m < kBlockers);
    if (kBlockers == 2u && shadows == 2u) { // counted twice: what both cover
        vec2 both[kRim];
        [[unroll]] for (int k = 0; k <= kCorners; ++k)
            both[k] = vec2(max(one.rim[k].x, other.rim[k].x), min(one.rim[k].y, other.rim[k].y));
        sum -= clamp(overRim(both) + coveredSum(one, other, true) + coveredSum(other, one, false), 0.0, least);
    }
    return sum;
}

float wholeFrom(vec2 at) {
    point = fromInner(at);
    near = kBorder * (length(point) + pair.innerSize);
    return overRim(rim);
}

void lookFrom(vec2 a, vec2 b, vec2 c) {}

float openFrom(vec2 at) { return kBlockers == 0u ? 1.0 : kInverseTwoPi * max(0.0, wholeFrom(at)); }

float seen(vec2 at) {
    float whole = wholeFrom(at);
    if (kBlockers == 0u) return kInverseTwoPi * max(0.0, whole);
    // The piece spans an angle of its size over the distance.
    bool hidden;
    float lit = whole - shadowsSum(whole, hidden), left = kLeft * max(1.0, length(point) / pair.innerSize);
    bool lost = hidden || lit <= left * whole;
    views |= lost ? kSeesNothing : lit == whole ? kSeesAll : kSeesPart;
    return lost ? 0.0 : kInverseTwoPi * lit;
}

float gapAt(vec2 at) { return facing.z < -kStraight ? abs(fromInner(at).z) : kHuge; }

// An edge in the outer piece's own plane bends what is seen only at its ends.
float bendDistance(vec2 at) {
    vec3 p = fromInner(at);
    float nearest = kHuge;
    float flat_ = kInPlane * (pair.innerSize + sqrt(pair.outerArea));
    [[unroll]] for (int k = 0; k <= kCorners; ++k) {
        vec3 a = vec3(rimFrom[k] + rim[k].x * rimAlong[k], 0.0) - p,
             b = vec3(rimFrom[k] + rim[k].y * rimAlong[k], 0.0) - p;
        vec3 ab = b - a;
        bool inPlane = abs(dot(facing, a)) <= flat_ && abs(dot(facing, b)) <= flat_;
        float length2 = dot(ab, ab), t = length2 > 0.0 ? clamp(-dot(a, ab) / length2, 0.0, 1.0) : 0.0;
        float apart = inPlane ? min(length(a), length(b)) : length(a + t * ab);
        if (rim[k].x < rim[k].y) nearest = min(nearest, apart);
    }
    return nearest;
}
