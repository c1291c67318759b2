// Pairs of pieces of one block: not facing and proven hidden stay zero; far and visible is integrated here by a product
// rule; the rest becomes a record, with the blockers that may stand between.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_vote : require
#include "shaders/io/exact_form_factors.io.h"
#include "shaders/lib/constants.glsl"
#include "shaders/lib/exact_scene.glsl"
#include "shaders/lib/exact_shaft.glsl"
#include "shaders/lib/loop_limit.glsl"

layout(local_size_x = kExactGroup) in;
layout(set = 0, binding = 5) uniform usamplerBuffer clusters;
layout(set = 0, binding = 6) uniform usamplerBuffer sidesA;
layout(set = 0, binding = 7) uniform usamplerBuffer sidesB;
layout(set = 0, binding = 8, scalar) buffer Counters { uint counters[]; };
layout(set = 0, binding = 9, scalar) readonly buffer Blocks { uint blocks[]; };
layout(set = 0, binding = 10, scalar) readonly buffer Masks { uint masks[]; };
layout(set = 0, binding = 11, scalar) writeonly buffer Records { ExactRecord records[]; };
layout(set = 0, binding = 12, scalar) buffer Lists { uint lists[]; };
layout(set = 0, binding = 13, scalar) writeonly buffer There { float there[]; }; // [row][column]
layout(set = 0, binding = 14, scalar) writeonly buffer Back { float back[]; };   // [column][row]
layout(set = 0, binding = 15, scalar) writeonly buffer FewRecords { ExactRecord fewRecords[]; };
layout(push_constant, scalar) uniform Push { ExactPairsParams params; };
layout(constant_id = 1) const bool kClear = true; // nothing can stand in any of these blocks

uint listed[kExactListed]; // the first of them
uint listedCount;
uint firstListed; // in `lists`
bool listFits;
bool few; // exact_few.comp can do the pair

uint betweenOf(uint i, uint j, uint block, uint w, out uint front, out uint wholes) {
    uvec4 si = texelFetch(sidesA, int((i - params.firstPieceA) * params.words + w));
    uvec4 sj = texelFetch(sidesB, int((j - params.firstPieceB) * params.words + w));
    front = si.x;
    wholes = wholesBetween(si, sj);
    return between(si, sj) & masks[block * params.words + w];
}

// Lists blockers of the block's mask that may stand between; true when one hides the pair. Those beyond what `listed`
// holds go straight to `lists`, on a second walk.
bool listBlockers(uint i, uint j, Origin o, uint block) {
    buildShaft();
    bool hidden = false, walks = true, again = false;
    [[dont_unroll]] do {
        uint w = walks ? 0u : params.words - 1u, front, wholes, count = 0u;
        uint bits = betweenOf(i, j, block, w, front, wholes);
        bits = walks ? bits : 0u;
        [[dont_unroll]] do {
            bool more;
            [[dont_unroll]] do { // to the next blocker
                more = bits == 0u && w + 1u < params.words;
                if (more) bits = betweenOf(i, j, block, ++w, front, wholes);
            } while (subgroupAny(more));
            uint bit = bits & (~bits + 1u);
            bits &= ~bit;
            uint face = params.pieceCount + 32u * w + uint(max(findLSB(bit), 0));
            uvec4 range = texelFetch(faceRange, int(face));
            bvec2 found = standing(o, range, (front & bit) != 0u ? -1.0 : 1.0);
            if (bit != 0u && !hidden && !found.x) {
                if (again && count >= kExactListed) lists[firstListed + count] = face;
                if (!again && count < kExactListed) listed[count] = face;
                ++count;
                few = few && range.y <= kExactFewCorners;
                hidden = (bit & wholes) != 0u && found.y;
            }
        } while (subgroupAny(!hidden && (bits != 0u || w + 1u < params.words)));
        if (!again) {
            listedCount = hidden ? 0u : count;
            firstListed = listedCount > 0u ? atomicAdd(counters[kExactListCount], listedCount) : 0u;
            listFits = firstListed + listedCount <= params.listCapacity;
        }
        walks = !again && listFits && listedCount > kExactListed;
        again = true;
    } while (subgroupAny(walks));
    return hidden;
}

// Three points of degree 2 in each triangle of a fan.
vec3 gaussPoint(vec3 a, vec3 b, vec3 c, int k) {
    vec3 sum = (a + b + c) / 6.0;
    return sum + 0.5 * (k == 0 ? a : k == 1 ? b : c);
}

// A_i F_ij by a product of rules; for pairs whose distance exceeds their size.
float productRule(vec3 normalA, vec3 normalB) {
    float sum = 0.0;
    [[unroll]] for (int p = 1; p + 1 < kCorners; ++p) {
        float areaA = length(cross(ca[p] - ca[0], ca[p + 1] - ca[0])) / 6.0;
        [[unroll]] for (int q = 1; q + 1 < kCorners; ++q) {
            float weight = areaA * length(cross(cb[q] - cb[0], cb[q + 1] - cb[0])) / 6.0;
            [[unroll]] for (int k = 0; k < 3; ++k) {
                vec3 x = gaussPoint(ca[0], ca[p], ca[p + 1], k);
                [[unroll]] for (int l = 0; l < 3; ++l) {
                    vec3 d = gaussPoint(cb[0], cb[q], cb[q + 1], l) - x;
                    float r2 = dot(d, d);
                    sum += weight * max(0.0, dot(normalA, d)) * max(0.0, -dot(normalB, d)) / (r2 * r2);
                }
            }
        }
    }
    return sum * kInversePi;
}

