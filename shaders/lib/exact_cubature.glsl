// Cubature over one cell of a pair: Lambert's formula of what is visible from seven points of the outer piece. Cells
// whose two rules disagree are split in four for the next round. The shader that includes this declares what is seen,
// from a point given in the plane of the outer piece:
//   void loadPair(uint record);        sets `pair` and, at the first level, `outer`
//   void lookFrom(vec2 a, vec2 b, vec2 c);  a cell, before the points in it
//   float seen(vec2 at);               form factor from the point to what it sees of the inner piece
//   vec3 fromInner(vec2 at);           the point, relative to a corner of the inner piece
//   float openFrom(vec2 at);           form factor in the open, or 1 where that does not matter
//   float bendDistance(vec2 at);       how far it is from where that bends: the border of the inner piece
//   float gapAt(vec2 at);              how far it is from the inner piece's plane, where both face each other straight
// and adds what each point sees, nothing, all or a part, to `views`.
// A sliver of light or shadow along an edge of the outer piece lies between all points, while every point of the inner
// piece sees it: pairs of which all points see nothing, or all see everything, are looked at from the inner piece too.
// What both looks miss is a sliver of a sliver.
// Rule: J. Radon, "Zur mechanischen Kubatur", 1948 (degree 5), with the
// degree-2 rule on four of its points. Needs shaders/io/exact_form_factors.io.h. Loops: see exact_shaft.glsl.
#ifndef EXACT_CUBATURE_GLSL
#define EXACT_CUBATURE_GLSL
#include "shaders/lib/constants.glsl"
#include "shaders/lib/loop_limit.glsl"
#include "shaders/lib/radon.glsl"

layout(local_size_x = kExactGroup) in;
layout(set = 0, binding = 5, scalar) buffer Records { ExactRecord records[]; };
layout(set = 0, binding = 6, scalar) readonly buffer Lists { uint lists[]; };
layout(set = 0, binding = 7, scalar) readonly buffer Cells { uint cells[]; };
layout(set = 0, binding = 8, scalar) buffer Counters { uint counters[]; };
layout(set = 0, binding = 9, scalar) buffer Sums { uvec4 sums[]; }; // per record: form factor, error (crowded(): its square), with fractions
layout(set = 0, binding = 10, scalar) writeonly buffer NextCells { uint nextCells[]; };
layout(push_constant, scalar) uniform Push { ExactCellsParams params; };

const int kOuterCap = int(kExactPieceCorners) + 2; // one more corner for each of two cuts

struct Pair {
    uint record;
    ExactRecord r;
    float outerArea;
    float innerArea;
    float innerSize; // farthest corner from the first
    float worst;     // the larger of both form factors over that of the outer piece
};
Pair pair;
vec2 outer[kOuterCap]; // what of the outer piece lies above the inner one's plane
int outerCorners;
bool wholePair; // a first look, from either side, not a cell
const uint kSeesNothing = 1u, kSeesAll = 2u, kSeesPart = 4u;
uint views;
float demand; // of the cell: the most that it may exchange over what it may err

const float kStraight = 0.95; // cosine between both normals, from which pieces face each other straight
const float kInPlane = 1e-6; // of both pieces' sizes: edges nearer to the outer one's plane lie in it

void loadPair(uint record);
void lookFrom(vec2 a, vec2 b, vec2 c);
float seen(vec2 at);
vec3 fromInner(vec2 at);
float openFrom(vec2 at);
float bendDistance(vec2 at);
float gapAt(vec2 at);

// From which side of it a blocker hides: +1 the front, -1 the back, 0 either. Of solids what the first piece of the pair
// sees as fronts was listed (exact_shaft.glsl); their other faces hide nothing more, and of sheets are in the same place,
// where rounding would count borders of both shadows twice, or not at all.
float sightOf(Face blocker) { return blocker.more == 0u ? 0.0 : pair.r.outer < pair.r.inner ? 1.0 : -1.0; }

// Cells of such pairs err each by itself: squares of their errors add up.
bool crowded() {
    return pair.r.listed > (params.tolerance < kExactCrowdTolerance ? kExactCrowdExact : kExactCrowd);
}

