#ifdef __cplusplus
#pragma once
#endif
#include "shaders/io/io.h"
IO_BEGIN
const uint kRooflineGroup = 256u;
const uint kRooflineSums = 8u; // independent sums of four floats: enough to hide the latency of one
struct RooflineParams {
    uint rounds; // of arithmetic, or texels that one invocation reads
    uint invocations;
    float factor, addend;
};
IO_END
