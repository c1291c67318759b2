#ifdef __cplusplus
#pragma once
#endif
#include "shaders/io/io.h"
IO_BEGIN
const uint kExactGroup = 64u;
const uint kExactPieceCorners = 6u;    // most corners of a radiating piece; larger patches are cut
const uint kExactBlockerCorners = 8u;  // of a blocker
const uint kExactListed = 64u;         // blockers of one pair that classification can name
const float kExactOne = 1073741824.0f; // a form factor of 1 in fixed point: sums do not depend on their order
const float kExactFraction = 4096.0f;    // and of what is left over, for 2^20 cells a pair
const uint kExactCellWords = 7u;       // a cell of cubature: record, three corners in the plane of the outer piece

// Counters, one uint each.
const uint kExactVisibleCount = 0u;
const uint kExactPartialCount = 1u; // filled from the end of the records
const uint kExactListCount = 2u;
const uint kExactCellCount = 3u;
const uint kExactOverflowCount = 4u; // of any capacity: results are less exact than claimed
const uint kExactCounters = 8u;

struct ExactRecord {
    uint outer; // the piece that carries the points
    uint inner;
    uint firstListed;
    uint listed;
};

struct ExactSidesParams {
    uint pieceCount;
    uint blockerCount;
    uint words; // of 32 blockers
};

struct ExactClassifyParams {
    uint pieceCount;
    uint words;
    uint firstRow; // where the two bound parts of the matrix begin
    uint firstColumn;
    uint stripRow; // row of the first group; columns [stripColumn, columnEnd)
    uint stripColumn;
    uint columnEnd;
    uint recordCapacity;
    uint listCapacity;
    uint closed; // 1: the pieces bound a solid, so a ray that leaves a piece first meets a front
    float tolerance; // of one form factor
};

struct ExactCellsParams {
    uint pieceCount;
    uint first; // record (first level) or cell
    uint count;
    uint cellCapacity;
    uint maxDepthReached; // 1: do not split any more
    float tolerance;
};

struct ExactFinishParams {
    uint pieceCount;
    uint firstRecord;
    uint count;
    uint firstRow;
    uint firstColumn;
};
IO_END
