// Across the links: what each cluster receives at its centre and how that changes along its axes. A subgroup sums one
// cluster's links in an order that never changes.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "shaders/io/hierarchical.io.h"

layout(local_size_x = kHierarchicalGroup) in;
layout(constant_id = 0) const uint kColumns = 3u;
// Per node, one more at the end; counted from the window's.
layout(set = 0, binding = 0) uniform usamplerBuffer firstEntry;
// Other node, density, own slopes, the other's, as halves.
layout(set = 0, binding = 1) uniform usamplerBuffer entries;
layout(set = 0, binding = 2) uniform samplerBuffer moments; // nodes x columns
layout(set = 0, binding = 3, scalar) writeonly buffer Received { vec4 received[]; }; // nodes x columns
layout(push_constant, scalar) uniform Push { HierarchicalSweepParams params; };

void main() {
    uint k = gl_WorkGroupID.x * gl_NumSubgroups + gl_SubgroupID;
    if (k >= params.nodeCount) return;
    uint node = params.firstNode + k;
    uint base = texelFetch(firstEntry, int(params.firstNode)).x / kHierarchicalAlign * kHierarchicalAlign;
    uint begin = texelFetch(firstEntry, int(node)).x - base, end = texelFetch(firstEntry, int(node + 1u)).x - base;
    vec3 sums[4];
    for (uint c = 0u; c < kColumns; ++c) sums[c] = vec3(0.0);
    for (uint e = begin + gl_SubgroupInvocationID; e < end; e += gl_SubgroupSize) {
        uvec4 entry = texelFetch(entries, int(e));
        float density = uintBitsToFloat(entry.y);
        vec2 own = density * unpackHalf2x16(entry.z), other = density * unpackHalf2x16(entry.w);
        for (uint c = 0u; c < kColumns; ++c) {
            vec3 m = texelFetch(moments, int(entry.x * kColumns + c)).xyz;
            sums[c] += vec3(density * m.x + other.x * m.y + other.y * m.z, own * m.x);
        }
    }
    for (uint c = 0u; c < kColumns; ++c) {
        vec3 sum = subgroupAdd(sums[c]);
        if (subgroupElect()) received[node * kColumns + c] = vec4(sum, 0.0);
    }
}
