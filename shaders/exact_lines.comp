// Far pairs of triangles that something may stand between, at errors where that is cheaper than exact borders: what
// points of the outer piece see of the inner one, along four lines across it that stand for equal areas
// (lib/hidden_stretches.glsl). Points: J. Radon, "Zur mechanischen Kubatur", 1948, as in lib/exact_cubature.glsl: the
// centre, which is enough for pairs that may err by all that they exchange in the open; four, seven, then four in each of
// 4, 16, 64 parts, in rounds that only pairs take whose last two results disagree. Pairs of which four points see nothing,
// or all see everything, go on from the other piece: lib/exact_cubature.glsl says why.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_vote : require
#include "shaders/io/exact_form_factors.io.h"
#include "shaders/lib/constants.glsl"
#include "shaders/lib/exact_scene.glsl"
#include "shaders/lib/hidden_stretches.glsl"
#include "shaders/lib/loop_limit.glsl"
#include "shaders/lib/monte_carlo_points.glsl"
#include "shaders/lib/radon.glsl"

layout(local_size_x = kExactGroup) in;
layout(set = 0, binding = 5, scalar) buffer Records { ExactRecord records[]; };
layout(set = 0, binding = 6, scalar) readonly buffer Lists { uint lists[]; };
layout(set = 0, binding = 7, scalar) buffer Results { uvec4 results[]; }; // as `sums` in exact_cubature.glsl
layout(set = 0, binding = 8, scalar) readonly buffer Again { uint again[]; }; // records that go on, from level 1
layout(set = 0, binding = 9, scalar) writeonly buffer Next { uint next[]; };  // to the next level
layout(set = 0, binding = 10, scalar) buffer Counters { uint counters[]; };
layout(push_constant, scalar) uniform Push { ExactLinesParams params; };

const float kSevenError = 0.6; // of the least error of four points, that of seven
// The mean over a piece lies within so many roots of h (1 - h) of what is in the open from the centre's, which has h hidden
// (cautious by 3 in rooms of 672 to 10,752 patches).
const float kAloneError = 0.5;
const uint kBitsOfPoint = 4u * 32u; // of its four lines
const uint kBitsWith[5] =
    uint[](0xaaaaaaaau, 0xccccccccu, 0xf0f0f0f0u, 0xff00ff00u, 0xffff0000u); // 1, 2, 4, 8, 16 in their place

Origin origin;
ExactRecord record;
vec3 outerNormal;
vec3 innerNormal;
vec3 inner[3]; // the longest edge is that between the last two: few shadows have borders along it
uint seed;

void loadInner(Face f) {
    vec3 a = cornerFrom(origin, f.first), b = cornerFrom(origin, f.first + 1u), c = cornerFrom(origin, f.first + 2u);
    vec3 size = vec3(dot(b - c, b - c), dot(c - a, c - a), dot(a - b, a - b));
    bool second = size.y > size.x && size.y >= size.z, third = size.z > size.x && size.z > size.y;
    inner[0] = second ? b : third ? c : a;
    inner[1] = second ? c : third ? a : b;
    inner[2] = second ? a : third ? b : c;
}

// Times pi and over the area of the inner piece. From the point to `d`.
float kernel(vec3 d) {
    float r2 = dot(d, d);
    return max(0.0, dot(outerNormal, d)) * max(0.0, -dot(innerNormal, d)) / (r2 * r2);
}

// What a blocker hides of the lines at `h` of the way to the longest edge.
uvec4 shadowOf(uint face, vec3 point, vec3 a[3], vec4 h, vec4 jitter) {
    Face f = faceAt(face);
    vec3 k0 = cornerFrom(origin, f.first) - point, first = k0;
    float height = dot(f.normal, k0), sense = height > 0.0 ? 1.0 : -1.0;
    bool edgeOn = abs(height) <= kFlat * length(k0);
    Stretches s = Stretches(vec4(0.0), vec4(1.0));
    vec3 d = sense * (vec3(dot(f.normal, a[0]), dot(f.normal, a[1]), dot(f.normal, a[2])) - height);
    narrow(s, d.x + h * (d.y - d.x), d.x + h * (d.z - d.x));
    [[unroll]] for (uint c = 1u; c <= kExactFewCorners; ++c) {
        vec3 k1 = c < kExactFewCorners ? cornerFrom(origin, f.first + min(c, f.count - 1u)) - point : first;
        vec3 n = sense * cross(k0, k1);
        d = vec3(dot(n, a[0]), dot(n, a[1]), dot(n, a[2]));
        // Not by a corner that stands again: devices that fuse products and sums make no zero of its cross product.
        if (c < f.count || c == kExactFewCorners) narrow(s, d.x + h * (d.y - d.x), d.x + h * (d.z - d.x));
        k0 = k1;
    }
    return edgeOn ? uvec4(0u) : bitsOf(s, jitter);
}

