// Form factor from a point to what is lit of a triangle or quadrangle behind at most two convex blockers of at most
// four corners, in registers. In the frame of the piece (origin at its first corner, z along its normal) a shadow
// is an intersection of half planes; F(lit) = F(piece) - F(A) - F(B) + F(A and B), each a sum of Lambert's formula
// over the border (visible_polygon.glsl does any number of blockers, at eight times the cost). Needs
// exact_scene.glsl, lambert.glsl and kCorners.
#ifndef CONVEX_SHADOWS_GLSL
#define CONVEX_SHADOWS_GLSL
#include "shaders/lib/constants.glsl"

const int kWalls = 5; // through the point and an edge of the blocker, four times; the blocker's own plane
// Of which kCorners + 1 are used: the last where the receiver's plane cuts the piece.
const int kRim = int(kExactFewCorners) + 1;
const vec3 kNoLine = vec3(0.0, 0.0, kHuge);
const vec2 kEmpty = vec2(kHuge, -kHuge);

struct Blocker {
    vec3 corner[kWalls - 1];
    vec3 normal;
    float sight; // +1: hides from its front alone, -1 from its back, 0 from either
};

struct Shadow {
    vec3 line[kWalls];  // positive inside, xy unit; kNoLine where it does not cross the piece
    vec2 range[kWalls]; // the stretch of each line on the shadow's border
    vec2 rim[kRim];     // the stretch of each edge of the piece within the shadow
};

// The piece above the receiver's plane: edges counter-clockwise, `from + t along` for t in `rim`, and the corners
// in any order.
vec2 rimFrom[kRim];
vec2 rimAlong[kRim];
vec2 rim[kRim];
vec2 inner[kRim];
vec3 point;       // the receiver, and its normal
vec3 facing;
float near;       // lines may be this far from where they should be

float at(vec3 line, vec2 p) { return dot(line.xy, p) + line.z; }

vec2 footOf(vec3 line) { return -line.z * line.xy; }

vec2 alongOf(vec3 line) { return vec2(line.y, -line.x); }

// Finds the lines of a blocker's shadow that cross the piece. x nothing of the piece lies in it, y all does.
bvec2 castShadow(Blocker b, inout Shadow s) {
    vec3 k0 = b.corner[0] - point;
    float side = -dot(b.normal, k0), sense = side > 0.0 ? -1.0 : 1.0;
    bool outside = abs(side) <= kFlat * length(k0) || b.sight * side < 0.0, whole = true;
    [[unroll]] for (int c = 0; c < kWalls; ++c) {
        vec3 k = b.corner[c % (kWalls - 1)], next = b.corner[(c + 1) % (kWalls - 1)];
        vec3 n = c == kWalls - 1 ? b.normal : cross(k - point, next - k);
        vec3 line = sense * vec3(n.xy, -dot(n, k));
        // An edge in the piece's plane: through it goes the same line as in the blocker's own plane, but seen from near
        // the piece's plane rounding would move it. Nor does an edge without length bound anything.
        bool same = c < kWalls - 1 && abs(k.z) <= kFlat * length(k) && abs(next.z) <= kFlat * length(next);
        float size = length(n.xy), full = same ? 0.0 : length(n);
        // Parallel to the piece: all in or all out, out where both are one.
        bool level = size <= kParallel * full || same;
        float height = abs(line.z) <= kParallel * full * length(k) ? 0.0 : sign(line.z) * kHuge;
        line = level ? vec3(0.0, 0.0, full == 0.0 ? kHuge : height) : line / size;
        float low = kHuge, high = -kHuge;
        [[unroll]] for (int q = 0; q <= kCorners; ++q) {
            float d = at(line, inner[q]);
            low = min(low, d);
            high = max(high, d);
        }
        outside = outside || high <= near;
        bool cuts = low < -near;
        whole = whole && !cuts;
        s.line[c] = cuts ? line : kNoLine;
    }
    return bvec2(outside, whole && !outside);
}

// Narrows a stretch of `from + t along` to where d + slope t is positive.
vec2 cut(vec2 range, float d, float slope) {
    float t = -d / slope;
    range.x = slope > 0.0 ? max(range.x, t) : range.x;
    range.y = slope < 0.0 ? min(range.y, t) : range.y;
    return slope == 0.0 && d < 0.0 ? kEmpty : range;
}

