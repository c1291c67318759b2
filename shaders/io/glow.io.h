#ifdef __cplusplus
#pragma once
#endif
#include "shaders/io/io.h"
IO_BEGIN
// Of light that varies within a triangle: cells along each of its edges, and values for each.
const uint kGlowCells = 6u, kGlowPlaces = (kGlowCells + 1u) * (kGlowCells + 2u) / 2u;
IO_END
