// One pair of pieces: not facing and proven hidden stay zero; far and visible is integrated here by a product rule; the rest
// becomes a record, with the blockers that may stand between.
// Shafts: E. A. Haines, J. R. Wallace, "Shaft culling for efficient ray-cast radiosity", 1991.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/io/exact_form_factors.io.h"
#include "shaders/lib/exact_scene.glsl"

layout(local_size_x = kExactGroup) in;
layout(set = 0, binding = 5, scalar) readonly buffer Sides { uint sides[]; };
layout(set = 0, binding = 6, scalar) buffer Counters { uint counters[]; };
layout(set = 0, binding = 7, scalar) writeonly buffer Records { ExactRecord records[]; };
layout(set = 0, binding = 8, scalar) writeonly buffer Lists { uint lists[]; };
layout(set = 0, binding = 9, scalar) writeonly buffer Rows { float rows[]; };
layout(set = 0, binding = 10, scalar) writeonly buffer Columns { float columns[]; };
layout(push_constant, scalar) uniform Push { ExactClassifyParams params; };

// Corners of a piece held in registers; shorter pieces repeat their last corner.
layout(constant_id = 0) const int kCorners = 3;

const float kInversePi = 0.318309886184;

// Marks of a listed blocker that has the first piece wholly in front and the second behind, or the other way about.
const uint kInFront = 0x80000000u, kBehind = 0x40000000u;

uint listed[kExactListed];
uint listedCount = 0u;

vec3 ca[kCorners], cb[kCorners]; // of both pieces, from the first corner of the first
vec3 wall[2 * kCorners];         // of the shaft between them, pointing inwards; zero where there is none
vec3 foot[2 * kCorners];         // a point of each

vec3 corner(Origin o, Face face, int k) { return cornerFrom(o, face.first + min(uint(k), face.count - 1u)); }

float flatHeight(vec3 normal, vec3 d) {
    float h = dot(normal, d);
    return abs(h) <= kFlat * length(d) ? 0.0 : h;
}

// Plane through the edge e0 e1 of one piece and a corner of the other, with both on its inner side: a wall of the shaft.
vec3 turned(vec3 best, vec3 edge, vec3 p, vec3 inside) {
    vec3 candidate = cross(edge, p);
    float size = length(candidate);
    bool better = size > 1e-6 * length(edge) * length(p) && (best == vec3(0.0) || dot(best, p) < 0.0);
    if (!better) return best;
    return (dot(candidate, inside) < 0.0 ? -candidate : candidate) / size;
}

void buildShaft() {
    vec3 ma = vec3(0.0), mb = vec3(0.0);
    for (int k = 0; k < kCorners; ++k) {
        ma += ca[k] / float(kCorners);
        mb += cb[k] / float(kCorners);
    }
    for (int k = 0; k < kCorners; ++k) {
        int next = (k + 1) % kCorners;
        vec3 n = vec3(0.0), m = vec3(0.0);
        for (int q = 0; q < kCorners; ++q) n = turned(n, ca[next] - ca[k], cb[q] - ca[k], ma - ca[k]);
        for (int q = 0; q < kCorners; ++q) m = turned(m, cb[next] - cb[k], ca[q] - cb[k], mb - cb[k]);
        for (int q = 0; q < kCorners; ++q) {
            if (dot(n, cb[q] - ca[k]) < -kFlat * length(cb[q] - ca[k])) n = vec3(0.0);
            if (dot(m, ca[q] - cb[k]) < -kFlat * length(ca[q] - cb[k])) m = vec3(0.0);
        }
        wall[k] = n;
        foot[k] = ca[k];
        wall[kCorners + k] = m;
        foot[kCorners + k] = cb[k];
    }
}

// Whether a wall of the shaft has the whole blocker outside.
bool outsideShaft(Origin o, uvec4 range) {
    uint outside = 0u;
    for (int w = 0; w < 2 * kCorners; ++w) outside |= wall[w] != vec3(0.0) ? 1u << w : 0u;
    [[dont_unroll]] for (uint c = 0u; c < range.y && outside != 0u; ++c) {
        vec3 p = cornerFrom(o, range.x + c);
        for (int w = 0; w < 2 * kCorners; ++w) {
            vec3 d = p - foot[w];
            if (dot(wall[w], d) > kFlat * (abs(d.x) + abs(d.y) + abs(d.z))) outside &= ~(1u << w);
        }
    }
    return outside != 0u;
}

