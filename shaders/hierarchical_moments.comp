// Upwards, one level of the trees: what each cluster radiates in all, and its first moments along its axes.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/hierarchical.io.h"

layout(local_size_x = kHierarchicalGroup) in;
layout(set = 0, binding = 0) uniform usamplerBuffer family; // child, patch of a leaf, area, -
// Two a node: centre's coordinates in its parent | axes in the parent's
layout(set = 0, binding = 1) uniform samplerBuffer frames;
layout(set = 0, binding = 2, scalar) readonly buffer Light { float light[]; }; // columns x patchCount
layout(set = 0, binding = 3, scalar) buffer Moments { vec4 moments[]; };       // nodes x columns
layout(push_constant, scalar) uniform Push { HierarchicalSweepParams params; };

vec3 fromChild(uint child, uint column) {
    vec3 m = moments[child * params.columns + column].xyz;
    vec2 at = texelFetch(frames, int(2u * child)).xy;
    vec4 axes = texelFetch(frames, int(2u * child + 1u));
    return vec3(m.x, m.x * at.x + m.y * axes.x + m.z * axes.z, m.x * at.y + m.y * axes.y + m.z * axes.w);
}

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.nodeCount * params.columns) return;
    uint node = params.firstNode + index / params.columns, column = index % params.columns;
    uvec4 kin = texelFetch(family, int(node));
    vec3 m;
    if (kin.x == 0u)
        m = vec3(uintBitsToFloat(kin.z) * light[column * params.patchCount + kin.y], 0.0, 0.0);
    else
        m = fromChild(kin.x, column) + fromChild(kin.x + 1u, column);
    moments[node * params.columns + column] = vec4(m, 0.0);
}
