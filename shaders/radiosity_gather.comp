// H = F B for one to four columns of light at once: illuminance that patches receive from all others. A subgroup
// sums eight rows, so that light is fetched once for eight; F is read once from a texel buffer, the fastest way for
// read-only data on devices without large caches. The order of every sum is fixed.
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
    uint first = 4u * kGatherRows * (block / 4u) + block % 4u;
    uint shift = (first * n) % 4u;
    if (first >= params.rowCount) return;
    uint start[kGatherRows];
    for (uint k = 0u; k < kGatherRows; ++k)
        start[k] = (first + (first + 4u * k < params.rowCount ? 4u * k : 0u)) * n / 4u;
    float sums[kGatherRows * 4u];
    for (uint k = 0u; k < kGatherRows * kColumns; ++k) sums[k] = 0.0;
    uint texels = (n + shift + 3u) / 4u;
    for (uint m = gl_SubgroupInvocationID; m < texels; m += gl_SubgroupSize) {
        vec4 b[4];
        for (uint c = 0u; c < kColumns; ++c)
            b[c] = texelFetch(light, int((c * 4u + shift) * params.texelsPerColumn + m));
        for (uint k = 0u; k < kGatherRows; ++k) {
            vec4 f = texelFetch(factors, int(start[k] + m));
            // Pairwise: a fourth of the additions one after another.
            for (uint c = 0u; c < kColumns; ++c)
                sums[kColumns * k + c] += (f.x * b[c].x + f.y * b[c].y) + (f.z * b[c].z + f.w * b[c].w);
        }
    }
    for (uint k = 0u; k < kGatherRows; ++k)
        for (uint c = 0u; c < kColumns; ++c) {
            float sum = subgroupAdd(sums[kColumns * k + c]);
            uint row = first + 4u * k;
            if (subgroupElect() && row < params.rowCount) gathered[c * n + params.firstRow + row] = sum;
        }
}