// In the open the rule of degree 5 errs much less: by 20 in rooms; where slivers cross, less than 4.
const float kSmooth = 0.25;
// Of seven independent points: error of their sum over the root of the squares that a plane through them leaves, which
// has four degrees of freedom. Of four, over what differs between them.
const float kNoise = 0.19, kQuickNoise = 0.25;
const float kProbe = 0.02, kBeyond = 0.05; // weight of a corner's two lesser neighbours; area that a corner stands for
// Behind more blockers one triangle of a piece is enough for an invocation, else two: loop_limit.glsl.
const uint kOneTriangle = 40u;
const uint kWholePair = 0xffffffffu; // in the place of a cell's first corner

// The root of the sum of squares that a plane through the seven points leaves.
float restOfPlane(vec3 far, vec3 near, float centre) {
    const float squares = kRadonFarOut * kRadonFarOut + kRadonNearOut * kRadonNearOut; // along each corner
    float mean = (dot(far + near, vec3(1.0)) + centre) / 7.0;
    vec3 slope = (kRadonFarOut * far + kRadonNearOut * near) / squares;
    slope -= dot(slope, vec3(1.0)) / 3.0;
    far -= mean, near -= mean, centre -= mean;
    return sqrt(max(dot(far, far) + dot(near, near) + centre * centre - squares * dot(slope, slope), 0.0));
}

// x by the rule of degree 5, y how far the farther of two rules of degree 2 is from it.
// A quick look takes the centre and the far three alone. With `probed`, three more points near the corners, of which
// some lie beyond any straight border of light that crosses the cell: how far they are from what the others lead to
// expect.
vec2 overCell(vec2 a, vec2 b, vec2 c, bool quick, bool probed) {
    // Two rules of degree 2 within it: shadows make one of them agree by accident, seldom both.
    vec3 sums = vec3(0.0);
    vec2 range = vec2(kHuge, 0.0);
    // One call, so that drivers that inline everything compile it once.
    int points = quick ? 4 : 7, all = points + (probed ? 3 : 0), k = 0;
    views = 0u;
    lookFrom(a, b, c);
    vec3 far = vec3(0.0), near = vec3(0.0);
    float beyond = 0.0;
    [[dont_unroll]] do {
        uint viewsBefore = views;
        bool probe = k >= points;
        int turn = probe ? k - points : k % 4;
        vec2 corner = turn == 0 ? a : turn == 1 ? b : c;
        float t = probe ? kProbe : k == 3 ? 1.0 / 3.0 : k < 3 ? kRadonFar : kRadonNear;
        float f = 0.0;
        if (k < all) f = seen(t * (a + b + c) + (1.0 - 3.0 * t) * corner); // the others' turns: loop_limit.glsl
        if (k < points) sums += k < 3 ? vec3(0.0, f, 0.0) : k > 3 ? vec3(f, 0.0, 0.0) : vec3(0.0, 0.0, f);
        if (k < points) range = vec2(min(range.x, f), max(range.y, f));
        if (k < 3) far[k] = f;
        if (k > 3 && k < points) near[k - 4] = f;
        float nearest = turn == 0 ? far.x : turn == 1 ? far.y : far.z;
        float expected = mix(sums.z, nearest, (1.0 - 3.0 * kProbe) / (1.0 - 3.0 * kRadonFar));
        if (probe && k < all) beyond += kBeyond * abs(f - max(0.0, expected));
        if (k >= points) views = viewsBefore; // neighbours may need more points
        ++k;
    } while (subgroupAny(k < all));
    float centre = sums.z;
    float byFar = kRadonFarLow / 3.0 * sums.y + (1.0 - kRadonFarLow) * centre;
    if (quick) {
        float least = (crowded() ? kQuickNoise : kLeastError) * (range.y - range.x);
        return vec2(byFar, max(beyond, max(kQuickError * abs(byFar - centre), least)));
    }
    float value = kRadonNearWeight * sums.x + kRadonFarWeight * sums.y + kRadonCentreWeight * centre;
    float byNear = kRadonNearLow / 3.0 * sums.x + (1.0 - kRadonNearLow) * centre;
    float apart = max(abs(value - byNear), abs(value - byFar));
    // Errors of a crowd's points are as good as independent.
    if (crowded()) return vec2(value, kNoise * restOfPlane(far, near, centre));
    return vec2(value, max(beyond, pair.r.listed == 0u && params.quick != 0u ? kSmooth * apart : apart));
}

