// Which of a pair's blockers may hide something of the inner piece from a cell of the outer one. Lists hold those of
// both whole pieces: behind crowds a cell sees few of them, and each of its points walks along all that are left.
// Needs visible_polygon.glsl (the piece), exact_cubature.glsl (the pair) and the buffer `lists`.
#ifndef NEAR_BLOCKERS_GLSL
#define NEAR_BLOCKERS_GLSL

// Where more are left, or the piece has more corners, all of the pair's stay; of very long lists more would be left, and
// turns of loops are few (loop_limit.glsl).
const uint kNearCap = 640u, kNearLong = 2560u;
const int kNearCorners = 4;

uint nearBlockers[kNearCap];
uint nearCount;
bool nearKnown;

uint blockerAt(uint m) {
    uint last = min(m, max(nearCount, 1u) - 1u); // again: does no harm
    return nearKnown ? nearBlockers[last] : lists[pair.r.firstListed + last];
}

// What is this far outside, over its distance, stays outside whatever float32 makes of it.
const float kSurely = 1e-5;

// No segment from the cell to the piece meets a blocker where the volume that an edge of it spans with both ends, which
// is linear in either, is negative between all corners; nor where its plane has both on one side.
void findNear(Frame f, Origin o, vec3 from[3]) {
    nearKnown = pieceCorners <= kNearCorners && pair.r.listed <= kNearLong;
    nearCount = pair.r.listed;
    if (!nearKnown) return;
    vec3 to[kNearCorners];
    [[unroll]] for (int q = 0; q < kNearCorners; ++q) to[q] = lift(f, piece[min(q, pieceCorners - 1)]);
    uint m = 0u, corner = 0u, count = 0u, index = 0u;
    bool outside = false;
    float sense = 0.0;
    Face blocker;
    vec3 k0 = vec3(0.0);
    [[dont_unroll]] do {
        if (corner == 0u) {
            index = lists[pair.r.firstListed + min(m, max(pair.r.listed, 1u) - 1u)];
            blocker = faceAt(index);
            k0 = cornerFrom(o, blocker.first + blocker.count - 1u);
            vec2 height = vec2(kHuge, -kHuge);
            [[unroll]] for (int p = 0; p < 3; ++p) {
                float h = dot(blocker.normal, from[p] - k0), slack = kSurely * length(from[p] - k0);
                height = vec2(min(height.x, h - slack), max(height.y, h + slack));
            }
            sense = height.x > 0.0 ? -1.0 : height.y < 0.0 ? 1.0 : 0.0;
            outside = sense != 0.0;
            [[unroll]] for (int q = 0; q < kNearCorners; ++q) {
                vec3 d = to[q] - k0;
                outside = outside && sense * dot(blocker.normal, d) < -kSurely * length(d);
            }
            outside = outside || sightOf(blocker) * sense > 0.0;
        }
        [[unroll]] for (uint k = 0u; k < 4u; ++k) {
            vec3 k1 = cornerFrom(o, blocker.first + min(corner + k, blocker.count - 1u));
            bool all = sense != 0.0 && corner + k < blocker.count; // no corner that stands again: see exact_lines.comp
            [[unroll]] for (int p = 0; p < 3; ++p) {
                vec3 n = sense * cross(k0 - from[p], k1 - from[p]);
                float slack = kSurely * length(n);
                [[unroll]] for (int q = 0; q < kNearCorners; ++q) {
                    vec3 d = to[q] - from[p];
                    all = all && dot(n, d) < -slack * length(d);
                }
            }
            outside = outside || all;
            k0 = k1;
        }
        corner += 4u;
        if (corner >= blocker.count) {
            if (m < pair.r.listed && !outside) {
                if (count < kNearCap) nearBlockers[count] = index;
                ++count;
            }
            corner = 0u;
            ++m;
        }
    } while (subgroupAny(m < pair.r.listed));
    nearKnown = count > 0u && count <= kNearCap;
    nearCount = count <= kNearCap ? count : pair.r.listed;
}
#endif
