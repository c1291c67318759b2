// What of a convex polygon is visible from a point behind convex blockers, exactly: each blocker's cone of shadow is cut out of
// the polygon, in the polygon's plane; what remains are convex pieces. Needs shaders/lib/exact_scene.glsl and lambert.glsl.
#ifndef VISIBLE_POLYGON_GLSL
#define VISIBLE_POLYGON_GLSL

// Loops over private arrays: drivers that unroll them by the array's length take minutes to compile.
#define NO_UNROLL [[dont_unroll]]

const int kPieceCap = 20;  // corners of a piece
const int kPieceStack = 16; // pieces waiting

vec2 piece[kPieceCap];
int pieceCorners;
vec2 kept[kPieceCap], scratch[kPieceCap];
vec2 waiting[kPieceStack * kPieceCap];
int waitingCorners[kPieceStack];
uint waitingNext[kPieceStack];
int waitingCount;
bool piecesLost = false;

// The plane of the polygon, relative to the origin of the pair.
struct Frame {
    vec3 origin;
    vec3 u;
    vec3 v;
};

vec3 lift(Frame f, vec2 p) { return f.origin + p.x * f.u + p.y * f.v; }

// A plane through space as a line in the frame: positive inside; xy unit.
vec3 lineOf(Frame f, vec3 normal, vec3 onPlane) {
    vec3 line = vec3(dot(normal, f.u), dot(normal, f.v), dot(normal, f.origin - onPlane));
    float size = length(line.xy);
    return size > 1e-12 ? line / size : vec3(0.0, 0.0, sign(line.z) * 1e30);
}

float at(vec3 line, vec2 p) { return dot(line.xy, p) + line.z; }

// Extent of the piece across a line; rounding errors count as touching.
vec2 extent(vec3 line, float flatness) {
    vec2 range = vec2(1e30, -1e30);
    NO_UNROLL for (int k = 0; k < pieceCorners; ++k) {
        float d = at(line, piece[k]);
        range = vec2(min(range.x, d), max(range.y, d));
    }
    if (range.x >= -flatness) range.x = max(range.x, 0.0);
    if (range.y <= flatness) range.y = min(range.y, 0.0);
    return range;
}

// Keeps the side of `line` in the piece; the other side is left in `scratch`, its corner count returned.
int splitPiece(vec3 line) {
    int inside = 0, outside = 0;
    vec2 previous = piece[pieceCorners - 1];
    float dp = at(line, previous);
    NO_UNROLL for (int k = 0; k < pieceCorners; ++k) {
        vec2 p = piece[k];
        float d = at(line, p);
        if ((d >= 0.0) != (dp >= 0.0)) {
            vec2 cut = previous + dp / (dp - d) * (p - previous);
            if (outside < kPieceCap) scratch[outside++] = cut;
            if (inside < kPieceCap) kept[inside++] = cut;
        }
        if (d >= 0.0) {
            if (inside < kPieceCap) kept[inside++] = p;
        } else if (outside < kPieceCap)
            scratch[outside++] = p;
        previous = p;
        dp = d;
    }
    NO_UNROLL for (int k = 0; k < inside; ++k) piece[k] = kept[k];
    pieceCorners = inside;
    return outside;
}

Frame frameOf(Origin o, Face face) {
    vec3 a = cornerFrom(o, face.first);
    vec3 u = normalize(cornerFrom(o, face.first + 1u) - a);
    u = normalize(u - dot(u, face.normal) * face.normal);
    return Frame(a, u, cross(face.normal, u));
}

void loadPiece(Frame f, Origin o, Face face) {
    pieceCorners = int(face.count);
    NO_UNROLL for (int k = 0; k < pieceCorners; ++k) {
        vec3 d = cornerFrom(o, face.first + uint(k)) - f.origin;
        piece[k] = vec2(dot(d, f.u), dot(d, f.v));
    }
}

// Cuts the piece by a plane unless its corners only touch it.
void clipTo(Frame f, vec3 normal, vec3 onPlane) {
    bool below = false;
    NO_UNROLL for (int k = 0; k < pieceCorners; ++k)
        below = below || heightOver(normal, lift(f, piece[k]) - onPlane) < 0.0;
    if (below) splitPiece(lineOf(f, normal, onPlane));
}

void await(int corners, uint next) {
    if (corners < 3) return;
    if (waitingCount == kPieceStack) {
        piecesLost = true;
        return;
    }
    NO_UNROLL for (int k = 0; k < corners; ++k) waiting[waitingCount * kPieceCap + k] = scratch[k];
    waitingCorners[waitingCount] = corners;
    waitingNext[waitingCount++] = next;
}

float lambertPiece(Frame f, vec3 point, vec3 normal) {
    float sum = 0.0;
    vec3 a = lift(f, piece[pieceCorners - 1]) - point;
    NO_UNROLL for (int k = 0; k < pieceCorners; ++k) {
        vec3 b = lift(f, piece[k]) - point;
        sum -= lambertEdge(a, b, normal); // clockwise seen from the point
        a = b;
    }
    return sum;
}

// Wall number c of the shadow of a blocker as a line, positive inside the shadow; the last wall is the blocker's own plane.
vec3 shadowLine(Frame f, Origin o, Face blocker, vec3 point, float sense, uint c) {
    vec3 a = cornerFrom(o, blocker.first + (c < blocker.count ? c : 0u)) - point;
    vec3 b = cornerFrom(o, blocker.first + (c + 1u < blocker.count ? c + 1u : 0u)) - point;
    vec3 normal = c < blocker.count ? normalize(cross(a, b - a)) : blocker.normal;
    return lineOf(f, sense * normal, point + a);
}

// Cuts the shadow of one blocker out of the piece; what is left over beside it waits. False when nothing remains in `piece`.
bool cutShadow(Frame f, Origin o, Face blocker, vec3 point, uint next, float size) {
    vec3 k0 = cornerFrom(o, blocker.first) - point;
    float side = -dot(blocker.normal, k0);
    if (abs(side) <= kFlat * length(k0)) return true;
    float sense = side > 0.0 ? -1.0 : 1.0;
    // First see whether a wall of the shadow has all of the piece outside: most often. The blocker's own plane is the cheapest.
    uint needed = 0u;
    NO_UNROLL for (int c = int(blocker.count); c >= 0; --c) {
        vec2 range = extent(shadowLine(f, o, blocker, point, sense, uint(c)), 2e-7 * size);
        if (range.y <= 0.0) return true;
        if (range.x < 0.0) needed |= 1u << c;
    }
    NO_UNROLL while (needed != 0u && pieceCorners >= 3) {
        uint c = findLSB(needed);
        needed &= needed - 1u;
        await(splitPiece(shadowLine(f, o, blocker, point, sense, c)), next);
    }
    return false;
}
#endif