float crossOf(vec2 a, vec2 b) { return a.x * b.y - a.y * b.x; }

void storeCell(uint slot, vec2 a, vec2 b, vec2 c) {
    uint w = slot * kExactCellWords;
    nextCells[w] = pair.record;
    nextCells[w + 1u] = floatBitsToUint(a.x);
    nextCells[w + 2u] = floatBitsToUint(a.y);
    nextCells[w + 3u] = floatBitsToUint(b.x);
    nextCells[w + 4u] = floatBitsToUint(b.y);
    nextCells[w + 5u] = floatBitsToUint(c.x);
    nextCells[w + 6u] = floatBitsToUint(c.y);
}

const float kAbout = 3.0; // what is seen from a cell over what its middle sees

// At most the form factor in the open from about a point.
float mostFrom(vec2 at) {
    vec3 d = fromInner(at);
    float byDistance =
        pair.innerArea * kInversePi / max(dot(d, d) - pair.innerSize * pair.innerSize, kTiny);
    return min(min(1.0, kAbout * openFrom(at)), byDistance);
}

// Cells so large that two agreeing rules prove nothing: a bend or a shadow could hide between the points.
const float kShadowShare = 250.0, kQuickShadowShare = 1000.0, kBendShare = 6.0;
// A cell's longest edge over its middle's distance from the bend, from where it bends. Long cells that meet the bend at
// their tip have 1.5, a little less where a gap is between.
const float kBendReach = 1.4;

// Between pieces that nearly touch, what is seen falls past the border of the inner one within about their distance:
// of larger cells all points see everything or nothing. What such a cell may have missed.
const float kGapSeen = 0.1, kPastBorder = 0.75;
float missedAtBorder(vec2 middle, float share) {
    float gap = gapAt(middle), across = sqrt(share * pair.outerArea);
    return gap < kGapSeen * across ? kPastBorder * share * gap / across : 0.0;
}

// Puts cells on the list of the next round: this one again, or its four quarters.
void refine(vec2 a, vec2 b, vec2 c, bool quarters) {
    uint count = quarters ? 4u : 1u;
    uint slot = params.next + atomicAdd(counters[kExactCellCount], count);
    vec2 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
    uint k = 0u;
    [[dont_unroll]] do {
        vec2 p = quarters ? k == 0u ? a : k == 1u ? b : k == 2u ? c : bc : a;
        vec2 q = quarters ? k == 0u ? ab : k == 1u ? bc : ca : b;
        vec2 r = quarters ? k == 0u ? ca : k == 1u ? ab : k == 2u ? bc : ab : c;
        if (k < count) storeCell(slot + k, p, q, r);
        ++k;
    } while (subgroupAny(k < count));
}

// The next round looks at the pair from its other piece.
void turn() {
    records[pair.record].outer = pair.r.inner;
    records[pair.record].inner = pair.r.outer;
    uint slot = params.next + atomicAdd(counters[kExactCellCount], 1u);
    nextCells[slot * kExactCellWords] = pair.record;
    nextCells[slot * kExactCellWords + 1u] = kWholePair;
}

