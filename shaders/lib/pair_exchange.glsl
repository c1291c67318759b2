// What two triangles exchange when nothing stands between: A_p F_pq = 1/pi int int cos cos / r^2, parts behind either's plane
// cut away. Near pairs by the double integral round both borders (E. M. Sparrow, "A New and Simpler Formulation for Radiative
// Angle Factors", 1963), the inner one in closed form, the outer one by Gauss' rule under a substitution that smooths its
// ends, where borders touch; others by a product rule.
#ifndef PAIR_EXCHANGE_GLSL
#define PAIR_EXCHANGE_GLSL
#include "shaders/lib/lambert.glsl"

const float kPairPi = 3.14159265359;
const float kPairFlat = 1e-6; // heights below this share of the distance are rounding errors
const float kPairNear = 0.15;  // sizes over distance from which the product rule is left

struct Triangle {
    vec3 a, rest; // a corner, and what of it float32 leaves out
    vec3 ab, ac;
    vec3 normal;
    float area;
};

float kernelBetween(vec3 x, vec3 nx, vec3 y, vec3 ny) {
    vec3 d = y - x;
    float r2 = dot(d, d);
    return max(0.0, dot(nx, d)) * max(0.0, -dot(ny, d)) / (kPairPi * r2 * r2);
}

// int ln |p - x| along a segment that begins at `from` relative to p.
float logAlong(vec3 from, vec3 unit, float size) {
    float t0 = dot(from, unit), t1 = t0 + size;
    vec3 across = from - t0 * unit;
    float d2 = dot(across, across), d = sqrt(d2);
    float turn = d2 + t0 * t1, rise = d * size;
    float angle = d > 0.0 ? angleOf(rise, turn) : 0.0;
    return 0.5 * (t1 * log(max(d2 + t1 * t1, 1e-30)) - t0 * log(max(d2 + t0 * t0, 1e-30))) - size + d * angle;
}

// The part of a triangle over a plane, as four corners, some of which may coincide. h: heights of its corners.
void cutAtPlane(vec3 corner[3], vec3 h, out vec3 part[4]) {
    // Turned so that the corner that lies alone on its side comes first.
    bvec3 over = greaterThanEqual(h, vec3(0.0));
    int alone = over.x == over.y ? (over.x == over.z ? 0 : 2) : over.x == over.z ? 1 : 0;
    vec3 a = alone == 0 ? corner[0] : alone == 1 ? corner[1] : corner[2];
    vec3 b = alone == 0 ? corner[1] : alone == 1 ? corner[2] : corner[0];
    vec3 c = alone == 0 ? corner[2] : alone == 1 ? corner[0] : corner[1];
    vec3 g = alone == 0 ? h : alone == 1 ? h.yzx : h.zxy;
    vec3 ab = a + (b - a) * (g.x / (g.x - g.y)), ac = a + (c - a) * (g.x / (g.x - g.z));
    if (all(over) || !any(over)) {
        part[0] = a, part[1] = b, part[2] = c, part[3] = c;
        if (!any(over)) part[1] = a, part[2] = a, part[3] = a;
    } else if (g.x >= 0.0) {
        part[0] = a, part[1] = ab, part[2] = ac, part[3] = ac;
    } else {
        part[0] = ab, part[1] = b, part[2] = c, part[3] = ac;
    }
}

// Gauss and Legendre's rule of eight points, its positive half.
const vec4 kPairNodes = vec4(0.183434642496, 0.525532409916, 0.796666477414, 0.960289856498);
const vec4 kPairWeights = vec4(0.362683783378, 0.313706645878, 0.222381034453, 0.101228536290);

float bordersIntegral(vec3 p[4], vec3 q[4]) {
    float sum = 0.0;
    [[dont_unroll]] for (uint k = 0u; k < 32u; ++k) {
        uint edge = k / 8u, node = k % 4u;
        vec3 from = edge == 0u ? p[0] : edge == 1u ? p[1] : edge == 2u ? p[2] : p[3];
        vec3 along = (edge == 0u ? p[1] : edge == 1u ? p[2] : edge == 2u ? p[3] : p[0]) - from;
        float x = kPairNodes[node], w = kPairWeights[node];
        float t = 0.5 + 0.5 * ((k & 4u) == 0u ? -x : x);
        vec3 at = from + along * (t * t * (3.0 - 2.0 * t));
        float line = 0.0;
        for (int e = 0; e < 4; ++e) {
            vec3 start = q[e], edge_ = q[(e + 1) % 4] - start;
            float size = length(edge_);
            vec3 unit = size > 0.0 ? edge_ / size : vec3(0.0);
            line += size > 0.0 ? dot(along, unit) * logAlong(start - at, unit, size) : 0.0;
        }
        sum += 0.5 * w * 6.0 * t * (1.0 - t) * line;
    }
    return sum / (2.0 * kPairPi);
}

