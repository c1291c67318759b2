// Hemicube in compute, second half: sums the delta form factors of what each pixel sees, by patch. Sums are in
// fixed point, so that their order does not matter.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/hemicube.io.h"

layout(local_size_x = kHemicubeGroup) in;
layout(set = 0, binding = 0) uniform usamplerBuffer deltas; // top R x R, then one side R x R/2; fixed point
layout(set = 0, binding = 1) uniform usamplerBuffer items;  // 3 R^2 per workgroup
layout(set = 0, binding = 2, scalar) buffer Factors { uint factors[]; }; // rows x patchCount, added to
layout(push_constant, scalar) uniform Push { HemicubeParams params; };

const uint kEmpty = 0xffffffffu;
const uint kSegment = 32u; // pixels that a lane sums

// Sums up to kSegment pixels of line `k` (0 .. 3R: the top's lines, then those of the sides), a run of equal items at a
// time.
void sumSegment(uint k, uint firstPixel, uint row, uint base) {
    uint R = params.resolution;
    uint line = k < R ? k : (k - R) % (R / 2u);
    uint deltaAt = (k < R ? 0u : R * R) + line * R;
    uint mask = (1u << params.idBits) - 1u;
    uint end = min(firstPixel + kSegment, R), previous = kEmpty, sum = 0u;
    for (uint i = firstPixel; i <= end; ++i) {
        uint id = kEmpty;
        if (i < end) {
            uint item = texelFetch(items, int(base + k * R + i)).x;
            id = item == kEmpty ? kEmpty : item & mask;
        }
        if (id != previous) {
            if (sum > 0u) atomicAdd(factors[row * params.patchCount + previous / 2u], sum);
            sum = 0u;
            previous = id;
        }
        // Cracks and back sides: that light is lost, which closure shows.
        if ((id & kHemicubeBack) == 0u) sum += texelFetch(deltas, int(deltaAt + i)).x;
    }
}

void main() {
    uint R = params.resolution, base = gl_WorkGroupID.x * 3u * R * R;
    uint row = (gl_WorkGroupID.x + params.viewpointInRow) / params.pointsPerRow;
    uint segments = (R + kSegment - 1u) / kSegment;
    for (uint k = gl_LocalInvocationIndex; k < 3u * R * segments; k += kHemicubeGroup)
        sumSegment(k / segments, (k % segments) * kSegment, row, base);
}
