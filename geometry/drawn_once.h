// Sheets that are drawn for both their sides, as one for both.
#pragma once

#include <vector>

#include "geometry/face_soup.h"

namespace heliodon::geometry {

// Of faces in one place the smallest that look one way (a poster on a wall), with the material of the
// smallest that looks the other way behind it (SoupFace::behind), or of the largest where none does. Those
// with the same corners stay whole; where others lie on one another, as two sides along different diagonals,
// they are cut along one another. Corners are one within `tolerance` (metres). Cost: that of cutIntoSheets().
std::vector<SoupFace> drawnOnce(const std::vector<SoupFace>& faces, double tolerance);

} // namespace heliodon::geometry
