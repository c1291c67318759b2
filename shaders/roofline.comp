// What a device can do at most: multiply-adds out of registers, or reads of a texel buffer in order. Results are
// stored, so that nothing may be left out.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/roofline.io.h"

layout(local_size_x = kRooflineGroup) in;
layout(constant_id = 0) const bool kReads = false;
layout(set = 0, binding = 0) uniform samplerBuffer source; // rgba32f, rounds x invocations texels
layout(set = 0, binding = 1, scalar) writeonly buffer Sums { float sums[]; };
layout(push_constant, scalar) uniform Push { RooflineParams params; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    vec4 a = vec4(0), b = a, c = a, d = a, e = a, f = a, g = a, h = a;
    if (kReads)
        for (uint k = 0u; k < params.rounds; ++k) a += texelFetch(source, int(k * params.invocations + i));
    else
        for (uint k = 0u; k < params.rounds; ++k) {
            a = fma(a, vec4(params.factor), vec4(params.addend));
            b = fma(b, vec4(params.factor), vec4(params.addend));
            c = fma(c, vec4(params.factor), vec4(params.addend));
            d = fma(d, vec4(params.factor), vec4(params.addend));
            e = fma(e, vec4(params.factor), vec4(params.addend));
            f = fma(f, vec4(params.factor), vec4(params.addend));
            g = fma(g, vec4(params.factor), vec4(params.addend));
            h = fma(h, vec4(params.factor), vec4(params.addend));
        }
    vec4 sum = a + b + c + d + e + f + g + h;
    sums[i] = sum.x + sum.y + sum.z + sum.w;
}
