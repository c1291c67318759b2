#ifdef __cplusplus
#pragma once
#endif
#include "shaders/io/io.h"
IO_BEGIN
const uint kHemicubeGroup = 128u;
const uint kHemicubeAnyRoom = 0xffffffffu;
const uint kHemicubeNoPatch = 0xffffffffu;
// Sums of delta form factors are kept in fixed point, so that their order does not matter: 1 is 2^31.
const uint kHemicubeOneBits = 31u;
// A triangle and a viewpoint take three texels each (uvec4; floats by their bits):
//   triangle:  a.xyz, patch | b.xyz, room | c.xyz, -
//   viewpoint: position.xyz, own patch or kHemicubeNoPatch | normal.xyz, room or kHemicubeAnyRoom | tangent.xyz, -
// A patch takes one: normal.xyz, opening (0: opaque or interior glass, else glazing index + 1). A glazing takes one vec4:
// transmissivity per channel, refractive index.
struct HemicubeParams {
    uint firstViewpoint; // of the first workgroup
    uint pointsPerRow;   // successive viewpoints that share a row
    uint viewpointInRow; // the first workgroup's viewpoint, counted from the first row bound
    uint stripes;        // lanes that share a triangle
    uint triangleCount;
    uint patchCount;     // columns of `factors`
    uint resolution;     // R, even: the top has R x R pixels, each side R x R/2
    uint idBits;         // low bits of an item: patch * 2 + seen from behind
    float depthScale;    // items per metre of depth
    float flatness;      // metres: a patch nearer than this to holding the viewpoint in its plane is not seen
    uint skyElements;    // sky elements + 1 for the ground; 0: no sky coefficients
    uint skyDivision;    // Reinhart's MF
    uint channels;       // of the sky coefficients: 1 or 3
};
IO_END
