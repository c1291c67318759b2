#ifdef __cplusplus
#pragma once
#endif
#include "shaders/io/io.h"
IO_BEGIN
const uint kHierarchicalGroup = 64u;
const uint kHierarchicalRays = 8u;    // between two clusters
const uint kHierarchicalFewRays = 4u; // first between two triangles, then as many again as there were
const uint kHierarchicalLanes = 8u;   // share the rays of a pair that needs many: the last pairs to be settled are few
const uint kHierarchicalManyRays = 64u;   // which a pair does that has had so many
const uint kHierarchicalRoundRays = 512u; // of one invocation at once, at most
// Of a tolerance, the error over the larger end up to which a pair of triangles is kept.
const float kHierarchicalKept = 0.25f;
const uint kHierarchicalAlign = 16u; // windows of entries begin at multiples of this: 256 bytes
// A node takes five texels (uvec4; floats by their bits):
//   centre.xyz, radius | normal.xyz, area | axis U.xyz, first leaf | axis V.xyz, count of leaves | child, room,
//   farthest middle of a leaf along U and along V, in units of them
// A leaf takes three: a corner and the edges to the others; in w what of the corner float32 leaves out. Axes are as
// long as the standard deviation of area along them.
// A link says what both nodes exchange per area of either: density * (1 + a.x u + a.y v + b.x u' + b.y v'), with u, v
// the coordinates along the axes of the first node and u', v' those of the second.
struct HierarchicalLink {
    uint first;
    uint second;
    float density;
    uint firstSlope; // a and b as two halves
    uint secondSlope;
    float error;    // of the density between two of their triangles, RMS, estimated
    float unbiased; // density by rays whose number does not depend on what they met, as that of `density` does
    uint agreed;    // rays, if all of them passed; 0 where nothing can stand between, or not all did
};
// A link that something may stand in the way of, and the rays between its ends so far: sums of what they would
// carry in the open and of what passes, and of the squares of both.
struct HierarchicalDoubt {
    HierarchicalLink link; // in the open
    uint rays;
    float open;
    float passed;
    float openSquares;
    float passedSquares;
    uint roundRays; // of one invocation at once
};
// Counters.
const uint kHierarchicalLinks = 0u;
const uint kHierarchicalPairs = 1u;  // to go on with
const uint kHierarchicalLeaves = 2u; // pairs of leaves
const uint kHierarchicalDoubts = 3u;
const uint kHierarchicalLongDoubts = 4u; // that need many rays, or long ones
const uint kHierarchicalCuts = 5u;       // pairs for which no device does that ends loops so early: lib/loop_limit.glsl
const uint kHierarchicalCounters = 6u;
struct HierarchicalLinksParams {
    uint pairCount;
    uint nodeCount;  // of the hierarchy of blockers; 0: nothing can stand between
    float flatness;  // metres
    float tolerance; // of one form factor between clusters
    float visibilityTolerance;
    uint mostRays; // between two triangles
};
struct HierarchicalSweepParams {
    uint firstNode; // or patch: hierarchical_patches.comp
    uint nodeCount;
    uint columns;
    uint patchCount;
};
IO_END