float open_; // the last point's form factor in the open
uint hiddenOfLast; // bits of all four lines that are hidden from it: 0 to kBitsOfPoint

// From a point to what it sees of the inner piece, times pi, over its area; each point has its own lines.
float seen(vec3 point, uint k) {
    vec3 a[3];
    vec3 middle = vec3(0.0);
    [[unroll]] for (int c = 0; c < 3; ++c) {
        a[c] = inner[c] - point;
        middle += a[c] / 3.0;
    }
    uint bits = seed + k * 2654435769u; // golden ratio
    // Jittered in strips of equal area, against one another, so that what changes linearly across the strips is exact.
    float u = unitOf(bits);
    vec4 h = sqrt(0.25 * (vec4(0.0, 1.0, 2.0, 3.0) + vec4(u, 1.0 - u, 1.0 - u, u)));
    vec4 jitter = fract(unitOf(hashOf(bits)) + vec4(0.0, kGolden, 0.236068, 0.854102));
    uvec4 hidden = uvec4(0u);
    uint m = 0u;
    [[dont_unroll]] do {
        hidden |= shadowOf(lists[record.firstListed + min(m, record.listed - 1u)], point, a, h, jitter);
        ++m;
    } while (subgroupAny(m < record.listed));
    ivec4 count = bitCount(hidden);
    hiddenOfLast = uint(count.x + count.y + count.z + count.w);
    // The kernel as a linear function, from points of the rule of degree 2. Along a line each bit has its own place:
    // quarters would do for one point, but err alike in all pairs of a piece that a near blocker hides in part.
    vec3 g = vec3(kernel(0.5 * (middle + a[0])), kernel(0.5 * (middle + a[1])), kernel(0.5 * (middle + a[2])));
    float mean = dot(g, vec3(1.0 / 3.0));
    g = mean + 2.0 * (g - mean);
    vec4 near = g.x + h * (g.y - g.x), along = h * (g.z - g.y);
    vec4 places = 0.5 * vec4(count); // sum of those of hidden bits
    [[unroll]] for (int b = 0; b < 5; ++b) places += float(1 << b) * vec4(bitCount(hidden & kBitsWith[b]));
    vec4 lit = near * (32.0 - vec4(count)) + along * (16.0 - places / 32.0);
    float all = 32.0 * dot(near + 0.5 * along, vec4(1.0)),
          share = all > 0.0 ? max(0.0, dot(lit, vec4(1.0))) / all : 0.0;
    open_ = mean;
    return mean * share;
}

// Barycentric place of a point: the far three, the centre, the near three of the piece, or of one of the triangles that
// halving all edges `params.level` times makes of it.
vec3 placeOf(uint k, uint cell) {
    float t = k == 3u ? 1.0 / 3.0 : k < 3u ? kRadonFar : kRadonNear;
    vec3 place = mix(vec3(t), vec3(1.0 - 2.0 * t), equal(uvec3(k % 4u), uvec3(0u, 1u, 2u)));
    [[dont_unroll]] for (uint l = 0u; l < params.level; ++l) {
        uint quarter = cell >> (2u * l) & 3u;
        place = quarter == 3u ? 0.5 - 0.5 * place : 0.5 * (place + vec3(equal(uvec3(quarter), uvec3(0u, 1u, 2u))));
    }
    return place;
}

