// What of open sheets is of bodies: of broken ones, and the bottoms of such as lack a lid.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <vector>

#include "geometry/face_soup.h"

namespace heliodon::geometry {

// Whether some of the `sheets` (SoupFace::surface) are what is left of a body that lacks a face: one has two
// edges or more with other faces. A partition may stand where floors or walls of two rooms meet: edges where
// two others or more meet that do not lie on it count for sheets alone that have another one opposite, at
// most `thickest` (metres) away. Corners are one within `tolerance` (metres). Cost: n log n for n faces.
bool areOfBody(const std::vector<SoupFace>& drawn, const std::set<uint32_t>& sheets, double thickest,
               double tolerance);

// Of boxes and pots without a lid the bottoms, as drawn on a floor or table: they lie on larger faces, and
// all their edges are those of sheets. By their places in `faces`, as are `sheets`; glass (`isGlass` of a
// material) is none. Cost: that of cutIntoSheets().
std::set<uint32_t> bottomsOf(const std::set<uint32_t>& sheets, const std::vector<SoupFace>& faces,
                             const std::function<bool(uint32_t)>& isGlass, double tolerance);

} // namespace heliodon::geometry
