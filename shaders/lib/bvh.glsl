// Rays through a bounding volume hierarchy in depth-first order (compute/bvh.h). Software devices run what is in an
// `if` for all lanes and a loop as long as its longest lane: so boxes and triangles have loops of their own
// (T. Aila, S. Laine, "Understanding the Efficiency of Ray Traversal on GPUs", 2009), and nothing needs a stack.
// Before this: uniform usamplerBuffer bvhNodes, bvhTriangles.
#ifndef BVH_GLSL
#define BVH_GLSL
#include "shaders/io/bvh.io.h"
#include "shaders/lib/constants.glsl"
#include "shaders/lib/loop_limit.glsl"

const uint kBvhNothing = 0xffffffffu;
const float kBvhPlane = 1e-6; // of lengths: rounding errors of heights over a triangle's plane
const uint kBvhTexels = 4u; // of a triangle
// Of two patches back to back, without thickness, the front is met, whichever rounding puts first: nearer to one another
// than so many flatnesses, along their normal, and than this share of the distance. Where both planes are one, so that a
// ray's height over one falls as that over the other rises (to within as much), only the former counts: a ray that
// begins 2 cm over a sheet in a room meets both sides 1e-5 of the distance apart, by rounding, and farther from nearer.
const float kBvhTieHeight = 2.0, kBvhTie = 1e-5;

struct BvhRay {
    vec3 origin;
    vec3 direction;
    vec3 inverse;
    uint first; // node
    uint end;
};

BvhRay bvhRay(vec3 origin, vec3 direction, uint nodeCount) {
    vec3 d = mix(direction, vec3(kTiny), lessThan(abs(direction), vec3(kTiny)));
    uint octant = (d.x < 0.0 ? 1u : 0u) | (d.y < 0.0 ? 2u : 0u) | (d.z < 0.0 ? 4u : 0u);
    return BvhRay(origin, direction, 1.0 / d, octant * nodeCount, nodeCount);
}

// Goes on from `node` to the next leaf nearer than `reach`, of boxes grown by `radius`; returns its triangles, 0 at
// the end.
uint nextLeafWithin(BvhRay ray, float radius, float reach, inout uint node) {
    uint leaf = 0u;
    [[dont_unroll]] while (node < ray.end && leaf == 0u) {
        uvec4 low = texelFetch(bvhNodes, int(2u * (ray.first + node))),
              high = texelFetch(bvhNodes, int(2u * (ray.first + node) + 1u));
        vec3 a = (uintBitsToFloat(low.xyz) - radius - ray.origin) * ray.inverse,
             b = (uintBitsToFloat(high.xyz) + radius - ray.origin) * ray.inverse;
        vec3 enter = min(a, b), leave = max(a, b);
        bool inside = max(max(enter.x, enter.y), max(enter.z, 0.0)) <= min(min(leave.x, leave.y), min(leave.z, reach));
        leaf = inside ? high.w : 0u;
        node = inside && high.w == 0u ? node + 1u : low.w;
    }
    return leaf;
}

uint nextLeaf(BvhRay ray, float reach, inout uint node) { return nextLeafWithin(ray, 0.0, reach, node); }

// Where a ray's line crosses the plane of the triangle at texel `at`.
struct BvhCrossing {
    uint patch_, room;
    float height; // of the origin over the plane
    float rise;   // of the height along the direction; negative: from the front
    float t;
    // Within the triangle, and no wider: a long one, however little widened, would stand before the ends of its body.
    // What slips between neighbours is as rare as rounding is small.
    bool inside;
};

BvhCrossing crossingOf(BvhRay ray, uint at) {
    uvec4 t0 = texelFetch(bvhTriangles, int(at)), t1 = texelFetch(bvhTriangles, int(at + 1u)),
          t2 = texelFetch(bvhTriangles, int(at + 2u)), t3 = texelFetch(bvhTriangles, int(at + 3u));
    vec3 n = uintBitsToFloat(t1.xyz), s = ray.origin - uintBitsToFloat(t0.xyz);
    float height = dot(n, s), rise = dot(n, ray.direction), t = -height / rise;
    vec3 place = s + t * ray.direction;
    float u = dot(place, uintBitsToFloat(t2.xyz)), v = dot(place, uintBitsToFloat(t3.xyz));
    return BvhCrossing(t0.w, t1.w, height, rise, t, min(u, v) >= 0.0 && u + v <= 1.0);
}

