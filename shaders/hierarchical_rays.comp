// Rays between the ends of a link that something may stand in the way of: the share of light that passes. Two clusters get a
// few, and are handed on as pairs of their children where these disagree and much is at stake; two triangles as many again as
// before, time after time, until the share is known well enough.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/io/hierarchical.io.h"

layout(local_size_x = kHierarchicalGroup) in;
layout(set = 0, binding = 0) uniform usamplerBuffer nodes;
layout(set = 0, binding = 1) uniform usamplerBuffer leaves;
layout(set = 0, binding = 2) uniform usamplerBuffer bvhNodes; // of blockers
layout(set = 0, binding = 3) uniform usamplerBuffer bvhTriangles;
layout(set = 0, binding = 4, scalar) readonly buffer Doubted { HierarchicalDoubt doubted[]; };
layout(set = 0, binding = 5, scalar) buffer Counters { uint counters[]; };
layout(set = 0, binding = 6, scalar) writeonly buffer Next { uvec2 next[]; };           // four for each pair
layout(set = 0, binding = 7, scalar) writeonly buffer LeafPairs { uvec2 leafPairs[]; }; // four for each pair
layout(set = 0, binding = 8, scalar) writeonly buffer Links { HierarchicalLink links[]; };
layout(set = 0, binding = 9, scalar) writeonly buffer Doubts { HierarchicalDoubt doubts[]; };
layout(set = 0, binding = 10, scalar) writeonly buffer LongDoubts { HierarchicalDoubt longDoubts[]; };
layout(constant_id = 0) const uint kLanes = 1u; // invocations that share the rays of a pair, neighbours
layout(push_constant, scalar) uniform Push { HierarchicalLinksParams params; };

#include "shaders/lib/cluster.glsl"
#include "shaders/lib/link_queues.glsl"

// Two triangles: the error of the share that passes, one standard deviation. Sums over a lattice err less than those of random
// points, by about the 0.15th power of their number; where all rays agree, about one ray's share may be missed.
float errorOfShare(HierarchicalDoubt d, float share) {
    float variance = (1.0 - share) * (1.0 - share) * d.passedSquares + share * share * (d.openSquares - d.passedSquares);
    float random = sqrt(max(variance, 0.0)) / d.open * pow(float(d.rays), -0.15);
    return max(random, 0.25 * d.openSquares / (d.open * d.open));
}

shared vec4 castSums[kHierarchicalGroup];
shared uint castBlocked[kHierarchicalGroup];

// Sums over the rays [d.rays, end): what passes, what would in the open, and both squared.
vec4 castRays(HierarchicalDoubt d, Cluster p, Cluster q, uint seed, uint end, out uint blocked) {
    vec4 sums = vec4(0.0);
    blocked = 0u;
    [[dont_unroll]] for (uint k = d.rays + gl_LocalInvocationID.x % kLanes; k < end; k += kLanes) {
        vec2 light = castRay(p, q, seed, k, params.nodeCount, params.flatness);
        sums += vec4(light, light * light);
        blocked += light.x > 0.0 ? 0u : 1u;
    }
    if (kLanes == 1u) return sums;
    uint lane = gl_LocalInvocationID.x, first = lane - lane % kLanes;
    castSums[lane] = sums;
    castBlocked[lane] = blocked;
    barrier();
    sums = vec4(0.0);
    blocked = 0u;
    [[dont_unroll]] for (uint k = first; k < first + kLanes; ++k) {
        sums += castSums[k];
        blocked += castBlocked[k];
    }
    return sums;
}

void main() {
    uint index = gl_GlobalInvocationID.x / kLanes;
    bool idle = index >= params.pairCount;
    if (kLanes == 1u && idle) return; // the others' lanes wait for one another
    HierarchicalDoubt d = doubted[min(index, params.pairCount - 1u)];
    uint i = d.link.first, j = d.link.second, seed = hashOf(i * 0x9e3779b9u ^ hashOf(j));
    Cluster p = clusterAt(i), q = clusterAt(j);
    bool triangles = p.child == 0u && q.child == 0u;
    uint end = d.rays + (triangles ? clamp(d.rays, kHierarchicalFewRays, kLanes * kHierarchicalRoundRays) : kHierarchicalRays);
    uint blocked;
    vec4 sums = castRays(d, p, q, seed, end, blocked);
    if (idle || gl_LocalInvocationID.x % kLanes > 0u) return;
    d.passed += sums.x;
    d.open += sums.y;
    d.passedSquares += sums.z;
    d.openSquares += sums.w;
    d.rays = end;
    float factor = d.link.density * max(p.area, q.area), share, error;
    if (triangles) {
        share = d.open > 0.0 ? d.passed / d.open : 0.0;
        error = d.open > 0.0 ? errorOfShare(d, share) : 1.0; // all rays began or ended behind the other's plane
        if (factor * error > 0.25 * params.visibilityTolerance && end < params.mostRays) {
            if (end < kHierarchicalManyRays)
                doubts[atomicAdd(counters[kHierarchicalDoubts], 1u)] = d;
            else
                longDoubts[atomicAdd(counters[kHierarchicalLongDoubts], 1u)] = d;
            return;
        }
    } else {
        bool mixed = blocked > 0u && blocked < end;
        if (mixed && 0.5 * factor > params.visibilityTolerance) {
            split(i, j, p, q);
            return;
        }
        share = 1.0 - float(blocked) / float(end);
        // Between two triangles light passes or does not: that is the scatter about the share.
        error = mixed ? sqrt(share * (1.0 - share)) : 0.3 * doubtOfAgreement(p, q);
    }
    error *= d.link.density;
    d.link.density *= share;
    d.link.error = share > 0.0 ? length(vec2(share * d.link.error, error)) : error;
    // Those that carry nothing are kept only if they should have carried something.
    if (share > 0.0 || error * max(p.area, q.area) > 0.05 * params.visibilityTolerance)
        links[atomicAdd(counters[kHierarchicalLinks], 1u)] = d.link;
}
