// One pair of triangles: what they exchange in the open, times the share of rays between them that pass.
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
layout(set = 0, binding = 6, scalar) writeonly buffer Links { HierarchicalLink links[]; };
layout(push_constant, scalar) uniform Push { HierarchicalLinksParams params; };

#include "shaders/lib/cluster.glsl"
#include "shaders/lib/pair_exchange.glsl"

Triangle triangleOf(Cluster c) {
    uvec4 t0 = texelFetch(leaves, int(3u * c.firstLeaf)), t1 = texelFetch(leaves, int(3u * c.firstLeaf + 1u)),
          t2 = texelFetch(leaves, int(3u * c.firstLeaf + 2u));
    return Triangle(uintBitsToFloat(t0.xyz), uintBitsToFloat(uvec3(t0.w, t1.w, t2.w)), uintBitsToFloat(t1.xyz),
                    uintBitsToFloat(t2.xyz), c.normal, c.area);
}

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.pairCount) return;
    uint i = pairs[index].x, j = pairs[index].y;
    Cluster p = clusterAt(i), q = clusterAt(j);
    float exchange = pairExchange(triangleOf(p), triangleOf(q));
    if (p.room != q.room) exchange = 0.0;
    float factor = exchange / min(p.area, q.area);
    // Few pairs need rays: most are proven clear. Rays that all agree leave a doubt of about one ray's share; where they disagree, the error of a pair has to be well below
    // that of a row, which sums many.
    float weight = 4.0 * factor / params.visibilityTolerance;
    uint few = clamp(uint(weight), 4u, 64u), most = max(few, clamp(uint(weight * sqrt(weight)), 4u, params.leafRays));
    bool maybe = exchange > 0.0 && params.nodeCount > 0u &&
                 maybeBlocked(p.centre, p.normal, p.radius, q.centre, q.normal, q.radius, params.nodeCount);
    uint rays = maybe ? few : 0u, stopped = 0u;
    vec2 sum = vec2(0.0);
    [[dont_unroll]] for (uint k = 0u; k < rays; ++k) {
        vec2 light = castRay(p, q, hashOf(i * 0x9e3779b9u ^ hashOf(j)), k, params.nodeCount, params.flatness);
        sum += light;
        stopped += light.x < light.y ? 1u : 0u;
        if (k + 1u == few && stopped > 0u && sum.x > 0.0) rays = most;
    }
    float visible = sum.y > 0.0 ? sum.x / sum.y : rays > 0u ? 0.0 : 1.0;
    if (exchange <= 0.0 || visible <= 0.0) return;
    links[atomicAdd(counters[kHierarchicalLinks], 1u)] =
        HierarchicalLink(i, j, exchange * visible / (p.area * q.area), 0u, 0u);
}
