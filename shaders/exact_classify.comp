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

const float kInversePi = 0.318309886184;

uint listed[kExactListed];
uint listedCount = 0u;

// Blockers with the pair on both sides of their plane and in front of both.
void listBlockers(uint i, uint j) {
    [[dont_unroll]] for (uint w = 0u; w < params.words; ++w) {
        uint a = 3u * (i * params.words + w), b = 3u * (j * params.words + w);
        uint bits = ~((sides[a] & sides[b]) | (sides[a + 1u] & sides[b + 1u]) | sides[a + 2u] | sides[b + 2u]);
        if (params.closed != 0u) bits &= ~(sides[a + 1u] | sides[b]); // only fronts as seen from i
        [[dont_unroll]] while (bits != 0u) {
            uint bit = findLSB(bits);
            bits &= bits - 1u;
            if (listedCount < kExactListed)
                listed[listedCount] = params.pieceCount + 32u * w + bit;
            ++listedCount;
        }
    }
}

// Plane through an edge of `a` that has `a` and `b` on its inner side, touching `b`: a wall of the shaft between them.
vec3 shaftWall(Origin o, vec3 e0, vec3 e1, vec3 inside, Face b, out bool holds) {
    vec3 edge = e1 - e0;
    vec3 wall = vec3(0.0);
    bool first = true;
    [[dont_unroll]] for (uint k = 0u; k < b.count; ++k) {
        vec3 p = cornerFrom(o, b.first + k) - e0;
        if (first || dot(wall, p) < 0.0) {
            vec3 candidate = cross(edge, p);
            float size = length(candidate);
            if (size <= 1e-6 * length(edge) * length(p)) continue;
            candidate /= size;
            wall = dot(candidate, inside - e0) < 0.0 ? -candidate : candidate;
            first = false;
        }
    }
    holds = !first;
    [[dont_unroll]] for (uint k = 0u; k < b.count; ++k) {
        vec3 p = cornerFrom(o, b.first + k) - e0;
        if (dot(wall, p) < -kFlat * length(p)) holds = false;
    }
    return wall;
}

// Drops listed blockers that lie outside a wall of the shaft.
void cullByShaft(Face a, Face b) {
    if (listedCount == 0u) return;
    Origin o = originAt(a.first);
    vec3 inside = vec3(0.0);
    [[dont_unroll]] for (uint k = 0u; k < a.count; ++k) inside += cornerFrom(o, a.first + k) / float(a.count);
    [[dont_unroll]] for (uint k = 0u; k < a.count && listedCount > 0u; ++k) {
        vec3 e0 = cornerFrom(o, a.first + k), e1 = cornerFrom(o, a.first + (k + 1u) % a.count);
        bool holds;
        vec3 wall = shaftWall(o, e0, e1, inside, b, holds);
        if (!holds) continue;
        uint kept = 0u;
        [[dont_unroll]] for (uint m = 0u; m < listedCount; ++m) {
            uvec4 range = texelFetch(faceRange, int(listed[m]));
            bool outside = true;
            [[dont_unroll]] for (uint c = 0u; c < range.y && outside; ++c) {
                vec3 p = cornerFrom(o, range.x + c) - e0;
                outside = dot(wall, p) <= kFlat * length(p);
            }
            if (!outside) listed[kept++] = listed[m];
        }
        listedCount = kept;
    }
}

// A convex blocker that all segments between corners cross hides the whole pair.
bool hides(Face blocker, Face a, Face b) {
    Origin o = originAt(a.first);
    vec3 k0 = cornerFrom(o, blocker.first);
    [[dont_unroll]] for (uint p = 0u; p < a.count; ++p) {
        vec3 x = cornerFrom(o, a.first + p);
        float side = dot(blocker.normal, x - k0);
        [[dont_unroll]] for (uint q = 0u; q < b.count; ++q)
            if (dot(blocker.normal, cornerFrom(o, b.first + q) - k0) * side > 0.0) return false;
        if (abs(side) <= kFlat * length(x - k0)) return false;
        [[dont_unroll]] for (uint c = 0u; c < blocker.count; ++c) {
            vec3 n = cross(cornerFrom(o, blocker.first + c) - x,
                           cornerFrom(o, blocker.first + (c + 1u) % blocker.count) - x);
            if (side > 0.0) n = -n;
            float size = length(n);
            [[dont_unroll]] for (uint q = 0u; q < b.count; ++q) {
                vec3 d = cornerFrom(o, b.first + q) - x;
                if (dot(n, d) < -kFlat * size * length(d)) return false;
            }
        }
    }
    return true;
}

// Three points of degree 2 in each triangle of a fan.
vec3 gaussPoint(vec3 a, vec3 b, vec3 c, uint k) {
    vec3 sum = (a + b + c) / 6.0;
    return sum + 0.5 * (k == 0u ? a : k == 1u ? b : c);
}

// A_i F_ij by a product of rules; for pairs whose distance exceeds their size.
float productRule(Face a, Face b) {
    Origin o = originAt(a.first);
    float sum = 0.0;
    [[dont_unroll]] for (uint p = 1u; p + 1u < a.count; ++p) {
        vec3 a1 = cornerFrom(o, a.first + p), a2 = cornerFrom(o, a.first + p + 1u);
        float areaA = length(cross(a1, a2)) / 6.0;
        vec3 b0 = cornerFrom(o, b.first), b1 = cornerFrom(o, b.first + 1u);
        [[dont_unroll]] for (uint q = 1u; q + 1u < b.count; ++q) {
            vec3 b2 = cornerFrom(o, b.first + q + 1u);
            float weight = areaA * length(cross(b1 - b0, b2 - b0)) / 6.0;
            [[dont_unroll]] for (uint k = 0u; k < 3u; ++k) {
                vec3 x = gaussPoint(vec3(0.0), a1, a2, k);
                [[dont_unroll]] for (uint l = 0u; l < 3u; ++l) {
                    vec3 d = gaussPoint(b0, b1, b2, l) - x;
                    float r2 = dot(d, d);
                    sum += weight * max(0.0, dot(a.normal, d)) * max(0.0, -dot(b.normal, d)) / (r2 * r2);
                }
            }
            b1 = b2;
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
    uint column = gl_GlobalInvocationID.x, i = params.firstRow + gl_WorkGroupID.y;
    uint j = params.firstColumn + column;
    if (column >= params.columnCount || j <= i) return;
    Face a = faceAt(i), b = faceAt(j);
    if (a.room != b.room) return;
    vec2 overA = heightsOver(a, b), overB = heightsOver(b, a);
    if (overA.y <= 0.0 || overB.y <= 0.0) return;
    listBlockers(i, j);
    if (listedCount > kExactListed) {
        atomicAdd(counters[kExactOverflowCount], 1u);
        listedCount = kExactListed;
    }
    cullByShaft(a, b);
    cullByShaft(b, a);
    [[dont_unroll]] for (uint m = 0u; m < listedCount; ++m)
        if (hides(faceAt(listed[m]), a, b)) return;
    if (listedCount > 0u)
        addPartial(i, j);
    else
        addVisible(i, j, a, b, overA.x < 0.0 || overB.x < 0.0);
}
