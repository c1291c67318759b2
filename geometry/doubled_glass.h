// Glass that a file has twice: drawn so, or for both sides, as some programs write every face.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "geometry/face_soup.h"

namespace heliodon::geometry {

// Leaves out the second of two faces of glass (`isGlass` of a material) with the same corners, looking either
// way, where that is so of all glass that they hang together with: slabs that touch have one such pair.
// Returns how many. Corners are one within `tolerance` (metres). Cost: n log n of the glass.
size_t dropDoubledGlass(std::vector<SoupFace>& faces, const std::function<bool(uint32_t)>& isGlass,
                        double tolerance);

} // namespace heliodon::geometry
