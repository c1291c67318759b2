#ifdef __cplusplus
#pragma once
#endif
#include "shaders/io/io.h"
IO_BEGIN
const uint kAffineGroup = 64u;
struct AffineParams {
    uint count;
    float scale;
    float offset;
};
IO_END
