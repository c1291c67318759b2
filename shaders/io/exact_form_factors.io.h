#ifdef __cplusplus
#pragma once
#endif
#include "shaders/io/io.h"
IO_BEGIN
const uint kExactGroup = 64u;
const uint kExactPieceCorners = 6u;         // most corners of a radiating piece; larger patches are cut
const uint kExactBlockerCorners = 8u;       // of a blocker
const uint kExactListed = 64u;              // blockers of one pair that one walk can name; more take a second
const float kExactOne = 1073741824.0f;      // a form factor of 1 in fixed point: sums do not depend on their order
const float kExactFraction = 2147483648.0f; // and of what is left over of one of its units
const uint kExactCarry = 2u;                // units that 2^32 of those are
const uint kExactClaimWords = 6u;           // of a patch's row: two sums of squares of 96 bits
const uint kExactCellWords = 7u;            // a cell of cubature: record, three corners in the plane of the outer piece
const uint kExactFew = 2u; // so many blockers are quickly done, when no face has more corners than these
const uint kExactFewCorners = 4u;
// More blockers than these are looked at along lines, which errs from point to point: where little may be wrong, that
// takes more cells than exact borders cost.
const uint kExactCrowd = 12u, kExactCrowdExact = 64u;
const float kExactCrowdTolerance = 1e-4f;
const uint kExactLongList = 160u; // 256 points behind more blockers are too much at once, lib/loop_limit.glsl

// Counters, one uint each. Lists and records that do not fit are counted, not written: the host asks again for fewer
// blocks.
const uint kExactOpenCount = 0u; // pairs that nothing can stand between, exact_few.comp
const uint kExactManyCount = 1u; // for exact_cells.comp; filled from the end of the same records
const uint kExactListCount = 2u;
const uint kExactCellCount = 3u;
const uint kExactClearCount = 4u;   // blocks that nothing can stand in
const uint kExactMixedCount = 5u;   // and others, filled from the end of the blocks
const uint kExactOneCount = 6u;     // pairs with one blocker, in records of their own, exact_few.comp too
const uint kExactTwoCount = 7u;     // with two; filled from their end
const uint kExactLineCount = 8u;    // far pairs of triangles with blockers, exact_lines.comp; where those with one were
const uint kExactCutCount = 9u;     // invocations whose loops the device ended early, lib/loop_limit.glsl
const uint kExactOpenManyCount = 10u; // of kExactManyCount, pairs that nothing can stand between
const uint kExactCounters = 11u;

// Faces come in this order: pieces, blockers, clusters. A cluster (uvec4) is: first piece, pieces, face of the
// rectangle that holds them, 1 where it lies in one plane.
struct ExactRecord {
    uint outer; // the piece that carries the points
    uint inner;
    uint firstListed;
    uint listed;
};

// One tile's pieces, then its clusters.
struct ExactSidesParams {
    uint pieceCount; // of the scene
    uint blockerCount;
    uint words; // of 32 blockers
    uint firstPiece;
    uint pieces;
    uint firstCluster;
    uint clusters;
    float samePlane; // a length: blockers no farther from a piece's plane, and parallel, are its own wall
};

// Two tiles, or one twice: clusters [firstA, firstA + countA) against [firstB, firstB + countB). A block is one pair of
// clusters, numbered (a - firstA) * countB + b - firstB.
struct ExactBlocksParams {
    uint pieceCount;
    uint words;
    uint piecesA; // of the tiles
    uint piecesB;
    uint firstA;
    uint countA;
    uint firstB;
    uint countB;
};

// Where F of two tiles' pieces stands, there and back: of the first entry, and from row to row.
struct ExactHalves {
    uint firstThere;
    uint strideThere;
    uint firstBack;
    uint strideBack;
};

struct ExactPairsParams {
    uint pieceCount;
    uint words;
    uint firstBlock; // in the list of blocks
    uint firstPieceA;
    uint firstPieceB;
    uint firstA;
    uint firstB;
    uint countB;
    ExactHalves halves;
    uint recordCapacity;
    uint listCapacity;
    uint byLines;    // 1: far pairs with blockers go to exact_lines.comp, near ones with one to those with two
    float tolerance; // of one form factor
};

struct ExactCellsParams {
    uint pieceCount;
    uint first; // record (first level) or cell
    uint count;
    uint next;            // where cells of the next level begin; there is room for all that can come
    uint firstLevel;      // 1: whole pairs, 0: cells
    uint maxDepthReached; // 1: do not split any more
    uint quick;           // 1: loose: look at four points of a partly hidden pair first, trust the rules in the open
    float tolerance;
};

struct ExactLinesParams {
    uint first; // record, or place in the list of those that go on
    uint count;
    uint level;      // of halvings of the outer piece
    uint last;       // 1: no pair goes on
    float tolerance; // of one form factor, RMS
};

struct ExactFinishParams {
    uint firstRecord;
    uint count;
    uint mostExact; // blockers: records with more have the square of their error, see exact_cubature.glsl; ~0 for none
    ExactHalves halves;
};
IO_END