// A convex blocker that all segments between corners cross hides the whole pair. `sense` is +1 where the first piece lies behind.
bool hides(Origin o, uvec4 range, float sense) {
    vec3 k0 = cornerFrom(o, range.x + range.y - 1u);
    bool all = true;
    [[dont_unroll]] for (uint c = 0u; c < range.y && all; ++c) {
        vec3 k1 = cornerFrom(o, range.x + c);
        for (int p = 0; p < kCorners; ++p) {
            vec3 n = sense * cross(k0 - ca[p], k1 - k0);
            float slack = -kFlat * length(n);
            for (int q = 0; q < kCorners; ++q) {
                vec3 d = cb[q] - ca[p];
                all = all && dot(n, d) >= slack * length(d);
            }
        }
        k0 = k1;
    }
    return all;
}

// Lists blockers with the pair on both sides of their plane, in front of both, and in the shaft. True when one hides the pair.
// Software devices run both sides of every branch, so the costly proof has its own, shorter loop.
bool listBlockers(uint i, uint j, Origin o) {
    buildShaft();
    [[dont_unroll]] for (uint w = 0u; w < params.words; ++w) {
        uint a = 3u * (i * params.words + w), b = 3u * (j * params.words + w);
        uint frontI = sides[a], frontJ = sides[b], backI = sides[a + 1u], backJ = sides[b + 1u];
        uint bits = ~((frontI & frontJ) | (backI & backJ) | sides[a + 2u] | sides[b + 2u]);
        if (params.closed != 0u) bits &= ~(backI | frontJ); // only fronts as seen from i
        uint inFront = frontI & ~backI & backJ & ~frontJ, behind = backI & ~frontI & frontJ & ~backJ;
        [[dont_unroll]] while (bits != 0u) {
            uint bit = findLSB(bits), mask = 1u << bit;
            bits &= bits - 1u;
            uint face = params.pieceCount + 32u * w + bit;
            bool keep = !outsideShaft(o, texelFetch(faceRange, int(face)));
            uint sense = (inFront & mask) != 0u ? kInFront : (behind & mask) != 0u ? kBehind : 0u;
            if (keep && listedCount < kExactListed) listed[listedCount] = face | sense;
            if (keep) ++listedCount;
        }
    }
    bool hidden = false;
    [[dont_unroll]] for (uint m = 0u; m < min(listedCount, kExactListed) && !hidden; ++m) {
        uint entry = listed[m];
        listed[m] = entry & ~(kInFront | kBehind);
        hidden = (entry & (kInFront | kBehind)) != 0u &&
                 hides(o, texelFetch(faceRange, int(listed[m])), (entry & kInFront) != 0u ? -1.0 : 1.0);
    }
    return hidden;
}

// Three points of degree 2 in each triangle of a fan.
vec3 gaussPoint(vec3 a, vec3 b, vec3 c, int k) {
    vec3 sum = (a + b + c) / 6.0;
    return sum + 0.5 * (k == 0 ? a : k == 1 ? b : c);
}

// A_i F_ij by a product of rules; for pairs whose distance exceeds their size.
float productRule(Face a, Face b) {
    float sum = 0.0;
    for (int p = 1; p + 1 < kCorners; ++p) {
        float areaA = length(cross(ca[p] - ca[0], ca[p + 1] - ca[0])) / 6.0;
        for (int q = 1; q + 1 < kCorners; ++q) {
            float weight = areaA * length(cross(cb[q] - cb[0], cb[q + 1] - cb[0])) / 6.0;
            for (int k = 0; k < 3; ++k) {
                vec3 x = gaussPoint(ca[0], ca[p], ca[p + 1], k);
                for (int l = 0; l < 3; ++l) {
                    vec3 d = gaussPoint(cb[0], cb[q], cb[q + 1], l) - x;
                    float r2 = dot(d, d);
                    sum += weight * max(0.0, dot(a.normal, d)) * max(0.0, -dot(b.normal, d)) / (r2 * r2);
                }
            }
        }
    }
    return sum * kInversePi;
}

