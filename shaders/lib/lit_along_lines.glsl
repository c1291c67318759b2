// How much of a convex polygon is seen from a point past a crowd of convex blockers, along lines across it, jittered.
// Strips are about equally wide as the point sees them, and so are the bits of a line: of a wall before which it stands
// nearly all that it sees lies about its foot. Exact borders (visible_polygon.glsl) cost the square of the shadows'
// lines, this one walk along the blockers. Needs visible_polygon.glsl (the piece and its frame), hidden_stretches.glsl
// and the buffer `lists`.
#ifndef LIT_ALONG_LINES_GLSL
#define LIT_ALONG_LINES_GLSL
#include "shaders/lib/constants.glsl"

// Places on a straight line that a point sees, by the tangent of half the angle from where the line is nearest to it.
struct Angles {
    vec4 start, distance; // of the first place from there; of the line
    vec4 first, range;    // of the tangent
};

vec4 tangentOf(vec4 place, vec4 distance) { return place / (distance + sqrt(distance * distance + place * place)); }

// Lines nearer than this part of what is seen count as so near, or float32 would know nothing of the far end; from
// places that the point sees under less than kSmall, all are alike.
const float kNearest = 1e-4, kSmall = 1e-3;

Angles anglesOf(vec4 start, vec4 reach, vec4 distance) {
    distance = max(max(distance, kNearest * max(abs(start), abs(start + reach))), vec4(kTiny));
    vec4 first = tangentOf(start, distance), range = tangentOf(start + reach, distance) - first;
    bvec4 small = lessThan(range, vec4(kSmall));
    start = mix(start, vec4(0.0), small);
    distance = mix(distance, max(reach / kSmall, vec4(kTiny)), small);
    first = tangentOf(start, distance);
    return Angles(start, distance, first, max(tangentOf(start + reach, distance) - first, vec4(kTiny)));
}

// From 0 to 1 in steps that look even.
vec4 evenly(Angles s, vec4 along) { return (tangentOf(s.start + along, s.distance) - s.first) / s.range; }

// And back: how far from the start, and how much farther for a little more.
vec4 alongOf(Angles s, vec4 even, out vec4 growth) {
    vec4 tangent = s.first + even * s.range, rest = 1.0 - tangent * tangent;
    growth = 2.0 * s.distance * s.range * (1.0 + tangent * tangent) / (rest * rest);
    return 2.0 * s.distance * tangent / rest - s.start;
}

// Both ends of four lines, in the piece's plane.
struct Chords {
    vec4 fromX, fromY, toX, toY;
};

// Along the piece's greatest extent: seldom parallel to the edges of walls and of what stands before them.
vec2 longest() {
    vec2 best = vec2(0.0);
    NO_UNROLL for (int k = 0; k < pieceCorners; ++k)
        NO_UNROLL for (int m = 0; m < k; ++m) {
            vec2 d = piece[k] - piece[m];
            best = dot(d, d) > dot(best, best) ? d : best;
        }
    return best / max(length(best), kTiny);
}

// At these heights across `along`.
Chords chordsAt(vec2 along, vec4 height) {
    vec2 across = vec2(-along.y, along.x), a = piece[pieceCorners - 1];
    vec4 from = vec4(kHuge), to = vec4(-kHuge);
    NO_UNROLL for (int k = 0; k < pieceCorners; ++k) {
        vec2 b = piece[k];
        vec4 ha = dot(across, a) - height, hb = dot(across, b) - height;
        bvec4 crosses = notEqual(lessThan(ha, vec4(0.0)), lessThan(hb, vec4(0.0)));
        vec4 at = dot(along, a) + ha / (ha - hb) * dot(along, b - a);
        from = mix(from, min(from, at), crosses);
        to = mix(to, max(to, at), crosses);
        a = b;
    }
    to = max(to, from);
    return Chords(from * along.x + height * across.x, from * along.y + height * across.y,
                  to * along.x + height * across.x, to * along.y + height * across.y);
}

void narrowBy(inout Stretches s, Frame f, Chords c, vec3 normal, float offset) {
    float u = dot(normal, f.u), v = dot(normal, f.v);
    narrow(s, u * c.fromX + v * c.fromY + offset, u * c.toX + v * c.toY + offset);
}

