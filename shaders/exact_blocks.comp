// One pair of clusters: not facing and hidden are dropped; the rest becomes a block, with one bit for each blocker that
// may stand between.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_vote : require
#include "shaders/io/exact_form_factors.io.h"
#include "shaders/lib/exact_scene.glsl"
#include "shaders/lib/exact_shaft.glsl"
#include "shaders/lib/loop_limit.glsl"

layout(local_size_x = kExactGroup) in;
layout(set = 0, binding = 5) uniform usamplerBuffer clusters;
layout(set = 0, binding = 6) uniform usamplerBuffer sidesA;
layout(set = 0, binding = 7) uniform usamplerBuffer sidesB;
layout(set = 0, binding = 8, scalar) buffer Counters { uint counters[]; };
layout(set = 0, binding = 9, scalar) writeonly buffer Blocks { uint blocks[]; };
layout(set = 0, binding = 10, scalar) writeonly buffer Masks { uint masks[]; }; // [block][word]
layout(push_constant, scalar) uniform Push { ExactBlocksParams params; };

void addBlock(uint block, bool clear) {
    uint slot = atomicAdd(counters[clear ? kExactClearCount : kExactMixedCount], 1u);
    blocks[clear ? slot : params.countA * params.countB - 1u - slot] = block;
}

// Writes the mask; returns whether it is empty. `hidden` when one blocker hides all.
bool findBlockers(uint a, uint b, Origin o, uint block, out bool hidden) {
    bool clear = true;
    hidden = false;
    buildShaft();
    uint w = 0u;
    [[dont_unroll]] do {
        uvec4 sa = texelFetch(sidesA, int((params.piecesA + a - params.firstA) * params.words + w));
        uvec4 sb = texelFetch(sidesB, int((params.piecesB + b - params.firstB) * params.words + w));
        uint bits = between(sa, sb), wholes = wholesBetween(sa, sb), mask = 0u;
        [[dont_unroll]] do {
            uint bit = bits & (~bits + 1u);
            bits &= ~bit;
            uvec4 range = texelFetch(faceRange, int(params.pieceCount + 32u * w) + max(findLSB(bit), 0));
            bvec2 found = standing(o, range, (sa.x & bit) != 0u ? -1.0 : 1.0);
            if (bit != 0u && !hidden && !found.x) {
                mask |= bit;
                hidden = (bit & wholes) != 0u && found.y;
            }
        } while (subgroupAny(bits != 0u && !hidden));
        masks[block * params.words + w] = mask;
        clear = clear && mask == 0u;
        ++w;
    } while (w < params.words);
    return clear;
}

void main() {
    uint a = params.firstA + gl_WorkGroupID.y, b = params.firstB + gl_GlobalInvocationID.x;
    if (b >= params.firstB + params.countB || b < a) return;
    uvec4 clusterA = texelFetch(clusters, int(a)), clusterB = texelFetch(clusters, int(b));
    Face faceA = faceAt(clusterA.z), faceB = faceAt(clusterB.z);
    if (faceA.room != faceB.room) return;
    uint block = (a - params.firstA) * params.countB + b - params.firstB;
    if (clusterA.w == 0u || clusterB.w == 0u) {
        [[dont_unroll]] for (uint w = 0u; w < params.words; ++w) masks[block * params.words + w] = ~0u;
        addBlock(block, false);
        return;
    }
    Origin o = originAt(faceA.first);
    loadCorners(o, faceA, faceB);
    vec4 heights = mutualHeights(faceA.normal, faceB.normal);
    if (heights.y <= 0.0 || heights.w <= 0.0) return;
    bool hidden;
    bool clear = findBlockers(a, b, o, block, hidden);
    if (!hidden) addBlock(block, clear);
    if (cutShort(2u + min(params.pieceCount, 2u))) atomicAdd(counters[kExactCutCount], 1u);
}
