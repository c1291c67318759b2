// Hemicube in compute, last of three: sums the delta form factors of what each pixel sees, by patch. Sums are in
// fixed point, so that their order does not matter. A row of workgroups, one viewpoint, for short loops (lib/loop_limit.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/hemicube.io.h"

layout(local_size_x = kHemicubeGroup) in;
layout(set = 0, binding = 0) uniform usamplerBuffer deltas; // top R x R, then one side R x R/2; fixed point, by twos
layout(set = 0, binding = 1) uniform usamplerBuffer items;  // 3 R^2 per viewpoint, by twos
layout(set = 0, binding = 2, scalar) buffer Factors { uint factors[]; }; // rows x patchCount, added to
layout(push_constant, scalar) uniform Push { HemicubeParams params; };

const uint kEmpty = 0xffffffffu;

// Of successive pixels with one item.
struct Run {
    uint id, sum;
};

void end(Run run, uint firstFactor) {
    if (run.sum > 0u) atomicAdd(factors[firstFactor + run.id / 2u], run.sum);
}

// Cracks and back sides add nothing: that light is lost, which closure shows.
void goOn(inout Run run, uint item, uint delta, uint mask, uint firstFactor) {
    uint id = item == kEmpty ? kEmpty : item & mask;
    if (id != run.id) {
        end(run, firstFactor);
        run = Run(id, 0u);
    }
    run.sum += (id & kHemicubeBack) == 0u ? delta : 0u;
}

// Sums up to kHemicubeSegment pixels of line `k` (0 .. 3R: the top's lines, then those of the sides).
void sumSegment(uint k, uint firstPixel, uint firstFactor, uint base) {
    uint R = params.resolution, mask = (1u << params.idBits) - 1u;
    uint line = k < R ? k : (k - R) % (R / 2u);
    int itemAt = int(base + k * R) / 2, deltaAt = int((k < R ? 0u : R * R) + line * R) / 2;
    int last = int(min(firstPixel + kHemicubeSegment, R)) / 2;
    Run run = Run(kEmpty, 0u);
    int two = int(firstPixel) / 2;
    do {
        uvec2 item = texelFetch(items, itemAt + two).xy, delta = texelFetch(deltas, deltaAt + two).xy;
        goOn(run, item.x, delta.x, mask, firstFactor);
        goOn(run, item.y, delta.y, mask, firstFactor);
        ++two;
    } while (two < last);
    end(run, firstFactor);
}

void main() {
    uint R = params.resolution, base = gl_WorkGroupID.y * 3u * R * R;
    uint row = (gl_WorkGroupID.y + params.viewpointInRow) / params.pointsPerRow;
    uint segments = (R + kHemicubeSegment - 1u) / kHemicubeSegment;
    uint lanes = gl_NumWorkGroups.x * kHemicubeGroup, all = 3u * R * segments, k = gl_GlobalInvocationID.x;
    do {
        if (k < all) sumSegment(k / segments, (k % segments) * kHemicubeSegment, row * params.patchCount, base);
        k += lanes;
    } while (k < all);
}
