// Loops of as many turns as asked for, and whether lib/loop_limit.glsl finds that they were cut short: by it tests
// prove that no device ends them unnoticed.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/io/long_loop.io.h"
#include "shaders/lib/loop_limit.glsl"

layout(local_size_x = kLongLoopGroup) in;
layout(set = 0, binding = 0, scalar) writeonly buffer Y { uvec2 y[]; }; // the last number, 1 where cut
layout(push_constant, scalar) uniform Push { LongLoopParams params; };

void main() {
    uint number = gl_GlobalInvocationID.x;
    [[dont_unroll]] for (uint loop = 0u; loop < params.loops; ++loop)
        [[dont_unroll]] for (uint turn = 0u; turn < params.turns; ++turn)
            number = (number ^ (number >> 15u)) * 747796405u + 2891336453u;
    y[gl_GlobalInvocationID.x] = uvec2(number, cutShort(2u + min(params.turns, 2u)) ? 1u : 0u);
}
