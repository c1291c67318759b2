// Clusters of coplanar triangles, and rays between them. Before this: uniform usamplerBuffer nodes, leaves, and
// those of bvh.glsl.
#ifndef CLUSTER_GLSL
#define CLUSTER_GLSL
#include "shaders/lib/bvh.glsl"
#include "shaders/lib/constants.glsl"
#include "shaders/lib/monte_carlo_points.glsl"

struct Cluster {
    vec3 centre, normal, axisU, axisV;
    float radius, area;
    uint firstLeaf, leafCount, child, room;
    vec2 reach; // of its triangles' middles along the axes
};

Cluster clusterAt(uint index) {
    uvec4 t0 = texelFetch(nodes, int(5u * index)), t1 = texelFetch(nodes, int(5u * index + 1u)),
          t2 = texelFetch(nodes, int(5u * index + 2u)), t3 = texelFetch(nodes, int(5u * index + 3u)),
          t4 = texelFetch(nodes, int(5u * index + 4u));
    return Cluster(uintBitsToFloat(t0.xyz), uintBitsToFloat(t1.xyz), uintBitsToFloat(t2.xyz), uintBitsToFloat(t3.xyz),
                   uintBitsToFloat(t0.w), uintBitsToFloat(t1.w), t2.w, t3.w, t4.x, t4.y,
                   uintBitsToFloat(t4.zw));
}

// A point of the cluster from three numbers; the first picks the triangle.
vec3 pointOn(Cluster c, float pick, vec2 place) {
    uint leaf = c.firstLeaf + min(uint(pick * float(c.leafCount)), c.leafCount - 1u);
    vec3 a = uintBitsToFloat(texelFetch(leaves, int(3u * leaf)).xyz),
         ab = uintBitsToFloat(texelFetch(leaves, int(3u * leaf + 1u)).xyz),
         ac = uintBitsToFloat(texelFetch(leaves, int(3u * leaf + 2u)).xyz);
    vec2 w = squareToTriangle(place);
    return a + w.x * ab + w.y * ac;
}

struct CastRay {
    vec3 from, to;
    float passed, open_; // what passes along it, what would in the open
};

struct Leaf {
    vec3 a, rest; // a corner, and what of it float32 leaves out
    vec3 ab, ac;
};

Leaf leafAt(uint index) {
    uvec4 t0 = texelFetch(leaves, int(3u * index)), t1 = texelFetch(leaves, int(3u * index + 1u)),
          t2 = texelFetch(leaves, int(3u * index + 2u));
    return Leaf(uintBitsToFloat(t0.xyz), uintBitsToFloat(uvec3(t0.w, t1.w, t2.w)), uintBitsToFloat(t1.xyz),
                uintBitsToFloat(t2.xyz));
}

// From a point of one triangle into the hemisphere over it, with a density of cosine / pi: the way to where that meets
// the front of the other; zero where it does not.
vec3 wayByAngle(Cluster p, Cluster q, vec2 place, vec2 direction) {
    Leaf one = leafAt(p.firstLeaf), other = leafAt(q.firstLeaf);
    vec2 w = squareToTriangle(place);
    vec3 corner = (other.a - one.a) + (other.rest - one.rest) - w.x * one.ab - w.y * one.ac;
    vec3 u = normalize(one.ab), d = mat3(u, cross(p.normal, u), p.normal) * squareToCosine(direction);
    float facing = dot(q.normal, d), along = dot(q.normal, corner) / min(facing, -1e-20);
    vec3 at = along * d - corner, n = cross(other.ab, other.ac) / (2.0 * q.area);
    vec2 weights = vec2(dot(cross(at, other.ac), n), dot(cross(other.ab, at), n)) / (2.0 * q.area);
    bool met = facing < 0.0 && along > 0.0 && min(weights.x, weights.y) >= 0.0 && weights.x + weights.y <= 1.0;
    return met ? along * d : vec3(0.0);
}

// Ray `k`, stratified by a rank-1 lattice with a random shift for each pair, between points of both. Of triangles so
// near that few such rays carry most of the light, every other one goes `byAngle` from the first triangle, and what
// it carries is divided by the density of both kinds (E. Veach, L. Guibas, "Optimally Combining Sampling Techniques
// for Monte Carlo Rendering", 1995): at most two, the form factor on average. Else the kernel times pi.
CastRay castRay(Cluster p, Cluster q, bool byAngle, uint seed, uint k, uint nodeCount, float flatness) {
    bool turned = byAngle && k % 2u == 1u;
    k = byAngle ? k / 2u : k;
    // Powers of the root of x^7 = x + 1, as fractions of 2^32: Roberts' generalised golden ratio in six dimensions.
    uvec3 bitsP = uvec3(hashOf(seed), hashOf(seed + 1u), hashOf(seed + 2u)) +
                  k * uvec3(3859688306u, 3468523226u, 3117001274u),
          bitsQ = uvec3(hashOf(seed + 3u), hashOf(seed + 4u), hashOf(seed + 5u)) +
                  k * uvec3(2801104767u, 2517223199u, 2262111973u);
    vec3 up = vec3(unitOf(bitsP.x), unitOf(bitsP.y), unitOf(bitsP.z)),
         uq = vec3(unitOf(bitsQ.x), unitOf(bitsQ.y), unitOf(bitsQ.z));
    vec3 from = pointOn(p, up.x, up.yz), to = pointOn(q, uq.x, uq.yz), d = to - from;
    if (turned) d = wayByAngle(p, q, up.yz, uq.yz), to = from + d;
    float r2 = dot(d, d), open_ = max(0.0, dot(p.normal, d)) * max(0.0, -dot(q.normal, d)) / max(r2 * r2, kTiny);
    float many = open_ * q.area * kInversePi;
    if (byAngle) open_ = 2.0 * many / (1.0 + many);
    return CastRay(from, to, blockedBetween(from, to, p.room, nodeCount, flatness) ? 0.0 : open_, open_);
}
#endif
