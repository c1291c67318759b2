#ifdef __cplusplus
#pragma once
#endif
#include "shaders/io/io.h"
IO_BEGIN
const uint kGatherGroup = 256u;
const uint kGatherRows = 8u; // rows that a subgroup sums at once
// Rows of F need not start on a texel of four floats. Each column of light therefore comes four times, moved by 0 to 3
// floats and with zeros around it: copy (column * 4 + shift) starts at texel (column * 4 + shift) * texelsPerColumn.
struct RadiosityGatherParams {
    uint patchCount;
    uint rowCount; // of this window, which starts on a row that is a multiple of 16
    uint firstRow; // for the output
    uint texelsPerColumn;
};
IO_END
