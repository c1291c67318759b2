#ifdef __cplusplus
#pragma once
#endif
#include "shaders/io/io.h"
IO_BEGIN
// A node takes two texels (uvec4; floats by their bits): low.xyz, node to go on with when the box is missed or done |
// high.xyz, 0 or, of a leaf, first triangle * 2 kBvhLeafMost + count.
const uint kBvhLeafMost = 8u;
IO_END
