// Rays between the ends of a link that something may stand in the way of: the share of light that passes. Two
// clusters get a few, and are handed on as pairs of their children where these disagree and much is at stake; two
// triangles as many again as before, time after time, until the share is known well enough. Where the device ended loops
// early (lib/loop_limit.glsl), pairs are looked at again: by lanes of their own, then as pairs of their children, or with
// fewer rays at once.
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

// Form factors from which rays are cast by angle too.
const float kFactorByAngle = 0.1;
const float kAgreedError = 0.3; // RMS of what rays that agree have missed, over the most that they may
const float kNothing = 0.05;    // of the tolerance: links that may carry less are dropped

// Two triangles: the error of the share that passes, one standard deviation. Sums over a lattice err less than those
// of random points, by about the 0.15th power of their number; where all rays agree, about half a ray's share may
// be missed. Where few rays carry most: what they miss of the exchange in the open, which is known, or have too much
// of, passes or does not like the rest.
// `agreed` is the error had all rays agreed.
float errorOfShare(HierarchicalDoubt d, float share, float openOfRay, out float agreed) {
    float missing = min(1.0, abs(1.0 - d.open / (openOfRay * float(d.rays))));
    float variance =
        (1.0 - share) * (1.0 - share) * d.passedSquares + share * share * (d.openSquares - d.passedSquares);
    float random = sqrt(max(variance, 0.0)) / d.open * pow(float(d.rays), -0.15);
    float unseen = 0.5 * sqrt(d.openSquares / float(d.rays)) / d.open, fewest = 0.25 / float(d.rays);
    agreed = length(vec2(unseen, missing * sqrt(fewest)));
    return length(vec2(max(random, unseen), missing * sqrt(max(share * (1.0 - share), fewest))));
}

shared vec4 castSums[kHierarchicalGroup];
shared uint castBlocked[kHierarchicalGroup];
shared bool castCut[kHierarchicalGroup];

// Of the rays between two clusters, sums: where they begin and end, along the axes of both (x, y of the first's, z, w
// of the second's), products of two of these, and where those begin and end that pass.
struct Trend {
    vec4 at, passedAt;
    vec4 squares;
    vec4 products;     // xy, xz, xw, yz
    vec2 moreProducts; // yw, zw
};

// Sums over the rays [d.rays, end), which lanes of two triangles share: what passes, what would in the open, and both
// squared.
vec4 castRays(HierarchicalDoubt d, Cluster p, Cluster q, bool byAngle, uint seed, uint end, out uint blocked,
              out Trend trend, out bool cut) {
    vec4 sums = vec4(0.0);
    blocked = 0u;
    trend = Trend(vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec2(0.0));
    // Only what moves from one triangle to another can be told by a slope.
    float clusterP = p.child == 0u ? 0.0 : 1.0, clusterQ = q.child == 0u ? 0.0 : 1.0;
    vec3 up = p.axisU * (clusterP / dot(p.axisU, p.axisU)), vp = p.axisV * (clusterP / dot(p.axisV, p.axisV)),
         uq = q.axisU * (clusterQ / dot(q.axisU, q.axisU)), vq = q.axisV * (clusterQ / dot(q.axisV, q.axisV));
    uint lanes = p.child == 0u && q.child == 0u ? kLanes : 1u;
    [[dont_unroll]] for (uint k = d.rays + gl_LocalInvocationID.x % lanes; k < end; k += lanes) {
        CastRay ray = castRay(p, q, byAngle, seed, k, params.nodeCount, params.flatness);
        vec2 light = vec2(ray.passed, ray.open_);
        sums += vec4(light, light * light);
        blocked += light.x > 0.0 ? 0u : 1u;
        if (lanes == 1u) {
            vec3 from = ray.from - p.centre, to = ray.to - q.centre;
            vec4 x = vec4(dot(from, up), dot(from, vp), dot(to, uq), dot(to, vq));
            trend.at += x;
            trend.squares += x * x;
            trend.products += x.xxxy * x.yzwz;
            trend.moreProducts += x.yz * x.ww;
            trend.passedAt += light.x > 0.0 ? x : vec4(0.0);
        }
    }
    cut = cutShort(3u + min(end, 1u));
    if (kLanes == 1u) return sums;
    uint lane = gl_LocalInvocationID.x, first = lane - lane % lanes;
    castSums[lane] = sums;
    castBlocked[lane] = blocked;
    castCut[lane] = cut;
    barrier();
    sums = vec4(0.0);
    blocked = 0u;
    [[dont_unroll]] for (uint k = first; k < first + lanes; ++k) {
        sums += castSums[k];
        blocked += castBlocked[k];
        cut = cut || castCut[k];
    }
    return sums;
}