// Form factor and its error, from one point, four or seven. `turned` where four agree and prove too little.
vec2 overPiece(vec3 corner, vec3 u, vec3 v, float limit, out bool turned) {
    uint hidden = 0u; // from the first four points
    turned = false;
    vec3 sums = vec3(0.0); // of the far, the near, the centre
    vec2 result = vec2(0.0), range = vec2(kHuge, 0.0);
    float open = 0.0; // at the centre
    uint k = 0u, end = 4u;
    [[dont_unroll]] do {
        uint point = k < 4u ? (k + 3u) & 3u : k; // the centre first
        vec3 place = placeOf(point, 0u);
        float f = seen(corner + place.y * u + place.z * v, point);
        if (k < end) sums += point < 3u ? vec3(f, 0.0, 0.0) : point > 3u ? vec3(0.0, f, 0.0) : vec3(0.0, 0.0, f);
        if (k < end) range = vec2(min(range.x, f), max(range.y, f));
        if (k == 0u) open = open_;
        if (k < 4u) hidden += hiddenOfLast;
        ++k;
        float byFar = kRadonFarLow / 3.0 * sums.x + (1.0 - kRadonFarLow) * sums.z;
        float byNear = kRadonNearLow / 3.0 * sums.y + (1.0 - kRadonNearLow) * sums.z;
        if (k == 1u && open <= limit) {
            float share = float(hidden) / float(kBitsOfPoint);
            result = vec2(f, kAloneError * sqrt(share * (1.0 - share)) * open);
            end = 1u;
        }
        if (k == 4u && end == 4u) {
            result = vec2(byFar, max(kQuickError * abs(byFar - sums.z), kLeastError * (range.y - range.x)));
            turned = params.last == 0u && kMissed * open > limit && (hidden == 0u || hidden == 4u * kBitsOfPoint);
            end = !turned && max(result.y, kMissed * open) > limit ? 7u : end;
        }
        if (k == 7u && end == 7u) {
            result.x = kRadonNearWeight * sums.y + kRadonFarWeight * sums.x + kRadonCentreWeight * sums.z;
            result.y = max(max(abs(result.x - byNear), abs(result.x - byFar)),
                           kSevenError * kLeastError * (range.y - range.x));
        }
    } while (subgroupAny(k < end));
    open_ = open;
    return result;
}

// The same from four points of each smaller triangle; the error is how far that is from what was found before.
vec2 overCells(vec3 corner, vec3 u, vec3 v, float before) {
    float sum = 0.0;
    uint k = 0u, points = 4u << (2u * params.level);
    [[dont_unroll]] do {
        vec3 place = placeOf(k & 3u, k >> 2u);
        float f = seen(corner + place.y * u + place.z * v, k + 7u * params.level);
        sum += ((k & 3u) == 3u ? 1.0 - kRadonFarLow : kRadonFarLow / 3.0) * f;
        ++k;
    } while (k < points);
    sum *= 4.0 / float(points);
    return vec2(sum, abs(sum - before));
}

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    index += params.first;
    if (params.level > 0u) index = again[index];
    record = records[index];
    Face outerFace = faceAt(record.outer), innerFace = faceAt(record.inner);
    origin = originAt(outerFace.first);
    vec3 corner = cornerFrom(origin, outerFace.first), u = cornerFrom(origin, outerFace.first + 1u) - corner,
         v = cornerFrom(origin, outerFace.first + 2u) - corner;
    outerNormal = outerFace.normal;
    innerNormal = innerFace.normal;
    loadInner(innerFace);
    seed = hashOf(min(record.outer, record.inner) * 0x9e3779b9u ^ hashOf(max(record.outer, record.inner)));
    float scale = kInversePi * innerFace.area,
          limit = params.tolerance / (scale * max(1.0, outerFace.area / innerFace.area));
    vec2 result;
    bool turned = false;
    if (params.level == 0u)
        result = overPiece(corner, u, v, limit, turned);
    else
        result = overCells(corner, u, v, float(results[index].x) / (kExactOne * scale));
    result.y = max(result.y, kMissed * exp2(-2.0 * float(params.level)) * open_);
    if (result.y > limit && params.last == 0u) next[atomicAdd(counters[kExactCellCount], 1u)] = index;
    if (turned) {
        records[index].outer = record.inner;
        records[index].inner = record.outer;
        scale = kInversePi * outerFace.area;
    }
    results[index] = uvec4(fixedOf(scale * max(0.0, result.x)), fixedOf(min(scale * result.y, 1.0)));
    if (cutShort(3u + min(record.outer + record.inner, 1u))) atomicAdd(counters[kExactCutCount], 1u);
}
