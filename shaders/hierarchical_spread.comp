// Downwards, one level of the trees: a cluster's share of what its parent received.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/hierarchical.io.h"

layout(local_size_x = kHierarchicalGroup) in;
layout(set = 0, binding = 0) uniform usamplerBuffer parents;
layout(set = 0, binding = 1) uniform samplerBuffer frames; // as in hierarchical_moments.comp
layout(set = 0, binding = 2, scalar) buffer Received { vec4 received[]; };
layout(push_constant, scalar) uniform Push { HierarchicalSweepParams params; };

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.nodeCount * params.columns) return;
    uint node = params.firstNode + index / params.columns, column = index % params.columns;
    vec3 parent = received[texelFetch(parents, int(node)).x * params.columns + column].xyz;
    vec2 at = texelFetch(frames, int(2u * node)).xy;
    vec4 axes = texelFetch(frames, int(2u * node + 1u));
    vec3 own = vec3(parent.x + dot(parent.yz, at), dot(parent.yz, axes.xy), dot(parent.yz, axes.zw));
    received[node * params.columns + column] += vec4(own, 0.0);
}
