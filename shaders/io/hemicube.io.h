#ifdef __cplusplus
#pragma once
#endif
#include "shaders/io/io.h"
IO_BEGIN
const uint kHemicubeGroup = 128u;
const uint kHemicubeSizes = 4u;    // classes of triangles by the pixels that they cover
const uint kHemicubeSegment = 32u; // pixels of a line that a lane sums at a time
const uint kHemicubeAnyRoom = 0xffffffffu;
const uint kHemicubeNoPatch = 0xffffffffu;
// Sums of delta form factors are kept in fixed point, so that their order does not matter: 1 is 2^31.
const uint kHemicubeOneBits = 31u;
const uint kHemicubeBack = 1u; // flag of an item's id, which is twice the patch
// A triangle and a viewpoint take three texels each (uvec4; floats by their bits):
//   triangle:  a.xyz, patch | b.xyz, room | c.xyz, -
//   viewpoint: position.xyz, own patch or kHemicubeNoPatch | normal.xyz, room or kHemicubeAnyRoom | tangent.xyz, -
struct HemicubeParams {
    uint firstViewpoint; // of the first workgroup
    uint pointsPerRow;   // successive viewpoints that share a row
    uint viewpointInRow; // the first workgroup's viewpoint, counted from the first row bound
    uint stripeBits;     // lanes that share a triangle of the largest class are two to this
    uint triangleCount;
    uint patchCount;  // columns of `factors`
    uint resolution;  // R, even: the top has R x R pixels, each side R x R/2
    uint idBits;      // low bits of an item: patch * 2 + seen from behind
    float depthScale; // items per metre of depth
    float flatness;   // metres: a patch nearer than this to holding the viewpoint in its plane is not seen
    uint listLength;  // of a viewpoint: 10 for each triangle
    uint frontsOnly;  // 1: whoever looks from a patch meets fronts before backs, which need not be drawn
};
IO_END
