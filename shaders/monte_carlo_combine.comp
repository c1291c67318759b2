// Counts of hits become form factors, in place. A_i F_ij = A_j F_ji: both counts of a pair measure the same
// exchange, with variances in proportion to A_i and A_j, so that (c_ij + c_ji) A_j / (A_i + A_j) has the least. The
// difference between both halves of the rays, which are independent, gives the variance of each. One group, one
// tile of pairs and its mirror image.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/io/monte_carlo.io.h"

layout(local_size_x = kMonteCarloTile) in;
layout(set = 0, binding = 0) uniform samplerBuffer areas;
layout(set = 0, binding = 1, scalar) buffer Rows { uint rows[]; };       // window of rows x patchCount
layout(set = 0, binding = 2, scalar) buffer Columns { uint columns[]; }; // likewise; may be the same memory
layout(set = 0, binding = 3, scalar) buffer Spreads { vec3 spreads[]; }; // tiles x patchCount: MonteCarloSpread
layout(push_constant, scalar) uniform Push { MonteCarloCombineParams params; };

uint countOf(uint i, uint j) { return rows[(i - params.firstRow) * params.patchCount + j]; }
uint mirrorOf(uint i, uint j) { return columns[(j - params.firstColumn) * params.patchCount + i]; }

float areaOf(uint i) { return texelFetch(areas, int(i)).x; }

float hitsOf(uint count) { return float((count & 0xffffu) + (count >> 16u)); }

// Of independent rays, how far their hits scatter.
float scatterOf(float hits) { return hits * (1.0 - hits * params.inverseRays); }

// What a pair adds to the spread of a row in which its hits have `weight`.
vec3 spreadOf(uint a, uint b, float weight) {
    float da = float(a & 0xffffu) - float(a >> 16u), db = float(b & 0xffffu) - float(b >> 16u);
    float squared = weight * weight, rays = squared * (scatterOf(hitsOf(a)) + scatterOf(hitsOf(b)));
    return vec3(squared * (da * da + db * db), rays, rays * rays);
}

void main() {
    uint lane = gl_LocalInvocationIndex, n = params.patchCount;
    uint tileI = params.tileRow + gl_WorkGroupID.y, tileJ = params.tileColumn + gl_WorkGroupID.x;
    if (tileJ < tileI) return;
    uint i0 = tileI * kMonteCarloTile, j0 = tileJ * kMonteCarloTile;
    uint iEnd = min(i0 + kMonteCarloTile, params.rowEnd), jEnd = min(j0 + kMonteCarloTile, params.columnEnd);

    // Of rows i, then, beside the results, of rows j.
    uint i = i0 + lane;
    float area = i < iEnd ? areaOf(i) : 0.0;
    vec3 sum = vec3(0.0);
    if (i < iEnd) {
        [[dont_unroll]] for (uint j = max(j0, i + 1u); j < jEnd; ++j) {
            float areas_ = area + areaOf(j);
            sum += spreadOf(countOf(i, j), mirrorOf(i, j), areas_ > 0.0 ? areaOf(j) / areas_ : 0.0);
        }
        spreads[tileJ * n + i] = sum;
    }
    memoryBarrierBuffer();
    barrier();
    uint j = j0 + lane;
    area = j < jEnd ? areaOf(j) : 0.0;
    sum = vec3(0.0);
    if (j < jEnd) {
        [[dont_unroll]] for (uint k = i0; k < min(iEnd, j); ++k) {
            uint a = countOf(k, j), b = mirrorOf(k, j);
            float areas_ = area + areaOf(k), inverse = areas_ > 0.0 ? 1.0 / areas_ : 0.0;
            float hits = (hitsOf(a) + hitsOf(b)) * params.inverseRays * inverse;
            sum += spreadOf(a, b, areaOf(k) * inverse);
            rows[(k - params.firstRow) * n + j] = floatBitsToUint(hits * area);
            columns[(j - params.firstColumn) * n + k] = floatBitsToUint(hits * areaOf(k));
        }
        if (tileI != tileJ) spreads[tileI * n + j] = sum;
        // Of a tile on the diagonal, row j's other half was written above, by this lane.
        else spreads[tileI * n + j] += sum;
    }
}
