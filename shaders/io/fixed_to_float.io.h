#ifdef __cplusplus
#pragma once
#endif
#include "shaders/io/io.h"
IO_BEGIN
const uint kFixedToFloatGroup = 256u;
const uint kFixedToFloatEach = 8u; // numbers for each lane
struct FixedToFloatParams {
    uint count;
    float unit; // of the fixed-point numbers
};
IO_END
