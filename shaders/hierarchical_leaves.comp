// One pair of triangles: what they exchange in the open; left to rays where something may stand between. Near pairs,
// which take ten times the work, are handed on to a dispatch of their own.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/io/hierarchical.io.h"

layout(local_size_x = kHierarchicalGroup) in;
layout(constant_id = 0) const bool kNear = false;
layout(set = 0, binding = 0) uniform usamplerBuffer nodes;
layout(set = 0, binding = 1) uniform usamplerBuffer leaves;
layout(set = 0, binding = 2) uniform usamplerBuffer bvhNodes; // of blockers
layout(set = 0, binding = 3) uniform usamplerBuffer bvhTriangles;
layout(set = 0, binding = 4, scalar) readonly buffer Pairs { uvec2 pairs[]; };
layout(set = 0, binding = 5, scalar) buffer Counters { uint counters[]; };
layout(set = 0, binding = 6, scalar) writeonly buffer Near { uvec2 nearPairs[]; };
layout(set = 0, binding = 7, scalar) writeonly buffer Links { HierarchicalLink links[]; };
layout(set = 0, binding = 8, scalar) writeonly buffer Doubts { HierarchicalDoubt doubts[]; };
layout(push_constant, scalar) uniform Push { HierarchicalLinksParams params; };

#include "shaders/lib/cluster.glsl"
#include "shaders/lib/pair_exchange.glsl"

Triangle triangleOf(Cluster c) {
    Leaf leaf = leafAt(c.firstLeaf);
    return Triangle(leaf.a, leaf.rest, leaf.ab, leaf.ac, c.normal, c.area);
}

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.pairCount) return;
    uint i = pairs[index].x, j = pairs[index].y;
    Cluster p = clusterAt(i), q = clusterAt(j);
    bool near;
    float allowed = kHierarchicalKept * params.tolerance * min(p.area, q.area);
    vec2 exchange = pairExchange(triangleOf(p), triangleOf(q), allowed, kNear, near);
    if (!kNear && near) {
        nearPairs[atomicAdd(counters[kHierarchicalPairs], 1u)] = uvec2(i, j);
        return;
    }
    if (p.room != q.room || exchange.x <= 0.0) return;
    exchange /= p.area * q.area;
    HierarchicalLink link = HierarchicalLink(i, j, exchange.x, 0u, 0u, exchange.y, exchange.x, 0u);
    if (params.nodeCount > 0u &&
        maybeBlocked(p.centre, p.normal, p.radius, q.centre, q.normal, q.radius, params.nodeCount))
        doubts[atomicAdd(counters[kHierarchicalDoubts], 1u)] =
            HierarchicalDoubt(link, 0u, 0.0, 0.0, 0.0, 0.0, kHierarchicalRoundRays);
    else
        links[atomicAdd(counters[kHierarchicalLinks], 1u)] = link;
}