// The same for a line; where both run together, `kept` says what stays.
vec2 narrow(vec2 range, vec2 from, vec2 along, vec3 line, bool kept) {
    float d = at(line, from), slope = dot(line.xy, along);
    vec2 ends = abs(d + slope * range);
    return max(ends.x, ends.y) > near ? cut(range, d, slope) : kept ? range : kEmpty;
}

// Twice pi times a stretch's share in the form factor.
float stretch(vec2 from, vec2 along, vec2 range) {
    vec3 a = vec3(from + range.x * along, 0.0) - point, b = vec3(from + range.y * along, 0.0) - point;
    return range.x < range.y ? -lambertEdge(a, b, facing) : 0.0; // clockwise seen from the point
}

float overRim(vec2 range[kRim]) {
    float sum = 0.0;
    int k = 0;
    [[dont_unroll]] do {
        sum += stretch(rimFrom[k], rimAlong[k], range[k]);
        ++k;
    } while (k <= kCorners);
    return sum;
}

// From corners and their heights over the receiver's plane.
void setPiece(vec2 corner[kRim], float height[kRim]) {
    vec2 leaves = corner[0], enters = corner[0];
    bool clipped = false;
    [[unroll]] for (int k = 0; k < kCorners; ++k) {
        vec2 along = corner[(k + 1) % kCorners] - corner[k];
        float h = height[k], g = height[(k + 1) % kCorners], t = h / (h - g);
        rimFrom[k] = corner[k];
        rimAlong[k] = along;
        rim[k] = vec2(h < 0.0 ? t : 0.0, g < 0.0 ? t : 1.0);
        if (h < 0.0 && g <= 0.0 || h <= 0.0 && g < 0.0) rim[k] = kEmpty;
        if (h >= 0.0 && g < 0.0) leaves = corner[k] + (h > 0.0 ? t : 0.0) * along;
        if (h < 0.0 && g >= 0.0) enters = corner[k] + (g > 0.0 ? t : 1.0) * along;
        clipped = clipped || h < 0.0;
    }
    rimFrom[kCorners] = leaves;
    rimAlong[kCorners] = enters - leaves;
    rim[kCorners] = clipped ? vec2(0.0, 1.0) : kEmpty;
    [[unroll]] for (int k = 0; k < kCorners; ++k) inner[k] = height[k] < 0.0 ? leaves : corner[k];
    inner[kCorners] = clipped ? enters : inner[0];
}

// Twice pi times the form factor of the part of the piece in a shadow; finds the shadow's border.
float shadowSum(inout Shadow s) {
    [[unroll]] for (int k = 0; k <= kCorners; ++k) {
        s.rim[k] = rim[k];
        [[unroll]] for (int w = 0; w < kWalls; ++w)
            s.rim[k] = cut(s.rim[k], at(s.line[w], rimFrom[k]), dot(s.line[w].xy, rimAlong[k]));
    }
    float sum = overRim(s.rim);
    int w = 0;
    [[dont_unroll]] do {
        vec3 line = s.line[w];
        vec2 from = footOf(line), along = alongOf(line), range = vec2(-kHuge, kHuge);
        [[unroll]] for (int k = 0; k <= kCorners; ++k) {
            vec2 inward = vec2(-rimAlong[k].y, rimAlong[k].x);
            range = cut(range, dot(inward, from - rimFrom[k]), dot(inward, along));
        }
        // Of two lines that coincide (a blocker that stands on the piece) the first counts.
        [[unroll]] for (int m = 0; m < kWalls; ++m)
            range = narrow(range, from, along, s.line[m], w <= m || dot(line.xy, s.line[m].xy) <= 0.0);
        s.range[w] = range = line.z == kNoLine.z ? kEmpty : range;
        sum += stretch(from, along, range);
        ++w;
    } while (w < kWalls);
    return sum;
}

// The same for those of a shadow's lines that another covers: with the other's, and both rims, the border of what
// both have in common. Where lines of both run together the first shadow's counts.
float coveredSum(Shadow s, Shadow by, bool first) {
    float sum = 0.0;
    int w = 0;
    [[dont_unroll]] do {
        vec3 line = s.line[w];
        vec2 from = footOf(line), along = alongOf(line), range = s.range[w];
        [[unroll]] for (int m = 0; m < kWalls; ++m)
            range = narrow(range, from, along, by.line[m], first && dot(line.xy, by.line[m].xy) > 0.0);
        sum += stretch(from, along, range);
        ++w;
    } while (w < kWalls);
    return sum;
}
#endif
