// Faces that look the other way than those about them, of closed bodies: which way these look tells walls and
// furniture from rooms.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "geometry/face_soup.h"

namespace heliodon::geometry {

// Turns faces over where a closed piece without glass (`isGlass` of a material) has such as look into it and
// such as look out of it: to the way of most of its area; or, where so many faces of it, or of these pieces
// on average, are turned that this says nothing, out of it, unless another closed piece lies in it; where
// most pieces are such, the others as well. But pieces of two parts that look different ways stay as drawn.
// Nothing where no face is glass: then bodies may be rooms. Returns how many were turned. Corners are one
// within `tolerance` (metres). Cost: n log n, and pieces that are turned times all.
size_t turnAlike(std::vector<SoupFace>& faces, const std::function<bool(uint32_t)>& isGlass,
                 double tolerance);

} // namespace heliodon::geometry
