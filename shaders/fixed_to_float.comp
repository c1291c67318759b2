// In place: fixed-point sums to float32.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/fixed_to_float.io.h"

layout(local_size_x = kFixedToFloatGroup) in;
layout(set = 0, binding = 0, scalar) buffer Values { uint values[]; };
layout(push_constant, scalar) uniform Push { FixedToFloatParams params; };

void main() {
    uint first = gl_WorkGroupID.x * kFixedToFloatGroup * kFixedToFloatEach + gl_LocalInvocationIndex;
    for (uint k = 0u; k < kFixedToFloatEach; ++k) {
        uint i = first + k * kFixedToFloatGroup;
        if (i < params.count) values[i] = floatBitsToUint(float(values[i]) * params.unit);
    }
}