// Twice pi times the factor from a point of a plane to a polygon wholly over it, corners relative to the point: Lambert's formula.
float lambertSum(vec3 corner[4], vec3 normal) {
    float sum = 0.0;
    for (int e = 0; e < 4; ++e) sum += lambertEdge(corner[e], corner[(e + 1) % 4], normal);
    return abs(sum);
}

// Factor from a small triangle, by Radon's rule of degree 5 with seven points, to a polygon over its plane.
float lambertMean(vec3 a, vec3 b, vec3 c, vec3 normal, vec3 q[4], bool wanted) {
    vec3 middle = (a + b + c) / 3.0;
    float sum = 0.0;
    uint end = wanted ? 7u : 0u; // a loop that may run no turn: software devices do not skip an `if`
    [[dont_unroll]] for (uint k = 0u; k < end; ++k) {
        vec3 corner = k % 3u == 0u ? a : k % 3u == 1u ? b : c;
        float out_ = k == 6u ? 0.0 : k < 3u ? 0.696140478028 : -0.410426192314;
        vec3 at = middle + out_ * (corner - middle);
        float weight = k == 6u ? 0.225 : k < 3u ? 0.125939180545 : 0.132394152788;
        vec3 moved[4] = vec3[](q[0] - at, q[1] - at, q[2] - at, q[3] - at);
        sum += weight * lambertSum(moved, normal);
    }
    return sum / (2.0 * kPairPi);
}

const float kPairUneven = 3000.0; // ratio of areas from which a point stands for the smaller one

// A_p F_pq and, in y, its error, estimated: of sums round borders that cancel, or of the product rule, which falls with the cube
// of size over distance. Corners are relative to one of the smaller triangle, so that it keeps its digits however large the other is. Of pairs that are `near` only with
// `nearOnes`, of others only without: a constant, so that a pipeline has the code of one kind.
vec2 pairExchange(Triangle one, Triangle other, const bool nearOnes, out bool near) {
    bool swapped = other.area < one.area;
    Triangle p = one, q = other;
    if (swapped) p = other, q = one;
    vec3 first = (q.a - p.a) + (q.rest - p.rest);
    vec3 cp[3] = vec3[](vec3(0.0), p.ab, p.ac);
    vec3 cq[3] = vec3[](first, first + q.ab, first + q.ac);
    vec3 d = (cq[0] + cq[1] + cq[2] - cp[1] - cp[2]) / 3.0;
    vec3 overP, overQ; // heights of the other's corners
    for (int k = 0; k < 3; ++k) {
        float h = dot(p.normal, cq[k]), g = dot(q.normal, cp[k] - first);
        overP[k] = abs(h) <= kPairFlat * length(cq[k]) ? 0.0 : h;
        overQ[k] = abs(g) <= kPairFlat * length(cp[k] - first) ? 0.0 : g;
    }
    vec2 lowest = vec2(min(overP.x, min(overP.y, overP.z)), min(overQ.x, min(overQ.y, overQ.z)));
    bool facing = max(overP.x, max(overP.y, overP.z)) > 0.0 && max(overQ.x, max(overQ.y, overQ.z)) > 0.0;
    float size = sqrt(p.area) + sqrt(q.area), distance_ = length(d);
    float longest = max(max(length(p.ab), length(p.ac)), max(length(q.ab), length(q.ac)));
    near = facing && (min(lowest.x, lowest.y) < 0.0 || max(size, longest) > 2.0 * kPairNear * distance_);
    // Both in units of their size, so that logarithms stay small.
    float unit = 1.0 / max(distance_, size);
    for (int k = 0; k < 3; ++k) {
        cp[k] *= unit;
        cq[k] *= unit;
    }
    float result;
    if (nearOnes) {
        vec3 partP[4], partQ[4];
        cutAtPlane(cq, overP, partQ);
        cutAtPlane(cp, overQ, partP);
        bool uneven = p.area * kPairUneven < q.area;
        float mean = lambertMean(partP[0], partP[1], partP[2], p.normal, partQ, uneven),
              rest = lambertMean(partP[0], partP[2], partP[3], p.normal, partQ, uneven);
        float areaA = 0.5 * length(cross(partP[1] - partP[0], partP[2] - partP[0])),
              areaB = 0.5 * length(cross(partP[2] - partP[0], partP[3] - partP[0]));
        result = uneven ? areaA * mean + areaB * rest : max(0.0, bordersIntegral(partP, partQ));
    } else {
        float sum = 0.0;
        for (int k = 0; k < 3; ++k) {
            vec3 x = (cp[0] + cp[1] + cp[2]) / 6.0 + 0.5 * cp[k];
            for (int l = 0; l < 3; ++l)
                sum += kernelBetween(x, p.normal, (cq[0] + cq[1] + cq[2]) / 6.0 + 0.5 * cq[l], q.normal);
        }
        result = sum * p.area * q.area * unit * unit * unit * unit / 9.0;
    }
    result = facing ? result / (unit * unit) : 0.0;
    float relative = longest / max(distance_, 1e-30);
    return vec2(result, result * (nearOnes ? 3e-4 : 0.005 * relative * relative * relative));
}
#endif
