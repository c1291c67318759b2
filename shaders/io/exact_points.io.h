#ifdef __cplusplus
#pragma once
#endif
#include "shaders/io/io.h"
IO_BEGIN
const uint kExactPointGroup = 64u;
const uint kExactPointWords = 64u; // of 32 blockers that a group sorts out first

struct ExactPoint {
    vec3 high; // position in two floats a coordinate, from the scene's centre
    vec3 low;
    vec3 normal;
    uint room;
};

struct ExactPointsParams {
    uint pieceCount;
    uint blockerCount;
};
IO_END
