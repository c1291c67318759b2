// How much of a convex polygon is seen from a point behind convex blockers, exactly. In the polygon's plane each
// blocker's shadow is bounded by lines. The lit part's form factor is the whole's less that of the union of shadows,
// which is a sum over the union's border of triangles with one corner of the polygon: no polygon is ever cut, rounding
// moves a border but cannot tear it open. Needs exact_scene.glsl, lambert.glsl, exact_cubature.glsl
// (sightOf) and the buffer `lists`.
#ifndef VISIBLE_POLYGON_GLSL
#define VISIBLE_POLYGON_GLSL
#include "shaders/lib/constants.glsl"

// Loops over private arrays: drivers that unroll them by the array's length take minutes to compile.
#define NO_UNROLL [[dont_unroll]]

const int kPieceCap = 8;  // corners of a piece: kExactPieceCorners and one for each of two cuts
const int kLineCap = 48;  // lines of shadows that cross a piece
const int kStride = 4;    // lines in one turn of a loop: loop_limit.glsl

vec2 piece[kPieceCap]; // counter-clockwise
int pieceCorners;
vec2 kept[kPieceCap];
vec3 lines[kLineCap]; // positive inside the shadow; xy unit
uint owner[kLineCap]; // rank of the blocker; in ascending order
int lineCount;
bool linesLost = false; // more lines than that: the shadows are not known

vec3 lift(Frame f, vec2 p) { return f.origin + p.x * f.u + p.y * f.v; }

// A plane through space (unit normal) as a line in the frame: positive inside; xy unit. A plane parallel to the
// frame's, to within the rounding of normals, is all in or all out; out where both are one.
vec3 lineOf(Frame f, vec3 normal, vec3 onPlane) {
    vec3 d = f.origin - onPlane, line = vec3(dot(normal, f.u), dot(normal, f.v), dot(normal, d));
    float size = length(line.xy);
    if (size > kParallel) return line / size;
    return vec3(0.0, 0.0, abs(line.z) <= kParallel * length(d) ? 0.0 : sign(line.z) * kHuge);
}

float at(vec3 line, vec2 p) { return dot(line.xy, p) + line.z; }

// How far lines may be from where they should be. A line this near to the piece's border does not cross it.
float nearness(Frame f, vec3 point, float size) { return kBorder * (length(f.origin - point) + size); }

// Extent of the piece across a line; rounding errors count as touching.
vec2 extent(vec3 line, float flatness) {
    vec2 range = vec2(kHuge, -kHuge);
    NO_UNROLL for (int k = 0; k < pieceCorners; ++k) {
        float d = at(line, piece[k]);
        range = vec2(min(range.x, d), max(range.y, d));
    }
    if (range.x >= -flatness) range.x = max(range.x, 0.0);
    if (range.y <= flatness) range.y = min(range.y, 0.0);
    return range;
}

void loadPiece(Face face) {
    pieceCorners = int(face.count);
    NO_UNROLL for (int k = 0; k < pieceCorners; ++k) piece[k] = cornerInFrame(face.first + uint(k));
}

float pieceSize() {
    float size = 0.0;
    NO_UNROLL for (int k = 0; k < pieceCorners; ++k) size = max(size, length(piece[k]));
    return size;
}

// Keeps what lies in front of a plane, unless its corners only touch it: to within the rounding of the frame, also
// where the plane is given by a corner of the piece. A sliver cut off there would leave an edge without direction.
void clipTo(Frame f, vec3 normal, vec3 onPlane) {
    bool below = false;
    float away = length(f.origin - onPlane);
    NO_UNROLL for (int k = 0; k < pieceCorners; ++k)
        below = below || dot(normal, lift(f, piece[k]) - onPlane) < -kFlat * (away + length(piece[k]));
    if (!below) return;
    vec3 line = lineOf(f, normal, onPlane);
    int inside = 0;
    vec2 previous = piece[pieceCorners - 1];
    float dp = at(line, previous);
    NO_UNROLL for (int k = 0; k < pieceCorners; ++k) {
        vec2 p = piece[k];
        float d = at(line, p);
        if ((d >= 0.0) != (dp >= 0.0) && inside < kPieceCap) kept[inside++] = previous + dp / (dp - d) * (p - previous);
        if (d >= 0.0 && inside < kPieceCap) kept[inside++] = p;
        previous = p;
        dp = d;
    }
    NO_UNROLL for (int k = 0; k < inside; ++k) piece[k] = kept[k];
    pieceCorners = inside;
}

// Wall number c of the shadow of a blocker as a line, positive inside the shadow; the last wall is the blocker's own
// plane.
vec3 shadowLine(Frame f, Origin o, Face blocker, vec3 point, float sense, uint c) {
    vec3 a = cornerFrom(o, blocker.first + (c < blocker.count ? c : 0u)) - point;
    vec3 b = cornerFrom(o, blocker.first + (c + 1u < blocker.count ? c + 1u : 0u)) - point;
    vec3 normal = c < blocker.count ? normalize(cross(a, b - a)) : blocker.normal;
    return lineOf(f, sense * normal, point + a);
}