// How far both points are from a blocker, nearly: beside its plane and beyond its edges.
vec2 distancesTo(Origin o, vec3 p, vec3 q, uint face) {
    uvec4 range = texelFetch(faceRange, int(face));
    vec3 n = texelFetch(faceNormal, int(face)).xyz, k0 = cornerFrom(o, range.x + range.y - 1u);
    vec2 height = vec2(dot(n, p - k0), dot(n, q - k0)), beyond = vec2(0.0);
    uint c = 0u;
    [[dont_unroll]] do {
        vec3 k1 = cornerFrom(o, range.x + min(c, range.y - 1u)); // the last one again adds nothing
        vec3 outwards = cross(k1 - k0, n);
        outwards *= inversesqrt(max(dot(outwards, outwards), kTiny));
        beyond = max(beyond, vec2(dot(outwards, p - k0), dot(outwards, q - k0)));
        k0 = k1;
        ++c;
    } while (subgroupAny(c < range.y));
    return sqrt(height * height + beyond * beyond);
}

// Whether points lie on the first piece: the one farther from the blockers, where shadows are blurred, unless it is
// much larger; in the open the smaller. Blockers that `listed` holds are put into `lists`.
bool firstIsOuter(uint i, uint j, Origin o, float areaI, float areaJ) {
    vec3 ci = centreFrom(o, i), cj = centreFrom(o, j);
    vec2 clear = vec2(kHuge);
    uint count = listFits ? listedCount : min(listedCount, kExactListed);
    uint m = 0u;
    [[dont_unroll]] do {
        uint k = min(m, count - 1u);
        uint face = k < kExactListed ? listed[k] : lists[firstListed + k];
        clear = min(clear, distancesTo(o, ci, cj, face));
        if (listFits && m < min(count, kExactListed)) lists[firstListed + m] = face;
        ++m;
    } while (subgroupAny(m < count));
    return clear.x * sqrt(areaJ) >= clear.y * sqrt(areaI);
}

void addRecord(uint outer, uint inner, bool byLines) {
    few = few && listedCount <= kExactFew;
    // By lines few with one blocker are left: not worth a kernel of their own.
    uint kind = byLines                                     ? kExactLineCount
                : !few                                      ? kExactManyCount
                : listedCount == 0u                         ? kExactOpenCount
                : listedCount == 1u && params.byLines == 0u ? kExactOneCount
                                                            : kExactTwoCount;
    bool fromEnd = kind == kExactManyCount || kind == kExactTwoCount;
    if (kind == kExactManyCount && listedCount == 0u) atomicAdd(counters[kExactOpenManyCount], 1u);
    uint slot = atomicAdd(counters[kind], 1u), place = fromEnd ? params.recordCapacity - 1u - slot : slot;
    ExactRecord record = ExactRecord(outer, inner, firstListed, listedCount);
    if (slot >= params.recordCapacity) return;
    if (byLines || few && listedCount > 0u)
        fewRecords[place] = record;
    else
        records[place] = record;
}

// Whether the product rule is good enough: its error falls with the cube of size over distance.
bool isFar(uint i, uint j, Origin o, float areaI, float areaJ) {
    vec4 ci = texelFetch(faceCentre, int(i)), cj = texelFetch(faceCentre, int(j));
    vec3 d = cb[0] + cj.xyz - ci.xyz;
    float r2 = dot(d, d), q = (ci.w + cj.w) * inversesqrt(r2);
    return q < 0.6 && max(areaI, areaJ) * kInversePi / r2 * 0.5 * q * q * q < params.tolerance;
}

void classify(uint i, uint j, uint block) {
    Face a = faceAt(i), b = faceAt(j);
    Origin o = originAt(a.first);
    loadCorners(o, a, b);
    vec4 heights = mutualHeights(a.normal, b.normal);
    bool facing = heights.y > 0.0 && heights.w > 0.0, straddles = heights.x < 0.0 || heights.z < 0.0;
    bool hidden = false;
    listedCount = firstListed = 0u;
    few = max(a.count, b.count) <= kExactFewCorners;
    if (!kClear && facing) hidden = listBlockers(i, j, o, block);
    if (!facing || hidden) return;
    bool partial = listedCount > 0u, far = !straddles && isFar(i, j, o, a.area, b.area), iIsOuter = a.area <= b.area;
    if (far && !partial) {
        float exchange = productRule(a.normal, b.normal);
        uint row = texelFetch(faceRange, int(i)).w, column = texelFetch(faceRange, int(j)).w;
        ExactHalves h = params.halves;
        there[h.firstThere + row * h.strideThere + column] = exchange / a.area;
        back[h.firstBack + column * h.strideBack + row] = exchange / b.area;
        return;
    }
    if (!kClear && partial) iIsOuter = firstIsOuter(i, j, o, a.area, b.area);
    bool byLines = partial && far && params.byLines != 0u && listedCount <= kExactLongList && few && kCorners == 3;
    addRecord(iIsOuter ? i : j, iIsOuter ? j : i, byLines);
}

void main() {
    uint block = blocks[params.firstBlock + gl_WorkGroupID.y];
    uvec4 a = texelFetch(clusters, int(params.firstA + block / params.countB));
    uvec4 b = texelFetch(clusters, int(params.firstB + block % params.countB));
    uint count = a.y * b.y, p = gl_GlobalInvocationID.x;
    [[dont_unroll]] do {
        uint i = a.x + p / b.y, j = b.x + p % b.y;
        if (p < count && i < j) classify(i, j, block);
        p += gl_NumWorkGroups.x * kExactGroup;
    } while (subgroupAny(p < count));
    if (!kClear && cutShort(2u + min(params.pieceCount, 2u))) atomicAdd(counters[kExactCutCount], 1u);
}
