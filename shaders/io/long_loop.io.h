#ifdef __cplusplus
#pragma once
#endif
#include "shaders/io/io.h"
IO_BEGIN
const uint kLongLoopGroup = 8u;
struct LongLoopParams {
    uint loops;
    uint turns; // of each, at least 2
};
IO_END