bool liesIn(Frame f, vec3 corner) { return heightOver(f.n, corner - f.origin) == 0.0; }

// Lists the lines of a blocker's shadow that cross the piece. True when all of the piece lies in the shadow.
bool castShadow(Frame f, Origin o, Face blocker, vec3 point, uint rank, float size) {
    vec3 k0 = cornerFrom(o, blocker.first) - point;
    float side = -dot(blocker.normal, k0);
    if (abs(side) <= kFlat * length(k0) || sightOf(blocker) * side < 0.0) return false;
    float sense = side > 0.0 ? -1.0 : 1.0;
    int before = lineCount;
    bool outside = false, crossed = false;
    float near = nearness(f, point, size);
    // The blocker's own plane is the cheapest and most often has all of the piece outside. Through an edge that lies in
    // the piece's plane goes the same line, but seen from near that plane rounding would move it.
    bool startLies = liesIn(f, cornerFrom(o, blocker.first));
    NO_UNROLL for (int c = int(blocker.count); c >= 0 && !outside; --c) {
        bool endLies = startLies;
        if (c < int(blocker.count)) {
            startLies = liesIn(f, cornerFrom(o, blocker.first + uint(c)));
            if (startLies && endLies) continue;
        }
        vec3 line = shadowLine(f, o, blocker, point, sense, uint(c));
        vec2 range = extent(line, near);
        outside = range.y <= 0.0;
        if (outside || range.x >= 0.0) continue;
        crossed = true;
        if (lineCount < kLineCap) {
            lines[lineCount] = line;
            owner[lineCount++] = rank;
        } else
            linesLost = true;
    }
    if (outside) lineCount = before;
    return !outside && !crossed;
}

// Twice pi times the form factor of a triangle of the piece's plane, relative to the point.
float lambertTriangle(vec3 a, vec3 b, vec3 c, vec3 normal) {
    return -lambertEdge(a, b, normal) - lambertEdge(b, c, normal) - lambertEdge(c, a, normal);
}

// A stretch of a border: from + t along.
struct Stretch {
    vec2 from;
    vec2 along;
    vec2 range;
    vec2 inward; // unit, to the side of the shadow or of the piece
    uint rank;   // of the blocker; above all others for the piece itself
};

const uint kPiece = 0xffffffffu;

// Narrows `range` to where a line is positive. Where a stretch runs along the line, whoever comes first counts it when
// both shadows lie on one side of it, nobody when they meet there.
vec2 narrow(vec2 range, Stretch s, vec3 line, uint rank, float near) {
    float d = at(line, s.from), slope = dot(line.xy, s.along);
    vec2 ends = d + slope * s.range;
    if (max(abs(ends.x), abs(ends.y)) <= near) {
        bool sameSide = dot(line.xy, s.inward) > 0.0;
        bool inside = s.rank == kPiece ? sameSide : !sameSide || rank < s.rank;
        return inside ? range : vec2(kHuge, -kHuge);
    }
    float t = -d / slope; // infinite, or no number where d is zero too, which `near` has caught
    if (slope > 0.0) range.x = max(range.x, t);
    if (slope < 0.0) range.y = min(range.y, t);
    return slope == 0.0 && d < 0.0 ? vec2(kHuge, -kHuge) : range;
}

// Border number k of the union of shadows within the piece: the piece's own edges, then the shadows' lines.
Stretch stretchAt(int k, float size) {
    if (k < pieceCorners) {
        vec2 along = piece[k + 1] - piece[k];
        float reach = length(along);
        return Stretch(piece[k], along / reach, vec2(0.0, reach), vec2(-along.y, along.x) / reach, kPiece);
    }
    vec3 line = lines[k - pieceCorners];
    return Stretch(-line.z * line.xy, vec2(line.y, -line.x), vec2(-size, size), line.xy, owner[k - pieceCorners]);
}

// Drivers run invocations in step: what all of them do is done first for all borders, so that nobody waits where only
// some have work.
int borders[kLineCap + kPieceCap]; // numbers of those that are not empty
vec2 ranges[kLineCap + kPieceCap];
int borderCount;

// Lines are cut by the piece and by the others of their own shadow.
void listBorders(float size, float near) {
    borderCount = 0;
    // Edges at the first corner span no triangle with it.
    NO_UNROLL for (int k = 1; k + 1 < pieceCorners; ++k) {
        borders[borderCount] = k;
        ranges[borderCount++] = vec2(0.0, length(piece[k + 1] - piece[k]));
    }
    int firstOfOwner = 0;
    NO_UNROLL for (int w = 0; w < lineCount; ++w) {
        Stretch s = stretchAt(pieceCorners + w, size);
        vec2 range = s.range;
        vec2 a = piece[pieceCorners - 1];
        NO_UNROLL for (int k = 0; k < pieceCorners; ++k) {
            vec2 b = piece[k], edge = b - a, inward = vec2(-edge.y, edge.x);
            float d = dot(inward, s.from - a), slope = dot(inward, s.along), t = -d / slope;
            if (slope > 0.0) range.x = max(range.x, t);
            if (slope < 0.0) range.y = min(range.y, t);
            if (slope == 0.0 && d < 0.0) range = vec2(kHuge, -kHuge);
            a = b;
        }
        firstOfOwner = owner[firstOfOwner] == s.rank ? firstOfOwner : w;
        Stretch mate = s; // of two lines of one shadow that coincide (a blocker that stands on the piece) one counts
        mate.rank = uint(w);
        NO_UNROLL for (int m = firstOfOwner; m < lineCount && owner[m] == s.rank; ++m)
            if (m != w) range = narrow(range, mate, lines[m], uint(m), near);
        if (range.x < range.y) {
            borders[borderCount] = pieceCorners + w;
            ranges[borderCount++] = range;
        }
    }
}