// What any of the listed blockers hides of the lines from a point. Four corners a turn, whosever they are: turns are
// few on some devices (loop_limit.glsl).
uvec4 hiddenOf(Frame f, Origin o, vec3 point, uint listed, Chords c, vec4 chord, Angles looks, vec4 jitter) {
    uvec4 hidden = uvec4(0u);
    vec3 toFrame = f.origin - point, k0 = vec3(0.0);
    Face blocker;
    Stretches s;
    float sense = 0.0;
    bool edgeOn = false;
    uint m = 0u, corner = 0u;
    [[dont_unroll]] do {
        if (corner == 0u) {
            blocker = faceAt(blockerAt(m));
            k0 = cornerFrom(o, blocker.first + blocker.count - 1u) - point;
            float height = dot(blocker.normal, k0);
            edgeOn = abs(height) <= kFlat * length(k0) || sightOf(blocker) * height > 0.0;
            sense = height > 0.0 ? 1.0 : -1.0;
            s = Stretches(vec4(0.0), vec4(1.0));
            narrowBy(s, f, c, sense * blocker.normal, sense * (dot(blocker.normal, toFrame) - height));
        }
        [[unroll]] for (uint k = 0u; k < 4u; ++k) {
            vec3 k1 = cornerFrom(o, blocker.first + min(corner + k, blocker.count - 1u)) - point;
            vec3 n = sense * cross(k0, k1);
            // Not by a corner that stands again: see exact_lines.comp.
            if (corner + k < blocker.count) narrowBy(s, f, c, n, dot(n, toFrame));
            k0 = k1;
        }
        corner += 4u;
        if (corner >= blocker.count) {
            s = Stretches(evenly(looks, s.from * chord), evenly(looks, s.to * chord));
            hidden |= edgeOn ? uvec4(0u) : bitsOf(s, jitter);
            corner = 0u;
            ++m;
        }
    } while (subgroupAny(m < listed && hidden != uvec4(~0u)));
    return hidden;
}

// The share of the piece that is seen, by what it would carry.
// `inner` is the piece's number: pairs that share a point must not err alike.
float litShareAlongLines(Frame f, Origin o, vec3 point, vec3 normal, uint inner, uint listed,
                         uint fours) {
    vec2 along = longest(), across = vec2(-along.y, along.x), range = vec2(kHuge, -kHuge), reach = range;
    NO_UNROLL for (int k = 0; k < pieceCorners; ++k) {
        float a = dot(along, piece[k]), h = dot(across, piece[k]);
        reach = vec2(min(reach.x, a), max(reach.y, a));
        range = vec2(min(range.x, h), max(range.y, h));
    }
    uint seed = hashOf(floatBitsToUint(point.x) ^
                       hashOf(floatBitsToUint(point.y) ^ hashOf(floatBitsToUint(point.z) ^ hashOf(inner))));
    vec3 away = f.origin - point;
    vec2 foot = -vec2(dot(away, f.u), dot(away, f.v));
    float lit = 0.0, all = 0.0, flat_ = dot(f.n, away), footAlong = dot(along, foot), footAcross = dot(across, foot);
    float beside = max(0.0, max(reach.x - footAlong, footAlong - reach.y));
    Angles strips = anglesOf(vec4(range.x - footAcross), vec4(range.y - range.x), vec4(length(vec2(flat_, beside))));
    float start = unitOf(hashOf(seed ^ 0x9e3779b9u));
    uint four = 0u;
    [[dont_unroll]] do {
        float u = unitOf(seed);
        seed = hashOf(seed);
        // Against one another, so that what changes linearly across the strips is exact.
        vec4 strip = 4.0 * float(four) + vec4(0.0, 1.0, 2.0, 3.0) + vec4(u, 1.0 - u, 1.0 - u, u);
        vec4 jitter = fract(start + kGolden * (4.0 * float(four) + vec4(0.0, 1.0, 2.0, 3.0)));
        vec4 wide, growth;
        vec4 height = min(range.x + alongOf(strips, strip / (4.0 * float(fours)), wide), vec4(range.y));
        Chords c = chordsAt(along, height);
        vec4 dx = c.toX - c.fromX, dy = c.toY - c.fromY, chord = sqrt(dx * dx + dy * dy), h = height - footAcross;
        Angles looks = anglesOf(c.fromX * along.x + c.fromY * along.y - footAlong, chord, sqrt(flat_ * flat_ + h * h));
        uvec4 hidden = hiddenOf(f, o, point, four < fours ? listed : 0u, c, chord, looks, jitter);
        uint bit = 0u;
        [[dont_unroll]] do { // two bits at a time
            vec4 t = alongOf(looks, vec4((float(bit) + 1.0) / 32.0), growth);
            vec4 x = c.fromX + t * along.x, y = c.fromY + t * along.y;
            vec4 px = away.x + x * f.u.x + y * f.v.x, py = away.y + x * f.u.y + y * f.v.y,
                 pz = away.z + x * f.u.z + y * f.v.z;
            vec4 r2 = px * px + py * py + pz * pz;
            vec4 w = wide * growth * max(vec4(0.0), normal.x * px + normal.y * py + normal.z * pz) * abs(flat_) /
                     max(r2 * r2, vec4(kTiny));
            if (four < fours) all += 2.0 * dot(w, vec4(1.0));
            if (four < fours) lit += dot(w, 2.0 - vec4(bitCount(hidden >> bit & 3u)));
            bit += 2u;
        } while (bit < 32u);
        ++four;
    } while (subgroupAny(four < fours));
    return all > 0.0 ? lit / all : 0.0;
}
#endif
