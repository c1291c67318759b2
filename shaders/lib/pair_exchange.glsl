// What two triangles exchange when nothing stands between: A_p F_pq = 1/pi int int cos cos / r^2, parts behind
// either's plane cut away. Near pairs by the double integral round both borders (E. M. Sparrow, "A New and Simpler
// Formulation for Radiative Angle Factors", 1963), the inner one in closed form, the outer one by Gauss' rule under
// a substitution that smooths its ends, where borders touch, and in graded panels where that does not do; others by a
// product rule.
#ifndef PAIR_EXCHANGE_GLSL
#define PAIR_EXCHANGE_GLSL
#include "shaders/lib/constants.glsl"
#include "shaders/lib/lambert.glsl"
#include "shaders/lib/radon.glsl"

const float kPairFlat = 1e-6; // heights below this share of the distance are rounding errors
const float kPairRounded = 2e-7; // and below this share of the longest edge, as at corners that both share
const float kPairNear = 0.15;  // sizes over distance from which the product rule is left
const float kPairProductError = 0.005; // of the product rule, relative, times the cube of size over distance
const float kPairLeast = 3e-4;         // of all others, relative
const float kPairParallel = 1e-4;      // squared sine of lines that do not pass one over the other
const float kPairKink = 0.5;           // heights of others over how far they get apart, from which there is no kink

struct Triangle {
    vec3 a, rest; // a corner, and what of it float32 leaves out
    vec3 ab, ac;
    vec3 normal;
    float area;
};

float kernelBetween(vec3 x, vec3 nx, vec3 y, vec3 ny) {
    vec3 d = y - x;
    float r2 = dot(d, d);
    return max(0.0, dot(nx, d)) * max(0.0, -dot(ny, d)) / (kPi * r2 * r2);
}

// int ln |p - x| along a segment that begins at `from` relative to p; `less` is taken from the angle under which p
// sees it.
float logAlong(vec3 from, vec3 unit, float size, float less) {
    float t0 = dot(from, unit), t1 = t0 + size;
    vec3 across = from - t0 * unit;
    float d2 = dot(across, across), d = sqrt(d2);
    float turn = d2 + t0 * t1, rise = d * size;
    float angle = d > 0.0 ? angleOf(rise, turn) : 0.0;
    return 0.5 * (t1 * log(max(d2 + t1 * t1, kTiny)) - t0 * log(max(d2 + t0 * t0, kTiny))) - size + d * (angle - less);
}

// int sqrt(h^2 + x^2) from 0 to x >= 0.
float slantAlong(float h, float x) {
    float far = sqrt(h * h + x * x);
    return 0.5 * (x * far + (h > 0.0 ? h * h * log((x + far) / h) : 0.0));
}