vec2 spans[kLineCap]; // of a stretch, each in another blocker's shadow
int spanCount;

void findSpans(Stretch s, float near) {
    vec2 range = s.range;
    spanCount = 0;
    NO_UNROLL for (int first = 0; first < lineCount; first += kStride)
        [[unroll]] for (int q = 0; q < kStride; ++q) {
            int w = first + q;
            if (w >= lineCount) continue;
            uint rank = owner[w];
            range = narrow(range, s, lines[w], rank, near);
            if (w + 1 == lineCount || owner[w + 1] != rank) { // all lines of this blocker seen
                if (rank != s.rank && range.x < range.y) spans[spanCount++] = range;
                range = s.range;
            }
        }
}

const int kSegmentCap = 48;
vec4 segments[kSegmentCap]; // both ends
int segmentCount;

// Lists those parts of a stretch that its spans cover, or leave free, from `t` on. How far it came: to the end, unless
// there is no more room. Loops ask at their foot, as what an invocation takes out of one that others go on with may be
// lost (docs/form-factors.md).
float sweep(Stretch s, float t, bool covered, bool wanted) {
    bool more = wanted;
    [[dont_unroll]] do {
        float reach = t, next = s.range.y;
        NO_UNROLL for (int first = 0; first < spanCount; first += kStride)
            [[unroll]] for (int q = 0; q < kStride; ++q) {
                if (first + q >= spanCount) continue;
                vec2 span = spans[first + q];
                if (span.x <= t) reach = max(reach, span.y);
                if (span.x > t) next = min(next, span.x);
            }
        bool inShadow = reach > t;
        float end = min(inShadow ? reach : next, s.range.y);
        more = more && t < s.range.y && segmentCount < kSegmentCap;
        if (more && inShadow == covered) segments[segmentCount++] = vec4(s.from + t * s.along, s.from + end * s.along);
        t = more ? end : t;
        more = more && t < s.range.y && segmentCount < kSegmentCap;
    } while (subgroupAny(more));
    return t;
}

// Twice pi times the form factor of the union of the listed shadows within the piece.
float shadowSum(Frame f, vec3 point, vec3 normal, float size) {
    float sum = 0.0, near = nearness(f, point, size), t = -kHuge; // along border number k
    vec3 apex = lift(f, piece[0]) - point;
    listBorders(size, near);
    int k = 0;
    [[dont_unroll]] do {
        segmentCount = 0;
        bool more = k < borderCount;
        [[dont_unroll]] do {
            int border = max(0, min(k, borderCount - 1));
            Stretch s = stretchAt(borders[border], size);
            s.range = ranges[border];
            findSpans(s, near);
            float reached = sweep(s, max(t, s.range.x), s.rank == kPiece, more);
            bool done = more && reached >= s.range.y;
            t = !more ? t : done ? -kHuge : reached;
            k += done ? 1 : 0;
            more = more && k < borderCount && segmentCount < kSegmentCap;
        } while (subgroupAny(more));
        int m = 0;
        [[dont_unroll]] do {
            vec4 ends = segments[min(m, kSegmentCap - 1)];
            vec3 from = lift(f, ends.xy) - point, to = lift(f, ends.zw) - point;
            float triangle = lambertTriangle(apex, from, to, normal);
            if (m < segmentCount) sum += triangle;
            ++m;
        } while (subgroupAny(m < segmentCount));
    } while (subgroupAny(k < borderCount));
    return sum;
}

// Twice pi times the form factor from a point to the whole piece.
float wholeSum(Frame f, vec3 point, vec3 normal) {
    float whole = 0.0;
    vec3 a = lift(f, piece[pieceCorners - 1]) - point;
    NO_UNROLL for (int k = 0; k < pieceCorners; ++k) {
        vec3 b = lift(f, piece[k]) - point;
        whole -= lambertEdge(a, b, normal); // clockwise seen from the point
        a = b;
    }
    return whole;
}

// Form factor from a point to what is lit of the piece behind the listed shadows.
float litFactor(Frame f, vec3 point, vec3 normal, float size) {
    float whole = wholeSum(f, point, normal), shadow = 0.0;
    NO_UNROLL for (bool once = lineCount > 0; once; once = false) shadow = shadowSum(f, point, normal, size);
    float lit = whole - shadow;
    return lit > kLeft * whole ? kInverseTwoPi * lit : 0.0;
}
#endif
