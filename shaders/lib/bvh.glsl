// Rays through a bounding volume hierarchy in depth-first order (compute/bvh.h). Software devices run what is in an `if`
// for all lanes and a loop as long as its longest lane: so boxes and triangles have loops of their own (T. Aila, S. Laine,
// "Understanding the Efficiency of Ray Traversal on GPUs", 2009), and nothing needs a stack.
// Before this: uniform usamplerBuffer bvhNodes, bvhTriangles.
#ifndef BVH_GLSL
#define BVH_GLSL
#include "shaders/io/bvh.io.h"

const uint kBvhNothing = 0xffffffffu;
const float kBvhEdge = 2e-6; // barycentric slack, so that no ray slips between neighbours

struct BvhRay {
    vec3 origin;
    vec3 direction;
    vec3 inverse;
    uint first; // node
    uint end;
};

BvhRay bvhRay(vec3 origin, vec3 direction, uint nodeCount) {
    vec3 d = mix(direction, vec3(1e-30), lessThan(abs(direction), vec3(1e-30)));
    uint octant = (d.x < 0.0 ? 1u : 0u) | (d.y < 0.0 ? 2u : 0u) | (d.z < 0.0 ? 4u : 0u);
    return BvhRay(origin, direction, 1.0 / d, octant * nodeCount, nodeCount);
}

// Goes on from `node` to the next leaf nearer than `reach`; returns its triangles, 0 at the end.
uint nextLeaf(BvhRay ray, float reach, inout uint node) {
    uint leaf = 0u;
    [[dont_unroll]] while (node < ray.end && leaf == 0u) {
        uvec4 low = texelFetch(bvhNodes, int(2u * (ray.first + node))),
              high = texelFetch(bvhNodes, int(2u * (ray.first + node) + 1u));
        vec3 a = (uintBitsToFloat(low.xyz) - ray.origin) * ray.inverse,
             b = (uintBitsToFloat(high.xyz) - ray.origin) * ray.inverse;
        vec3 enter = min(a, b), leave = max(a, b);
        bool inside = max(max(enter.x, enter.y), max(enter.z, 0.0)) <= min(min(leave.x, leave.y), min(leave.z, reach));
        leaf = inside ? high.w : 0u;
        node = inside && high.w == 0u ? node + 1u : low.w;
    }
    return leaf;
}

// The nearest patch that a ray meets, times two, plus one seen from behind; kBvhNothing when there is none. Patches of other
// rooms, `self`, and planes nearer to the origin than `flatness` are not there.
uint nearestPatch(BvhRay ray, uint self, uint room, float flatness) {
    float reach = 1e30;
    uint result = kBvhNothing, node = 0u;
    [[dont_unroll]] while (node < ray.end) {
        uint leaf = nextLeaf(ray, reach, node);
        uint at = 3u * (leaf / (2u * kBvhLeafMost)), count = leaf % (2u * kBvhLeafMost), k = 0u;
        [[dont_unroll]] do {
            uvec4 t0 = texelFetch(bvhTriangles, int(at)), t1 = texelFetch(bvhTriangles, int(at + 1u)),
                  t2 = texelFetch(bvhTriangles, int(at + 2u));
            vec3 e = uintBitsToFloat(t1.xyz), f = uintBitsToFloat(t2.xyz), s = ray.origin - uintBitsToFloat(t0.xyz);
            vec3 p = cross(ray.direction, f), q = cross(s, e);
            float determinant = dot(e, p), inverse = 1.0 / determinant;
            float u = dot(s, p) * inverse, v = dot(ray.direction, q) * inverse, height = dot(f, q), t = height * inverse;
            bool hit = k < count && t0.w != self && t1.w == room && min(u, v) >= -kBvhEdge && u + v <= 1.0 + kBvhEdge &&
                       t > 0.0 && t < reach && abs(height) * uintBitsToFloat(t2.w) > flatness;
            reach = hit ? t : reach;
            result = hit ? 2u * t0.w + (determinant > 0.0 ? 0u : 1u) : result;
            at += 3u;
            ++k;
        } while (k < count);
    }
    return result;
}
#endif