void writeRecord(uint slot, uint outer, uint inner, uint first, uint count) {
    records[slot] = ExactRecord(outer, inner, first, count);
}

void addPartial(uint i, uint j) {
    // Points lie on the side farther from the blockers' planes, where shadows are blurred; but not on a much larger piece.
    Origin o = originAt(texelFetch(faceRange, int(i)).x);
    vec3 ci = centreFrom(o, i), cj = centreFrom(o, j);
    float clearI = 1e30, clearJ = 1e30;
    [[dont_unroll]] for (uint m = 0u; m < listedCount; ++m) {
        vec3 n = texelFetch(faceNormal, int(listed[m])).xyz;
        vec3 k = cornerFrom(o, texelFetch(faceRange, int(listed[m])).x);
        clearI = min(clearI, abs(dot(n, ci - k)));
        clearJ = min(clearJ, abs(dot(n, cj - k)));
    }
    float areaI = texelFetch(faceNormal, int(i)).w, areaJ = texelFetch(faceNormal, int(j)).w;
    bool iIsOuter = clearI * sqrt(areaJ) >= clearJ * sqrt(areaI);
    uint first = atomicAdd(counters[kExactListCount], listedCount);
    uint slot = atomicAdd(counters[kExactPartialCount], 1u);
    if (first + listedCount > params.listCapacity || slot >= params.recordCapacity) {
        atomicAdd(counters[kExactOverflowCount], 1u);
        return;
    }
    [[dont_unroll]] for (uint m = 0u; m < listedCount; ++m) lists[first + m] = listed[m];
    writeRecord(params.recordCapacity - 1u - slot, iIsOuter ? i : j, iIsOuter ? j : i, first, listedCount);
}

void addVisible(uint i, uint j, Face a, Face b, bool straddles) {
    Origin o = originAt(a.first);
    vec3 d = centreFrom(o, j) - centreFrom(o, i);
    float radii = texelFetch(faceCentre, int(i)).w + texelFetch(faceCentre, int(j)).w;
    float r2 = dot(d, d), q = radii * inversesqrt(r2);
    // The rule's error falls with the cube of size over distance.
    float error = max(a.area, b.area) * kInversePi / r2 * 0.5 * q * q * q;
    if (!straddles && q < 0.6 && error < params.tolerance) {
        float exchange = productRule(a, b);
        rows[(i - params.firstRow) * params.pieceCount + j] = exchange / a.area;
        columns[(j - params.firstColumn) * params.pieceCount + i] = exchange / b.area;
        return;
    }
    uint slot = atomicAdd(counters[kExactVisibleCount], 1u);
    if (slot >= params.recordCapacity) {
        atomicAdd(counters[kExactOverflowCount], 1u);
        return;
    }
    bool iIsOuter = a.area <= b.area;
    writeRecord(slot, iIsOuter ? i : j, iIsOuter ? j : i, 0u, 0u);
}

void main() {
    uint i = params.stripRow + gl_WorkGroupID.y, j = params.stripColumn + gl_GlobalInvocationID.x;
    if (j >= params.columnEnd || j <= i) return;
    Face a = faceAt(i), b = faceAt(j);
    if (a.room != b.room) return;
    Origin o = originAt(a.first);
    for (int k = 0; k < kCorners; ++k) {
        ca[k] = corner(o, a, k);
        cb[k] = corner(o, b, k);
    }
    vec2 overA = vec2(1e30, -1e30), overB = overA;
    for (int k = 0; k < kCorners; ++k) {
        float h = flatHeight(a.normal, cb[k] - ca[0]), g = flatHeight(b.normal, ca[k] - cb[0]);
        overA = vec2(min(overA.x, h), max(overA.y, h));
        overB = vec2(min(overB.x, g), max(overB.y, g));
    }
    if (overA.y <= 0.0 || overB.y <= 0.0) return;
    if (listBlockers(i, j, o)) return;
    if (listedCount > kExactListed) {
        atomicAdd(counters[kExactOverflowCount], 1u);
        listedCount = kExactListed;
    }
    if (listedCount > 0u)
        addPartial(i, j);
    else
        addVisible(i, j, a, b, overA.x < 0.0 || overB.x < 0.0);
}
