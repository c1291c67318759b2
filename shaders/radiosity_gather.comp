// H = F B for one to four columns of light at once: illuminance that patches receive from all others. A subgroup sums four
// rows, so that light is fetched once for four; F is read once from a texel buffer, the fastest way for read-only data on
// devices without large caches. The order of every sum is fixed.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "shaders/io/radiosity_gather.io.h"

layout(local_size_x = kGatherGroup) in;
layout(constant_id = 0) const uint kColumns = 3u;
layout(set = 0, binding = 0) uniform samplerBuffer factors; // window of F, rgba32f
layout(set = 0, binding = 1) uniform samplerBuffer light;   // shifted columns, rgba32f
layout(set = 0, binding = 2, scalar) writeonly buffer Gathered { float gathered[]; }; // columns x patchCount
layout(push_constant, scalar) uniform Push { RadiosityGatherParams params; };

void main() {
    uint n = params.patchCount;
    uint block = gl_WorkGroupID.x * gl_NumSubgroups + gl_SubgroupID;
    // Rows first, first + 4, ... have the same place within their texels, whatever n is.
    uint first = 16u * (block / 4u) + block % 4u;
    uint shift = (first * n) % 4u;
    uint rows[kGatherRows];
    uint start[kGatherRows];
    for (uint k = 0u; k < kGatherRows; ++k) {
        rows[k] = first + 4u * k;
        start[k] = (min(rows[k], first) * n + (rows[k] < params.rowCount ? 4u * k * n : 0u)) / 4u;
    }
    if (first >= params.rowCount) return;
    vec4 sums[kGatherRows * 4u];
    for (uint k = 0u; k < kGatherRows * 4u; ++k) sums[k] = vec4(0);
    uint texels = (n + shift + 3u) / 4u;
    for (uint m = gl_SubgroupInvocationID; m < texels; m += gl_SubgroupSize) {
        vec4 f0 = texelFetch(factors, int(start[0] + m)), f1 = texelFetch(factors, int(start[1] + m)),
             f2 = texelFetch(factors, int(start[2] + m)), f3 = texelFetch(factors, int(start[3] + m));
        for (uint c = 0u; c < kColumns; ++c) {
            vec4 b = texelFetch(light, int((c * 4u + shift) * params.texelsPerColumn + m));
            sums[4u * c] += f0 * b;
            sums[4u * c + 1u] += f1 * b;
            sums[4u * c + 2u] += f2 * b;
            sums[4u * c + 3u] += f3 * b;
        }
    }
    for (uint c = 0u; c < kColumns; ++c)
        for (uint k = 0u; k < kGatherRows; ++k) {
            vec4 s = sums[4u * c + k];
            float sum = subgroupAdd((s.x + s.y) + (s.z + s.w));
            if (subgroupElect() && rows[k] < params.rowCount) gathered[c * n + params.firstRow + rows[k]] = sum;
        }
}
