#ifdef __cplusplus
#pragma once
#endif
#include "shaders/io/io.h"
IO_BEGIN
const uint kMonteCarloGroup = 64u;
const uint kMonteCarloTile = 64u;
// A patch that sends rays takes three texels (uvec4; floats by their bits), its parts three each:
//   patch: normal.xyz, first part | tangent.xyz, count of parts | room, -, -, -
//   part:  corner.xyz, share of the area up to and with it | edge.xyz, - | other edge.xyz, -
// A count holds two numbers of hits, of either half of the rays: low and high 16 bits.
struct MonteCarloParams {
    uint patchCount;
    uint firstRow; // of the bound window of counts
    uint rowCount;
    uint firstRay; // of the first group along y; of all rays, the second half of which counts in the high bits
    uint rays;     // of each invocation
    uint halfRays; // in the table of points
    uint keptBits; // of the direction's coordinates that all patches share
    uint nodeCount;
    float flatness; // metres
};
struct MonteCarloCombineParams {
    uint patchCount;
    uint firstRow; // of the first bound window
    uint rowEnd;
    uint firstColumn; // of the second
    uint columnEnd;
    uint tileRow; // of the first group
    uint tileColumn;
    float inverseRays;
};
IO_END