// A line that passes close over the inside of a segment sees it under an angle of nearly pi there, and the distance
// that this is multiplied by has a kink where it passes, which no rule of few points follows. Whether it does, and
// pi times the integral of that distance along the line's own segment. From higher there is no kink, and the integral
// is so large that its rounding may be more than what the pair exchanges. `across` is from the segment's line to the
// other's beginning, `change` what is added to that up to the other's end.
bool passesOver(vec3 from, vec3 along, float length_, vec3 start, vec3 unit, float size, out float integral) {
    vec3 w = from - start, across = w - dot(w, unit) * unit, change = along - dot(along, unit) * unit;
    float apart2 = dot(change, change), apart = sqrt(apart2), s = -dot(across, change) / apart2; // of `along`
    float t = dot(w + s * along, unit), height = length(across + s * change);
    bool over = apart2 > kPairParallel * length_ * length_ && s > 0.0 && s < 1.0 && t > 0.0 && t < size &&
                height < kPairKink * apart;
    float both = slantAlong(height, apart * (1.0 - s)) + slantAlong(height, apart * s);
    integral = over ? kPi * length_ * both / apart : 0.0;
    return over;
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

// Gauss and Legendre's rule of eight points, its positive half; Legendre's polynomials of degree 4 to 7 there, each
// times (2 n + 1) / 2 and the weight, so that sums with them are the coefficients of what is integrated.
const vec4 kPairNodes = vec4(0.183434642496, 0.525532409916, 0.796666477414, 0.960289856498);
const vec4 kPairWeights = vec4(0.362683783378, 0.313706645878, 0.222381034453, 0.101228536290);
const vec4 kPairLegendre[4] = vec4[](vec4(0.414176097, 0.581608863, -0.267389671, -0.784906558),
                                           vec4(-0.461585323, 0.053565811, 0.616604864, 0.631774553),
                                           vec4(-0.242896191, -0.493295377, -0.559107383, -0.377896937),
                                           vec4(0.290305417, 0.268829359, 0.209892191, 0.117692456));

const float kPairRounding = 5e-9; // of sums round both borders, which cancel, over the product of their lengths
const uint kPairMostPanels = 40u;          // of an edge
const float kPairLeastPanel = 1.0 / 512.0; // of its length
const float kPairErrorOfLast = 0.3; // measured: 99 of 100 pairs that touch err by less

float around(vec3 p[4]) {
    return length(p[1] - p[0]) + length(p[2] - p[1]) + length(p[3] - p[2]) + length(p[0] - p[3]);
}

// A panel from `at` along a line with direction `unit` within which what is integrated is smooth: corners of the other
// triangle, where it is not, are at least three quarters of the panel's length from its middle.
float panelFrom(vec3 at, vec3 unit, vec3 q[4]) {
    float reach = kHuge;
    for (int k = 0; k < 4; ++k) {
        vec3 d = q[k] - at;
        float ahead = dot(d, unit);
        reach = min(reach, 1.6 * (sqrt(ahead * ahead + 1.25 * dot(d, d)) - ahead));
    }
    return reach;
}

// int ln r round q, along each edge times how far that goes with `along`; `less` as in logAlong.
float logAround(vec3 at, vec3 along, vec3 q[4], vec4 less) {
    float sum = 0.0;
    for (int e = 0; e < 4; ++e) {
        vec3 start = q[e], edge = q[(e + 1) % 4] - start;
        float size = length(edge);
        vec3 unit = size > 0.0 ? edge / size : vec3(0.0);
        sum += size > 0.0 ? dot(along, unit) * logAlong(start - at, unit, size, less[e]) : 0.0;
    }
    return sum;
}

// The double integral over 2 pi, by Gauss' rule along each edge; `graded` in panels that are the shorter the nearer
// they are to corners of q, else in one that is smoothed at its ends. In y its error, estimated: the last two
// coefficients of what is integrated along a panel, as far as these fall from the two before.
vec2 bordersIntegral(vec3 p[4], vec3 q[4], bool graded) {
    vec2 sum = vec2(0.0);
    [[dont_unroll]] for (uint edge = 0u; edge < 4u; ++edge) {
        vec3 from = edge == 0u ? p[0] : edge == 1u ? p[1] : edge == 2u ? p[2] : p[3];
        vec3 along = (edge == 0u ? p[1] : edge == 1u ? p[2] : edge == 2u ? p[3] : p[0]) - from;
        float length_ = length(along);
        vec4 less = vec4(0.0);
        for (int e = 0; e < 4; ++e) {
            vec3 edge_ = q[(e + 1) % 4] - q[e];
            float size = length(edge_), integral;
            bool any = length_ > 0.0 && size > 0.0;
            if (passesOver(from, along, any ? length_ : 1.0, q[e], any ? edge_ / size : vec3(0.0), size, integral) &&
                any) {
                less[e] = kPi;
                sum.x += dot(along, edge_) / (size * length_) * integral;
            }
        }
        vec4 coefficients = vec4(0.0);
        float begin = length_ > 0.0 ? 0.0 : 1.0, panel = 1.0; // of the edge
        [[dont_unroll]] for (uint k = 0u; k < 8u * kPairMostPanels && begin < 1.0; ++k) {
            if (graded && k % 8u == 0u) {
                panel = max(panelFrom(from + begin * along, along / length_, q) / length_, kPairLeastPanel);
                if (begin + panel > 1.0 || k / 8u + 1u == kPairMostPanels) panel = 1.0 - begin;
            }
            uint node = k % 4u;
            bool lower = (k & 4u) == 0u;
            float t = 0.5 + 0.5 * (lower ? -kPairNodes[node] : kPairNodes[node]);
            vec3 at = from + along * (begin + panel * (graded ? t : t * t * (3.0 - 2.0 * t)));
            float line = panel * (graded ? 0.5 : 3.0 * t * (1.0 - t)) * logAround(at, along, q, less);
            sum.x += kPairWeights[node] * line;
            coefficients += line * (lower ? vec4(1.0, -1.0, 1.0, -1.0) : vec4(1.0)) * kPairLegendre[node];
            if (k % 8u == 7u) {
                float last = length(coefficients.zw), ratio = min(1.0, last / max(length(coefficients.xy), kTiny));
                sum.y += kPairErrorOfLast * last * ratio * ratio;
                coefficients = vec4(0.0);
                begin += panel;
            }
        }
    }
    return sum / (2.0 * kPi);
}

// Twice pi times the factor from a point of a plane to a polygon wholly over it, corners relative to the point:
// Lambert's formula.
float lambertSum(vec3 corner[4], vec3 normal) {
    float sum = 0.0;
    for (int e = 0; e < 4; ++e) sum += lambertEdge(corner[e], corner[(e + 1) % 4], normal);
    return abs(sum);
}

// Factor from a small triangle, by Radon's rule of degree 5 with seven points, to a polygon over its plane; in y its
// error, estimated: how far the two rules of degree 2 within it are apart.
vec2 lambertMean(vec3 a, vec3 b, vec3 c, vec3 normal, vec3 q[4], bool wanted) {
    vec3 middle = (a + b + c) / 3.0;
    vec3 sums = vec3(0.0); // far ones', near ones', centre's
    uint end = wanted ? 7u : 0u; // a loop that may run no turn: software devices do not skip an `if`
    [[dont_unroll]] for (uint k = 0u; k < end; ++k) {
        vec3 corner = k % 3u == 0u ? a : k % 3u == 1u ? b : c;
        float out_ = k == 6u ? 0.0 : k < 3u ? kRadonFarOut : kRadonNearOut;
        vec3 at = middle + out_ * (corner - middle);
        vec3 moved[4] = vec3[](q[0] - at, q[1] - at, q[2] - at, q[3] - at);
        sums += lambertSum(moved, normal) * vec3(k < 3u, k >= 3u && k < 6u, k == 6u);
    }
    float byFar = kRadonFarLow / 3.0 * sums.x + (1.0 - kRadonFarLow) * sums.z,
          byNear = kRadonNearLow / 3.0 * sums.y + (1.0 - kRadonNearLow) * sums.z;
    float mean = dot(sums, vec3(kRadonFarWeight, kRadonNearWeight, kRadonCentreWeight));
    return vec2(mean, abs(byFar - byNear)) / (2.0 * kPi);
}

const float kPairUneven = 3000.0; // ratio of areas from which points may stand for the smaller one
const float kPairErrorOfPoints = 0.1; // of a sliver, over how far these and the sums round borders are apart

// What parts exchange that are wholly over each other's plane and, in y, its error, estimated: by points of p where q
// is much larger, `uneven`, and p is small every way; else round borders. Points of a sliver, which may all lie on one
// side of a border, count where both agree.
vec2 nearExchange(vec3 p[4], vec3 q[4], vec3 normal, bool uneven, bool everyWay, float allowed) {
    vec2 mean = lambertMean(p[0], p[1], p[2], normal, q, uneven),
         rest = lambertMean(p[0], p[2], p[3], normal, q, uneven);
    float areaA = 0.5 * length(cross(p[1] - p[0], p[2] - p[0])), areaB = 0.5 * length(cross(p[2] - p[0], p[3] - p[0]));
    vec2 points = areaA * mean + areaB * rest;
    float rounding = kPairRounding * around(p) * around(q), wanted = max(allowed, rounding);
    bool enough = uneven && everyWay && points.y <= wanted;
    vec2 borders = vec2(0.0, 2.0 * wanted);
    [[dont_unroll]] for (uint look = 0u; look < 2u && !enough && borders.y > wanted; ++look)
        borders = bordersIntegral(p, q, look > 0u);
    borders.y += rounding;
    float apart = abs(points.x - borders.x);
    vec2 sliver = vec2(points.x, points.y + kPairErrorOfPoints * apart);
    return enough ? points : uneven && apart <= borders.y && sliver.y <= borders.y ? sliver : borders;
}

// A_p F_pq and, in y, its error, estimated: of sums round borders, made again in panels where it is above
// `allowed`; of points of a much smaller triangle where that is less; or of the product rule, which falls with the
// cube of size over distance. Corners are relative to one of the smaller triangle, so that it keeps its digits however
// large the other is. Of pairs that are `near` only with `nearOnes`, of others only without: a constant, so that a
// pipeline has the code of one kind.
vec2 pairExchange(Triangle one, Triangle other, float allowed, const bool nearOnes, out bool near) {
    bool swapped = other.area < one.area;
    Triangle p = one, q = other;
    if (swapped) p = other, q = one;
    vec3 first = (q.a - p.a) + (q.rest - p.rest);
    vec3 cp[3] = vec3[](vec3(0.0), p.ab, p.ac);
    vec3 cq[3] = vec3[](first, first + q.ab, first + q.ac);
    vec3 d = (cq[0] + cq[1] + cq[2] - cp[1] - cp[2]) / 3.0;
    float longest = max(max(length(p.ab), length(p.ac)), max(length(q.ab), length(q.ac)));
    vec3 overP, overQ; // heights of the other's corners
    for (int k = 0; k < 3; ++k) {
        float h = dot(p.normal, cq[k]), g = dot(q.normal, cp[k] - first);
        overP[k] = abs(h) <= max(kPairFlat * length(cq[k]), kPairRounded * longest) ? 0.0 : h;
        overQ[k] = abs(g) <= max(kPairFlat * length(cp[k] - first), kPairRounded * longest) ? 0.0 : g;
    }
    vec2 lowest = vec2(min(overP.x, min(overP.y, overP.z)), min(overQ.x, min(overQ.y, overQ.z)));
    bool facing = max(overP.x, max(overP.y, overP.z)) > 0.0 && max(overQ.x, max(overQ.y, overQ.z)) > 0.0;
    float size = sqrt(p.area) + sqrt(q.area), distance_ = length(d);
    near = facing && (min(lowest.x, lowest.y) < 0.0 || max(size, longest) > 2.0 * kPairNear * distance_);
    // Both in units of their size, so that logarithms stay small.
    float unit = 1.0 / max(distance_, size);
    for (int k = 0; k < 3; ++k) {
        cp[k] *= unit;
        cq[k] *= unit;
    }
    float result, error;
    if (nearOnes) {
        vec3 partP[4], partQ[4];
        cutAtPlane(cq, overP, partQ);
        cutAtPlane(cp, overQ, partP);
        bool uneven = p.area * kPairUneven < q.area;
        float longP = max(length(p.ab), length(p.ac));
        bool everyWay = 0.25 * longP * longP * kPairUneven < q.area;
        vec2 best = nearExchange(partP, partQ, p.normal, uneven, everyWay, allowed * unit * unit);
        result = max(0.0, best.x);
        error = max(kPairLeast * result, best.y);
    } else {
        float sum = 0.0;
        for (int k = 0; k < 3; ++k) {
            vec3 x = (cp[0] + cp[1] + cp[2]) / 6.0 + 0.5 * cp[k];
            for (int l = 0; l < 3; ++l)
                sum += kernelBetween(x, p.normal, (cq[0] + cq[1] + cq[2]) / 6.0 + 0.5 * cq[l], q.normal);
        }
        result = sum * p.area * q.area * unit * unit * unit * unit / 9.0;
        float relative = longest / max(distance_, kTiny);
        error = result * kPairProductError * relative * relative * relative;
    }
    return facing ? vec2(result, error) / (unit * unit) : vec2(0.0);
}
#endif