// How the share that passes changes along the axes of both clusters: least squares, held back by a ridge (A. Hoerl,
// R. Kennard, 1970), so that slopes from few rays are small unless these agree on them. `open_` are the slopes
// without blockers over their mean; both together leave no triangle with less than nothing. `scatter` is what the
// slopes leave of that about the share.
const float kTrendRidge = 2.0; // rays' worth of no slope (1 to 5 are alike)
vec4 slopesOf(Trend t, float rays, float share, vec4 open_, vec4 reach, out float scatter) {
    vec4 mean = t.at / rays, b = t.passedAt - share * t.at, s = t.squares - t.at * mean;
    vec4 m = t.products - t.at.xxxy * mean.yzwz;
    vec2 n = t.moreProducts - t.at.yz * mean.ww;
    mat4 S = mat4(s.x, m.x, m.y, m.z, m.x, s.y, m.w, n.x, m.y, m.w, s.z, n.y, m.z, n.x, n.y, s.w);
    mat4 A = inverse(S + mat4(kTrendRidge));
    vec4 slope = A * b;
    float parameters = 4.0 - kTrendRidge * (A[0].x + A[1].y + A[2].z + A[3].w);
    float room = share * max(0.0, 0.99 - dot(abs(open_), reach)), need = dot(abs(slope), reach) - dot(open_, slope);
    slope *= need > room ? room / need : 1.0;
    float rest = rays * share * (1.0 - share) - 2.0 * dot(slope, b) + dot(slope, S * slope);
    scatter = sqrt(max(rest, 0.0) / max(rays - parameters, 1.0));
    return slope;
}

void main() {
    uint index = gl_GlobalInvocationID.x / kLanes;
    bool idle = index >= params.pairCount;
    if (kLanes == 1u && idle) return; // the others' lanes wait for one another
    HierarchicalDoubt d = doubted[min(index, params.pairCount - 1u)];
    uint i = d.link.first, j = d.link.second, seed = hashOf(i * 0x9e3779b9u ^ hashOf(j));
    Cluster p = clusterAt(i), q = clusterAt(j);
    bool triangles = p.child == 0u && q.child == 0u;
    float factor = d.link.density * max(p.area, q.area); // from the lesser end
    bool byAngle = triangles && factor > kFactorByAngle;
    if (byAngle && q.area < p.area) {
        Cluster larger = p;
        p = q;
        q = larger;
    }
    uint rays = triangles ? clamp(d.rays, kHierarchicalFewRays, kLanes * d.roundRays) : kHierarchicalRays;
    uint end = d.rays + rays, blocked;
    Trend trend;
    bool cut;
    vec4 sums = castRays(d, p, q, byAngle, seed, end, blocked, trend, cut);
    if (idle || gl_LocalInvocationID.x % kLanes > 0u) return;
    if (cut) {
        if (kLanes > 1u && !triangles) {
            split(i, j, p, q);
            return;
        }
        if (kLanes > 1u) d.roundRays = rays > kLanes ? max(rays / (4u * kLanes), 1u) : 0u;
        if (d.roundRays == 0u) atomicAdd(counters[kHierarchicalCuts], 1u);
        longDoubts[atomicAdd(counters[kHierarchicalLongDoubts], 1u)] = d;
        return;
    }
    d.passed += sums.x;
    d.open += sums.y;
    d.passedSquares += sums.z;
    d.openSquares += sums.w;
    d.rays = end;
    float share, error;
    if (triangles) {
        share = d.open > 0.0 ? d.passed / d.open : 0.0;
        // All rays may have begun or ended behind the other's plane.
        float agreed = 1.0, allowed = kHierarchicalKept * params.visibilityTolerance / factor;
        error = d.open > 0.0 ? errorOfShare(d, share, byAngle ? factor : kPi * d.link.density, agreed) : 1.0;
        bool last = error <= allowed || end >= params.mostRays;
        // Here pairs end whose rays agree: the mean over them and those that go on is unbiased.
        if ((agreed <= allowed || last) && d.link.unbiased == d.link.density) d.link.unbiased *= share;
        if (!last) {
            if (kLanes == 1u && end < kHierarchicalManyRays)
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
        error = kAgreedError * doubtOfAgreement(p, q);
        if (mixed) {
            vec4 open_ = vec4(unpackHalf2x16(d.link.firstSlope), unpackHalf2x16(d.link.secondSlope));
            vec4 slope = slopesOf(trend, float(end), share, open_, vec4(p.reach, q.reach), error);
            vec4 both = share * open_ + slope;
            share += dot(open_, slope); // coordinates have a mean square of one
            d.link.firstSlope = packHalf2x16(both.xy / share);
            d.link.secondSlope = packHalf2x16(both.zw / share);
        }
    }
    d.link.agreed = blocked == 0u && d.passed == d.open ? end : 0u;
    error *= d.link.density;
    d.link.density *= share;
    if (!triangles) d.link.unbiased = d.link.density;
    d.link.error = share > 0.0 ? length(vec2(share * d.link.error, error)) : error;
    // Those that carry nothing are kept only if they should have carried something.
    if (share > 0.0 || error * max(p.area, q.area) > kNothing * params.visibilityTolerance)
        links[atomicAdd(counters[kHierarchicalLinks], 1u)] = d.link;
}
