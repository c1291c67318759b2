// Cubature over one cell of a pair: Lambert's formula of what is visible from seven points of the outer piece. Cells whose two
// rules disagree are split in four for the next round.
// Rule: J. Radon, "Zur mechanischen Kubatur", 1948 (degree 5), with the degree-2 rule on four of its points.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/io/exact_form_factors.io.h"
#include "shaders/lib/lambert.glsl"
#include "shaders/lib/exact_scene.glsl"
#include "shaders/lib/visible_polygon.glsl"

layout(local_size_x = kExactGroup) in;
layout(set = 0, binding = 5, scalar) readonly buffer Records { ExactRecord records[]; };
layout(set = 0, binding = 6, scalar) readonly buffer Lists { uint lists[]; };
layout(set = 0, binding = 7, scalar) readonly buffer Cells { uint cells[]; };
layout(set = 0, binding = 8, scalar) buffer Counters { uint counters[]; };
layout(set = 0, binding = 9, scalar) buffer Sums { uint sums[]; }; // per record: form factor, its fraction, error
layout(set = 0, binding = 10, scalar) writeonly buffer NextCells { uint nextCells[]; };
layout(push_constant, scalar) uniform Push { ExactCellsParams params; };
layout(constant_id = 0) const bool kFirstLevel = true; // whole pairs instead of cells

vec2 outer[kPieceCap]; // the outer piece above the inner one's plane; `piece` is the inner above the outer one's
int outerCorners;
float innerSize;

struct Pair {
    uint record;
    ExactRecord r;
    Face outer;
    Frame outerFrame;
    Frame innerFrame;
    Origin origin;
    float innerArea;
    float size; // of the outer piece
    float worst; // the larger of both form factors over that of the outer piece
};

Pair loadPair(uint record) {
    Pair pair;
    pair.record = record;
    pair.r = records[record];
    pair.outer = faceAt(pair.r.outer);
    Face face = faceAt(pair.r.inner);
    pair.origin = originAt(pair.outer.first);
    pair.outerFrame = frameOf(pair.origin, pair.outer);
    pair.innerFrame = frameOf(pair.origin, face);
    pair.worst = max(1.0, pair.outer.area / face.area);
    pair.innerArea = face.area;
    pair.size = sqrt(pair.outer.area);
    NO_UNROLL for (bool once = kFirstLevel; once; once = false) {
        loadPiece(pair.outerFrame, pair.origin, pair.outer);
        clipTo(pair.outerFrame, face.normal, cornerFrom(pair.origin, face.first));
        outerCorners = pieceCorners;
        NO_UNROLL for (int k = 0; k < pieceCorners; ++k) outer[k] = piece[k];
    }
    loadPiece(pair.innerFrame, pair.origin, face);
    clipTo(pair.innerFrame, pair.outer.normal, cornerFrom(pair.origin, pair.outer.first));
    innerSize = pieceSize();
    return pair;
}

// Form factor from a point of the outer piece to what it sees of the inner one.
float seen(Pair pair, vec2 at2) {
    vec3 point = lift(pair.outerFrame, at2);
    lineCount = 0;
    bool hidden = false;
    NO_UNROLL for (uint m = 0u; m < pair.r.listed && !hidden; ++m)
        hidden = castShadow(pair.innerFrame, pair.origin, faceAt(lists[pair.r.firstListed + m]), point, m, innerSize);
    float factor = 0.0;
    NO_UNROLL for (bool once = !hidden; once; once = false)
        factor = litFactor(pair.innerFrame, point, pair.outer.normal, innerSize);
    return max(0.0, factor);
}

const float kQuickError = 2.0; // four points agree by accident more often than seven

// x by the rule of degree 5, y how far the farther of two rules of degree 2 is from it.
// A quick look takes the centre and the far three alone.
vec2 overCell(Pair pair, vec2 a, vec2 b, vec2 c, bool quick) {
    // Barycentric weight of the two lesser corners. Three points at (1 - 2 t, t, t) and the centre integrate quadratics when
    // the three weigh 1/4 / (1 - 3 t)^2 together; shadows make one such rule agree by accident, seldom both.
    const float kNear = 0.470142064105, kFar = 0.101286507323;
    const float kFarLow = 0.25 / ((1.0 - 3.0 * kFar) * (1.0 - 3.0 * kFar));
    const float kNearLow = 0.25 / ((1.0 - 3.0 * kNear) * (1.0 - 3.0 * kNear));
    vec3 sums = vec3(0.0);
    // One call, so that drivers that inline everything compile it once.
    int points = quick ? 4 : 7;
    NO_UNROLL for (int k = 0; k < points; ++k) {
        int turn = k % 4;
        vec2 corner = turn == 0 ? a : turn == 1 ? b : c;
        float t = k == 3 ? 1.0 / 3.0 : k < 3 ? kFar : kNear;
        float f = seen(pair, t * (a + b + c) + (1.0 - 3.0 * t) * corner);
        sums += k < 3 ? vec3(0.0, f, 0.0) : k > 3 ? vec3(f, 0.0, 0.0) : vec3(0.0, 0.0, f);
    }
    float centre = sums.z;
    float byFar = kFarLow / 3.0 * sums.y + (1.0 - kFarLow) * centre;
    if (quick) return vec2(byFar, kQuickError * abs(byFar - centre));
    float value = 0.132394152788 * sums.x + 0.125939180545 * sums.y + 0.225 * centre;
    float byNear = kNearLow / 3.0 * sums.x + (1.0 - kNearLow) * centre;
    return vec2(value, max(abs(value - byNear), abs(value - byFar)));
}

float crossOf(vec2 a, vec2 b) { return a.x * b.y - a.y * b.x; }

