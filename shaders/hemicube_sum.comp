// Hemicube in compute, second half: sums the delta form factors of what each pixel sees, by patch and, through openings, by
// sky element. Sums are in fixed point, so that their order does not matter.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/hemicube.io.h"
#include "shaders/lib/glazing.glsl"
#include "shaders/lib/hemicube_frame.glsl"
#include "shaders/lib/sky_elements.glsl"

layout(local_size_x = kHemicubeGroup) in;
layout(constant_id = 0) const bool kSky = false;
layout(constant_id = 1) const uint kChannels = 1u; // of the sky coefficients: 1 or 3
layout(set = 0, binding = 0) uniform usamplerBuffer viewpoints;
layout(set = 0, binding = 1) uniform usamplerBuffer deltas; // top R x R, then one side R x R/2; fixed point
layout(set = 0, binding = 2) uniform usamplerBuffer items;  // 3 R^2 per workgroup
layout(set = 0, binding = 3) uniform usamplerBuffer patchOpenings;
layout(set = 0, binding = 4) uniform samplerBuffer glazings;
layout(set = 0, binding = 5, scalar) coherent buffer Lists { uint lists[]; }; // listLength per workgroup
layout(set = 0, binding = 6, scalar) buffer Factors { uint factors[]; };      // rows x patchCount, added to
layout(set = 0, binding = 7, scalar) buffer Sky { uint sky[]; };              // rows x channels x skyElements, added to
layout(push_constant, scalar) uniform Push { HemicubeParams params; };

const uint kEmpty = 0xffffffffu;
const uint kSegment = 32u; // pixels that a lane sums
shared uint skyCount;

// Sums up to kSegment pixels of line `k` (0 .. 3R: the top's lines, then those of the sides), a run of equal items at a
// time, and lists the pixels that look out.
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
            if (sum > 0u) atomicAdd(factors[row * params.patchCount + previous / 4u], sum);
            sum = 0u;
            previous = id;
        }
        // Cracks and back sides: that light is lost, which closure shows.
        if ((id & kHemicubeBack) == 0u) sum += texelFetch(deltas, int(deltaAt + i)).x;
        if (kSky && (id & (kHemicubeBack | kHemicubeOpening)) == kHemicubeOpening)
            lists[gl_WorkGroupID.x * params.listLength + atomicAdd(skyCount, 1u)] = k * R + i;
    }
}

// One pixel that looks out through an opening: its share of the sky element that it sees, behind the glass.
void addSky(uint pixel, uint row, Frame frame, uint base) {
    uint R = params.resolution, k = pixel / R, i = pixel % R;
    uint face = k < R ? 0u : 1u + (k - R) / (R / 2u);
    uint line = k < R ? k : (k - R) % (R / 2u);
    uint patchId = (texelFetch(items, int(base + pixel)).x & ((1u << params.idBits) - 1u)) / 4u;
    uvec4 info = texelFetch(patchOpenings, int(patchId));
    vec4 glazing = texelFetch(glazings, int(info.w));
    uint delta = texelFetch(deltas, int((k < R ? 0u : R * R) + line * R + i)).x;
    float y = (2.0 * float(line) + 1.0) / float(R) - (face == 0u ? 1.0 : 0.0);
    vec3 local = normalize(fromFace(vec3((2.0 * float(i) + 1.0) / float(R) - 1.0, y, 1.0), face));
    vec3 world = local.x * frame.u + local.y * frame.v + local.z * frame.n;
    vec3 through = slabTransmittance(glazing.rgb, glazing.a, abs(dot(world, uintBitsToFloat(info.xyz))));
    uint at = row * kChannels * params.skyElements + skyElementOf(world, params.skyDivision);
    for (uint channel = 0u; channel < kChannels; ++channel)
        atomicAdd(sky[at + channel * params.skyElements], uint(float(delta) * through[channel] + 0.5));
}

void main() {
    uint lane = gl_LocalInvocationIndex, R = params.resolution, base = gl_WorkGroupID.x * 3u * R * R;
    uint row = (gl_WorkGroupID.x + params.viewpointInRow) / params.pointsPerRow;
    if (kSky) {
        if (lane == 0u) skyCount = 0u;
        memoryBarrierShared();
        barrier();
    }
    uint segments = (R + kSegment - 1u) / kSegment;
    for (uint k = lane; k < 3u * R * segments; k += kHemicubeGroup)
        sumSegment(k / segments, (k % segments) * kSegment, row, base);
    if (!kSky) return;
    memoryBarrierShared();
    memoryBarrierBuffer();
    barrier();
    int viewpoint = 3 * int(params.firstViewpoint + gl_WorkGroupID.x);
    Frame frame = frameOf(texelFetch(viewpoints, viewpoint), texelFetch(viewpoints, viewpoint + 1),
                          texelFetch(viewpoints, viewpoint + 2));
    uint seen = skyCount;
    for (uint k = lane; k < seen; k += kHemicubeGroup)
        addSky(lists[gl_WorkGroupID.x * params.listLength + k], row, frame, base);
}
