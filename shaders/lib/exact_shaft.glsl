// What may stand between two convex faces: their shaft, and blockers that hide one from the other. Needs
// exact_scene.glsl. Loops end when no lane of the subgroup needs them: software devices run a loop's body once more
// than its condition holds when it is asked at the top, and what lanes that left a loop take out of it is not safe
// there.
// Shafts: E. A. Haines, J. R. Wallace, "Shaft culling for efficient ray-cast radiosity", 1991.
#ifndef EXACT_SHAFT_GLSL
#define EXACT_SHAFT_GLSL
#include "shaders/lib/constants.glsl"

// Corners of a face held in registers; shorter faces repeat their last corner.
layout(constant_id = 0) const int kCorners = 3;

vec3 ca[kCorners], cb[kCorners]; // of both faces, from the first corner of the first
vec3 wall[2 * kCorners];         // of the shaft between them, pointing inwards; zero where there is none
vec3 foot[2 * kCorners];         // a point of each
float apart[kCorners * kCorners]; // of their corners

void loadCorners(Origin o, Face a, Face b) {
    [[unroll]] for (int k = 0; k < kCorners; ++k) {
        ca[k] = cornerFrom(o, a.first + min(uint(k), a.count - 1u));
        cb[k] = cornerFrom(o, b.first + min(uint(k), b.count - 1u));
    }
}

// Lowest and highest of b over the plane of a, then of a over b's.
vec4 mutualHeights(vec3 normalA, vec3 normalB) {
    vec2 overA = vec2(kHuge, -kHuge), overB = overA;
    [[unroll]] for (int k = 0; k < kCorners; ++k) {
        float h = heightOver(normalA, cb[k] - ca[0]), g = heightOver(normalB, ca[k] - cb[0]);
        overA = vec2(min(overA.x, h), max(overA.y, h));
        overB = vec2(min(overB.x, g), max(overB.y, g));
    }
    return vec4(overA, overB);
}

// Plane through the edge e0 e1 of one face and a corner of the other, with both on its inner side: a wall of the shaft.
vec3 turned(vec3 best, vec3 edge, vec3 p, vec3 inside) {
    vec3 candidate = cross(edge, p);
    float size = length(candidate);
    bool better = size > kParallel * length(edge) * length(p) && (best == vec3(0.0) || dot(best, p) < 0.0);
    if (!better) return best;
    return (dot(candidate, inside) < 0.0 ? -candidate : candidate) / size;
}

void buildShaft() {
    vec3 ma = vec3(0.0), mb = vec3(0.0);
    [[unroll]] for (int k = 0; k < kCorners; ++k) {
        ma += ca[k] / float(kCorners);
        mb += cb[k] / float(kCorners);
    }
    [[unroll]] for (int k = 0; k < kCorners; ++k) {
        int next = (k + 1) % kCorners;
        vec3 n = vec3(0.0), m = vec3(0.0);
        [[unroll]] for (int q = 0; q < kCorners; ++q) n = turned(n, ca[next] - ca[k], cb[q] - ca[k], ma - ca[k]);
        [[unroll]] for (int q = 0; q < kCorners; ++q) m = turned(m, cb[next] - cb[k], ca[q] - cb[k], mb - cb[k]);
        [[unroll]] for (int q = 0; q < kCorners; ++q) {
            if (dot(n, cb[q] - ca[k]) < -kFlat * length(cb[q] - ca[k])) n = vec3(0.0);
            if (dot(m, ca[q] - cb[k]) < -kFlat * length(ca[q] - cb[k])) m = vec3(0.0);
        }
        wall[k] = n;
        foot[k] = ca[k];
        wall[kCorners + k] = m;
        foot[kCorners + k] = cb[k];
        [[unroll]] for (int q = 0; q < kCorners; ++q) apart[kCorners * k + q] = length(cb[q] - ca[k]);
    }
}

// How a convex blocker stands to the shaft, in one walk along its corners: x whether a wall has all of it outside, y
// whether all segments between corners of both faces cross it, so that it hides all. `sense` is +1 where the first face
// lies behind.
bvec2 standing(Origin o, uvec4 range, float sense) {
    uint outside = 0u;
    [[unroll]] for (int w = 0; w < 2 * kCorners; ++w) outside |= wall[w] != vec3(0.0) ? 1u << w : 0u;
    bool all = true;
    vec3 k0 = cornerFrom(o, range.x + range.y - 1u);
    uint c = 0u;
    [[dont_unroll]] do {
        vec3 k1 = cornerFrom(o, range.x + min(c, range.y - 1u)); // the last one again does no harm
        [[unroll]] for (int w = 0; w < 2 * kCorners; ++w) {
            vec3 d = k1 - foot[w];
            if (dot(wall[w], d) > kFlat * (abs(d.x) + abs(d.y) + abs(d.z))) outside &= ~(1u << w);
        }
        [[unroll]] for (int p = 0; p < kCorners; ++p) {
            vec3 n = sense * cross(k0 - ca[p], k1 - k0);
            float slack = -kFlat * length(n);
            [[unroll]] for (int q = 0; q < kCorners; ++q) {
                vec3 d = cb[q] - ca[p];
                all = all && dot(n, d) >= slack * apart[kCorners * p + q];
            }
        }
        k0 = k1;
        ++c;
    } while (subgroupAny(c < range.y && (outside != 0u || all)));
    return bvec2(outside != 0u, all);
}

// Of 32 blockers, those in front of both faces whose planes have the faces on different sides. From the bits of
// exact_sides.comp: x front, y back, z below, w of a solid, of which only fronts as seen from the first matter.
uint between(uvec4 a, uvec4 b) { return ~((a.x & b.x) | (a.y & b.y) | a.z | b.z | (a.w & (a.y | b.x))); }
uint wholesBetween(uvec4 a, uvec4 b) { return (a.x & ~a.y & b.y & ~b.x) | (a.y & ~a.x & b.x & ~b.y); }
#endif
