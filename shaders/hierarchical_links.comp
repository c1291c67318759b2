// One pair of clusters: dropped where they do not face, linked where what they exchange varies little over both, left
// to rays where something may stand between and little could be missed by them, else handed on as pairs of their
// children. P. Hanrahan, D. Salzman, L. Aupperle, "A Rapid Hierarchical Radiosity Algorithm", 1991, with links that
// vary linearly over both ends, so that their error falls with the square of size over distance.
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
layout(set = 0, binding = 4, scalar) readonly buffer Pairs { uvec2 pairs[]; };
layout(set = 0, binding = 5, scalar) buffer Counters { uint counters[]; };
layout(set = 0, binding = 6, scalar) writeonly buffer Next { uvec2 next[]; };           // four for each pair
layout(set = 0, binding = 7, scalar) writeonly buffer LeafPairs { uvec2 leafPairs[]; }; // four for each pair
layout(set = 0, binding = 8, scalar) writeonly buffer Links { HierarchicalLink links[]; };
layout(set = 0, binding = 9, scalar) writeonly buffer Doubts { HierarchicalDoubt doubts[]; };
layout(push_constant, scalar) uniform Push { HierarchicalLinksParams params; };

#include "shaders/lib/cluster.glsl"
#include "shaders/lib/link_queues.glsl"
#include "shaders/lib/pair_exchange.glsl"

// A small patch at the foot of a wall a million times as large rises above it by about its own size, however little that
// is beside the distance: such heights are told from rounding, of this share of the distance.
const float kClusterLow = 0.1, kClusterRounded = 2e-7;
const float kSmoothSize = 0.8; // both radii over the distance, up to which nine values tell how the kernel varies
// Of the bends: what a straight line through them leaves (u^2 - 1 has a mean square of 0.8 over a rectangle), and bends
// along both ends at once.
const float kBendRest = 0.8;

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.pairCount) return;
    uint i = pairs[index].x, j = pairs[index].y;
    Cluster p = clusterAt(i), q = clusterAt(j);
    vec3 d = q.centre - p.centre;
    float tilt = length(cross(p.normal, q.normal)), heightQ = dot(p.normal, d), heightP = -dot(q.normal, d);
    float reach = length(d) + p.radius + q.radius,
          flat_ = max(min(kPairFlat * reach, kClusterLow * min(p.radius, q.radius)), kClusterRounded * reach);
    if (p.room != q.room || heightQ + q.radius * tilt <= flat_ || heightP + p.radius * tilt <= flat_) return;
    bool wholly = heightQ > q.radius * tilt && heightP > p.radius * tilt;

    // The kernel at the centres and one standard deviation off along each axis.
    float middle = kernelBetween(p.centre, p.normal, q.centre, q.normal);
    vec4 up = vec4(kernelBetween(p.centre + p.axisU, p.normal, q.centre, q.normal),
                   kernelBetween(p.centre + p.axisV, p.normal, q.centre, q.normal),
                   kernelBetween(p.centre, p.normal, q.centre + q.axisU, q.normal),
                   kernelBetween(p.centre, p.normal, q.centre + q.axisV, q.normal));
    vec4 down = vec4(kernelBetween(p.centre - p.axisU, p.normal, q.centre, q.normal),
                     kernelBetween(p.centre - p.axisV, p.normal, q.centre, q.normal),
                     kernelBetween(p.centre, p.normal, q.centre - q.axisU, q.normal),
                     kernelBetween(p.centre, p.normal, q.centre - q.axisV, q.normal));
    vec4 bend = up + down - 2.0 * middle, slope = 0.5 * (up - down);
    float larger = max(p.area, q.area), density = middle + 0.5 * dot(bend, vec4(1.0));
    // Bends along both ends at once, which the nine values do not show, are about as large as those that they do.
    float error = larger * dot(abs(bend), vec4(1.0));
    // Clusters end about two standard deviations from their centre: no entry becomes negative.
    bool smooth_ = wholly && p.radius + q.radius < kSmoothSize * length(d) && error <= params.tolerance &&
                   density > 2.0 * dot(abs(slope), vec4(1.0));

    // Few pairs need rays: most are proven clear, or too large to be left to so few.
    bool maybe = smooth_ && params.nodeCount > 0u &&
                 maybeBlocked(p.centre, p.normal, p.radius, q.centre, q.normal, q.radius, params.nodeCount);
    if (!smooth_ || (maybe && doubtOfAgreement(p, q) * density * larger > params.visibilityTolerance)) {
        split(i, j, p, q);
        return;
    }
    slope /= density;
    HierarchicalLink link =
        HierarchicalLink(i, j, density, packHalf2x16(slope.xy), packHalf2x16(slope.zw), kBendRest * length(bend),
                         density, 0u);
    if (maybe)
        doubts[atomicAdd(counters[kHierarchicalDoubts], 1u)] =
            HierarchicalDoubt(link, 0u, 0.0, 0.0, 0.0, 0.0, kHierarchicalRoundRays);
    else
        links[atomicAdd(counters[kHierarchicalLinks], 1u)] = link;
}