// x the contribution to the form factor, y its error; zero when the cell was split. With `mayTurn`, `turned` says that
// all points agree and prove too little.
vec2 integrate(vec2 a, vec2 b, vec2 c, bool mayTurn, out bool turned) {
    float share = 0.5 * abs(crossOf(b - a, c - a)) / pair.outerArea;
    bool mayBeSplit = params.maxDepthReached == 0u && share > 0.0;
    vec2 middle = (a + b + c) / 3.0;
    bool bent = max(length(b - a), max(length(c - b), length(a - c))) > kBendReach * bendDistance(middle);
    float most = pair.worst * (bent ? 1.0 : mostFrom(middle)),
          shadows = params.quick != 0u ? kQuickShadowShare : kShadowShare;
    demand = most * sqrt(share) / params.tolerance;
    float enough = bent ? kBendShare : pair.r.listed > 0u ? shadows : kHuge;
    bool split = mayBeSplit && share * most > enough * params.tolerance, again = false;
    bool quick = wholePair && pair.r.listed > 0u && (params.quick != 0u || split);
    vec2 result = vec2(0.0);
    mayTurn = mayTurn && mayBeSplit && !bent && most * kMissed > params.tolerance;
    turned = false;
    if (mayTurn || !split && share > 0.0) {
        // At small tolerances cells are so small that probes cost more than they find. A border of the other piece
        // along a row of bent cells, or across a needle's, may pass all their points alike.
        float hiding = bent ? share * most : pair.r.listed > 0u ? sqrt(share) * most * kMissed : 0.0;
        bool probed = params.quick != 0u && !crowded() && hiding > params.tolerance;
        result = share * overCell(a, b, c, quick, probed);
        if (bent) result.y += missedAtBorder(middle, share);
        turned = mayTurn && (views == kSeesNothing || views == kSeesAll);
        // Errors of many small cells add up: the smaller the cell, the less it may add.
        bool bad = mayBeSplit && result.y * pair.worst > params.tolerance * sqrt(share);
        again = !split && bad && quick; // all seven points in the next round
        split = split || bad && !quick;
    }
    if (turned) return vec2(0.0);
    bool later = split || again;
    if (later) refine(a, b, c, split);
    return later ? vec2(0.0) : result;
}

// The carry of a fraction that comes round: the sum of both is the same in whatever order cells finish.
uint carryOf(uint before, uint added) { return before > ~0u - added ? kExactCarry : 0u; }

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    index += params.first;
    uint w = index * kExactCellWords;
    bool first = params.firstLevel != 0u;
    wholePair = first || cells[w + 1u] == kWholePair;
    loadPair(first ? index : cells[w]);
    if (!wholePair) {
        outerCorners = outerCorners == 0 ? 0 : 3;
        [[unroll]] for (uint k = 0u; k < 3u; ++k)
            outer[k] = vec2(uintBitsToFloat(cells[w + 1u + 2u * k]), uintBitsToFloat(cells[w + 2u + 2u * k]));
    }
    vec2 sum = vec2(0.0);
    int k = 1;
    [[dont_unroll]] do {
        bool turned = false;
        bool there = k + 1 < outerCorners;
        bool later = pair.r.listed > kExactFew && k > (pair.r.listed > kOneTriangle ? 1 : 2);
        if (there && later) refine(outer[0], outer[k], outer[k + 1], false);
        if (there && !later) {
            vec2 part = integrate(outer[0], outer[k], outer[k + 1], k == 1 && first && pair.r.listed > 0u, turned);
            sum += vec2(part.x, crowded() ? part.y * part.y : part.y);
        }
        if (turned) turn();
        if (turned) outerCorners = 0; // no more from here
        ++k;
    } while (subgroupAny(k + 1 < outerCorners));
    uvec4 fixed_ = uvec4(fixedOf(sum.x), fixedOf(min(sum.y, 1.0)));
    if (first) sums[pair.record] = fixed_; // the first of this record
    if (!first && fixed_ != uvec4(0u)) {
        uint carry = carryOf(atomicAdd(sums[pair.record].y, fixed_.y), fixed_.y);
        uint errorCarry = carryOf(atomicAdd(sums[pair.record].w, fixed_.w), fixed_.w);
        atomicAdd(sums[pair.record].x, fixed_.x + carry);
        atomicAdd(sums[pair.record].z, fixed_.z + errorCarry);
    }
    if (cutShort(2u + min(params.pieceCount, 2u))) atomicAdd(counters[kExactCutCount], 1u);
}
#endif
