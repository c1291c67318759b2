// What a patch receives: the mean over its triangles.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/io/hierarchical.io.h"

layout(local_size_x = kHierarchicalGroup) in;
layout(set = 0, binding = 0) uniform usamplerBuffer firstLeaf; // per patch, one more at the end
layout(set = 0, binding = 1) uniform usamplerBuffer leafNodes; // node, share of the patch's area
layout(set = 0, binding = 2, scalar) readonly buffer Received { vec4 received[]; };
layout(set = 0, binding = 3, scalar) writeonly buffer Gathered { float gathered[]; }; // columns x patchCount
layout(push_constant, scalar) uniform Push { HierarchicalSweepParams params; };

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.nodeCount * params.columns) return;
    uint patch_ = params.firstNode + index / params.columns, column = index % params.columns;
    float sum = 0.0;
    uint end = texelFetch(firstLeaf, int(patch_ + 1u)).x;
    [[dont_unroll]] for (uint k = texelFetch(firstLeaf, int(patch_)).x; k < end; ++k) {
        uvec4 leaf = texelFetch(leafNodes, int(k));
        sum += uintBitsToFloat(leaf.y) * received[leaf.x * params.columns + column].x;
    }
    gathered[column * params.patchCount + patch_] = sum;
}