// The nearest patch that a ray meets, times two, plus one seen from behind; kBvhNothing when there is none. Patches
// of other rooms, `self`, and planes nearer to the origin than `flatness` are not there.
uint nearestPatch(BvhRay ray, uint self, uint room, float flatness) {
    float reach = kHuge, rise = 0.0;
    uint result = kBvhNothing, node = 0u;
    [[dont_unroll]] while (node < ray.end) {
        uint leaf = nextLeaf(ray, reach * (1.0 + kBvhTie), node);
        uint at = kBvhTexels * (leaf / (2u * kBvhLeafMost)), count = leaf % (2u * kBvhLeafMost), k = 0u;
        [[dont_unroll]] do {
            BvhCrossing c = crossingOf(ray, at);
            float isBack = c.rise < 0.0 ? 0.0 : 1.0, wasBack = float(result & 1u);
            float tie = abs(c.rise + rise) <= kBvhTie ? kHuge : kBvhTie * reach;
            bool hit = k < count && c.patch_ != self && c.room == room && c.inside && c.t > 0.0 &&
                       c.t < reach + (wasBack - isBack) * min(tie, kBvhTieHeight * flatness / abs(c.rise)) &&
                       abs(c.height) > flatness;
            reach = hit ? c.t : reach;
            rise = hit ? c.rise : rise;
            result = hit ? 2u * c.patch_ + (c.rise < 0.0 ? 0u : 1u) : result;
            at += kBvhTexels;
            ++k;
        } while (k < count);
    }
    return result;
}

// Whether a triangle of `room` stands between two points. Planes that hold either point, to within `flatness`, do
// not block.
bool blockedBetween(vec3 from, vec3 to, uint room, uint nodeCount, float flatness) {
    BvhRay ray = bvhRay(from, to - from, nodeCount);
    bool blocked = false;
    uint node = 0u;
    [[dont_unroll]] while (node < ray.end) {
        uint leaf = nextLeaf(ray, 1.0, node);
        uint at = kBvhTexels * (leaf / (2u * kBvhLeafMost)), count = leaf % (2u * kBvhLeafMost), k = 0u;
        [[dont_unroll]] do {
            BvhCrossing c = crossingOf(ray, at);
            blocked = blocked || (k < count && c.room == room && c.inside && c.t > 0.0 && c.t < 1.0 &&
                                  abs(c.height) > flatness && abs(c.height + c.rise) > flatness);
            at += kBvhTexels;
            ++k;
        } while (k < count);
        node = blocked ? ray.end : node;
    }
    return blocked;
}

// Whether a triangle might stand between two discs: it may reach into the capsule about both, and its plane does
// not have both on one side. Never false where one does, nor where the device ended the search early.
bool maybeBlocked(vec3 from, vec3 fromNormal, float fromRadius, vec3 to, vec3 toNormal, float toRadius,
                  uint nodeCount) {
    float radius = max(fromRadius, toRadius);
    vec3 along = to - from;
    float size = length(along);
    // From the one disc's far border to the other's.
    BvhRay ray = bvhRay(from, along, nodeCount);
    bool maybe = false;
    uint node = 0u;
    [[dont_unroll]] while (node < ray.end) {
        uint leaf = nextLeafWithin(ray, radius, 1.0, node);
        uint at = kBvhTexels * (leaf / (2u * kBvhLeafMost)), count = leaf % (2u * kBvhLeafMost), k = 0u;
        [[dont_unroll]] do {
            vec3 corner = uintBitsToFloat(texelFetch(bvhTriangles, int(at)).xyz),
                 n = uintBitsToFloat(texelFetch(bvhTriangles, int(at + 1u)).xyz);
            float a = dot(n, from - corner), b = dot(n, to - corner), slack = kBvhPlane * (size + radius + abs(a));
            float extentA = fromRadius * length(cross(n, fromNormal)) - slack,
                  extentB = toRadius * length(cross(n, toNormal)) - slack;
            bool oneSide = (a >= extentA && b >= extentB) || (a <= -extentA && b <= -extentB);
            maybe = maybe || (k < count && !oneSide);
            at += kBvhTexels;
            ++k;
        } while (k < count);
        node = maybe ? ray.end : node;
    }
    return maybe || cutShort(3u + min(nodeCount, 1u));
}
#endif
