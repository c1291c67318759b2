// Rays from points on patches, with the density of the cosine, to the patch that each meets first: F(i, j) is the
// share of the rays of i that end on the front of j. One invocation sends rays of one patch: lanes of a subgroup
// have neighbouring patches and, by the bits of direction that all patches share, nearly the same direction, so
// they visit the same boxes. Where loops were cut short (lib/loop_limit.glsl) the host sends fewer from each.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/io/monte_carlo.io.h"

layout(local_size_x = kMonteCarloGroup) in;
layout(constant_id = 0) const bool kAtomic = false; // several invocations of one dispatch share a row
layout(set = 0, binding = 0) uniform usamplerBuffer bvhNodes;
layout(set = 0, binding = 1) uniform usamplerBuffer bvhTriangles;
layout(set = 0, binding = 2) uniform usamplerBuffer emitters; // patches, then parts
layout(set = 0, binding = 3) uniform usamplerBuffer points;   // halfRays: direction.xy, position.xy
layout(set = 0, binding = 4, scalar) buffer Counts { uint counts[]; }; // window of rows x patchCount
layout(set = 0, binding = 5, scalar) buffer Cuts { uint cuts; }; // invocations whose loops the device ended early
layout(push_constant, scalar) uniform Push { MonteCarloParams params; };

#include "shaders/lib/bvh.glsl"
#include "shaders/lib/loop_limit.glsl"
#include "shaders/lib/monte_carlo_points.glsl"

void main() {
    uint rowInWindow = gl_GlobalInvocationID.x;
    if (rowInWindow >= params.rowCount) return;
    uint n = params.patchCount, row = params.firstRow + rowInWindow;
    uvec4 e0 = texelFetch(emitters, int(3u * row)), e1 = texelFetch(emitters, int(3u * row + 1u)),
          e2 = texelFetch(emitters, int(3u * row + 2u));
    if (e1.w == 0u) return; // degenerate
    vec3 normal = uintBitsToFloat(e0.xyz), u = uintBitsToFloat(e1.xyz), v = cross(normal, u);
    uint first = params.firstRay + gl_WorkGroupID.y * params.rays;
    uint second = first >= params.halfRays ? 1u : 0u;
    // A random digital shift for each patch and half: every elementary interval keeps its number of points.
    uint seed = hashOf(2u * row + second + 1u);
    uvec4 shift = uvec4(hashOf(seed), hashOf(seed + 0x9e3779b9u), hashOf(seed + 0x3c6ef372u),
                        hashOf(seed + 0xdaa66d2bu));
    shift.xy &= 0xffffffffu >> params.keptBits;
    [[dont_unroll]] for (uint k = 0u; k < params.rays; ++k) {
        uvec4 bits = texelFetch(points, int(first + k - second * params.halfRays)) ^ shift;
        vec2 place = vec2(unitOf(bits.z), unitOf(bits.w));
        uint part = 3u * (n + e0.w);
        uvec4 p0 = texelFetch(emitters, int(part));
        float before = 0.0, upTo = uintBitsToFloat(p0.w);
        [[dont_unroll]] for (uint m = 1u; m < e1.w && place.x >= upTo; ++m) {
            part += 3u;
            p0 = texelFetch(emitters, int(part));
            before = upTo;
            upTo = uintBitsToFloat(p0.w);
        }
        place.x = clamp((place.x - before) / (upTo - before), 0.0, 1.0);
        vec2 weight = squareToTriangle(place);
        vec3 origin = uintBitsToFloat(p0.xyz) + weight.x * uintBitsToFloat(texelFetch(emitters, int(part + 1u)).xyz) +
                      weight.y * uintBitsToFloat(texelFetch(emitters, int(part + 2u)).xyz);
        vec3 local = squareToCosine(vec2(unitOf(bits.x), unitOf(bits.y)));
        vec3 direction = local.x * u + local.y * v + local.z * normal;
        uint seen = nearestPatch(bvhRay(origin, direction, params.nodeCount), row, e2.x, params.flatness);
        if ((seen & 1u) == 0u) { // met, and on its front
            uint at = rowInWindow * n + seen / 2u, one = second == 0u ? 1u : 0x10000u;
            if (kAtomic)
                atomicAdd(counts[at], one);
            else
                counts[at] += one;
        }
    }
    if (cutShort(3u + min(params.rays, 1u))) atomicAdd(cuts, 1u);
}
