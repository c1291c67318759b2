// y = a x + b over floats: the smallest kernel, by which the tests prove the Vulkan substrate.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/affine.io.h"

layout(local_size_x = kAffineGroup) in;
layout(set = 0, binding = 0) uniform samplerBuffer x;
layout(set = 0, binding = 1, scalar) writeonly buffer Y { float y[]; };
layout(push_constant, scalar) uniform Push { AffineParams params; };
layout(constant_id = 0) const bool kNegate = false;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= params.count) return;
    float value = params.scale * texelFetch(x, int(i)).r + params.offset;
    y[i] = kNegate ? -value : value;
}