void storeCell(uint slot, uint record, vec2 a, vec2 b, vec2 c) {
    uint w = slot * kExactCellWords;
    nextCells[w] = record;
    nextCells[w + 1u] = floatBitsToUint(a.x);
    nextCells[w + 2u] = floatBitsToUint(a.y);
    nextCells[w + 3u] = floatBitsToUint(b.x);
    nextCells[w + 4u] = floatBitsToUint(b.y);
    nextCells[w + 5u] = floatBitsToUint(c.x);
    nextCells[w + 6u] = floatBitsToUint(c.y);
}

float segmentDistance(vec3 p, vec3 a, vec3 b) {
    vec3 ab = b - a;
    float length2 = dot(ab, ab);
    return length(p - a - (length2 > 0.0 ? clamp(dot(p - a, ab) / length2, 0.0, 1.0) : 0.0) * ab);
}

// How far a point of the outer piece is from where the integrand bends: the border of the inner piece. An edge in the outer
// piece's own plane bends it only at its ends.
float bendDistance(Pair pair, vec3 point) {
    float nearest = 1e30;
    vec3 a = lift(pair.innerFrame, piece[pieceCorners - 1]);
    float flat_ = 1e-6 * (innerSize + pair.size);
    NO_UNROLL for (int k = 0; k < pieceCorners; ++k) {
        vec3 b = lift(pair.innerFrame, piece[k]);
        bool inPlane = abs(dot(pair.outer.normal, a - point)) <= flat_ && abs(dot(pair.outer.normal, b - point)) <= flat_;
        nearest = min(nearest, inPlane ? min(length(a - point), length(b - point)) : segmentDistance(point, a, b));
        a = b;
    }
    return nearest;
}

// Cells so large that two agreeing rules prove nothing: a bend or a shadow could hide between the points.
const float kShadowShare = 250.0;
bool tooLarge(Pair pair, vec2 a, vec2 b, vec2 c, float share) {
    vec3 middle = lift(pair.outerFrame, (a + b + c) / 3.0);
    float size = max(length(b - a), max(length(c - b), length(a - c)));
    if (size > 1.5 * bendDistance(pair, middle)) return share * pair.worst > 6.0 * params.tolerance;
    vec3 d = lift(pair.innerFrame, vec2(0.0)) - middle;
    float most = min(1.0, pair.innerArea * 0.318309886184 / max(dot(d, d) - innerSize * innerSize, 1e-30));
    return pair.r.listed > 0u && share * pair.worst * most > kShadowShare * params.tolerance;
}

// x the contribution to the form factor, y its error; zero when the cell was split.
vec2 integrate(Pair pair, vec2 a, vec2 b, vec2 c) {
    float share = 0.5 * abs(crossOf(b - a, c - a)) / pair.outer.area;
    if (share == 0.0) return vec2(0.0);
    bool mayBeSplit = params.maxDepthReached == 0u;
    bool split = mayBeSplit && tooLarge(pair, a, b, c, share);
    vec2 both = vec2(0.0);
    float error = 0.0;
    if (!split) {
        bool quick = kFirstLevel && params.quick != 0u && pair.r.listed > 0u;
        both = overCell(pair, a, b, c, quick);
        error = share * both.y;
        // Errors of many small cells add up: the smaller the cell, the less it may add.
        split = mayBeSplit && error * pair.worst > params.tolerance * sqrt(share);
        if (split && quick) { // all seven points in the next round
            uint slot = atomicAdd(counters[kExactCellCount], 1u);
            if (slot < params.cellCapacity) {
                storeCell(slot, pair.record, a, b, c);
                return vec2(0.0);
            }
            split = false;
            atomicAdd(counters[kExactOverflowCount], 1u);
        }
    }
    if (split) {
        uint slot = atomicAdd(counters[kExactCellCount], 4u);
        if (slot + 4u <= params.cellCapacity) {
            vec2 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
            storeCell(slot, pair.record, a, ab, ca);
            storeCell(slot + 1u, pair.record, ab, b, bc);
            storeCell(slot + 2u, pair.record, ca, bc, c);
            storeCell(slot + 3u, pair.record, bc, ca, ab);
            return vec2(0.0);
        }
        atomicAdd(counters[kExactOverflowCount], 1u);
        error = share;
    }
    return vec2(share * both.x, error);
}

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    index += params.first;
    vec2 sum = vec2(0.0);
    Pair pair;
    if (kFirstLevel) {
        pair = loadPair(index);
        if (pieceCorners >= 3)
            NO_UNROLL for (int k = 1; k + 1 < outerCorners; ++k)
                sum += integrate(pair, outer[0], outer[k], outer[k + 1]);
    } else {
        uint w = index * kExactCellWords;
        pair = loadPair(cells[w]);
        sum = integrate(pair, vec2(uintBitsToFloat(cells[w + 1u]), uintBitsToFloat(cells[w + 2u])),
                        vec2(uintBitsToFloat(cells[w + 3u]), uintBitsToFloat(cells[w + 4u])),
                        vec2(uintBitsToFloat(cells[w + 5u]), uintBitsToFloat(cells[w + 6u])));
    }
    if (linesLost) atomicAdd(counters[kExactOverflowCount], 1u);
    // Whole numbers: the sum is the same in whatever order the cells finish.
    // The fraction is summed apart: rounding a hundred thousand cells alike would show in the sixth digit.
    float scaled = sum.x * kExactOne;
    uint value = uint(scaled), rest = uint((scaled - float(value)) * kExactFraction);
    uint error = uint(min(sum.y, 1.0) * kExactOne);
    if (value != 0u) atomicAdd(sums[3u * pair.record], value);
    if (rest != 0u) atomicAdd(sums[3u * pair.record + 1u], rest);
    if (error != 0u) atomicAdd(sums[3u * pair.record + 2u], error);
}
