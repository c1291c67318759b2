// What of a building's outside may stand between its windows and the sky.
#pragma once

#include <span>

#include "geometry/building.h"
#include "geometry/face_soup.h"

namespace heliodon::geometry {

// Of `faces` (counter-clockwise seen from the outside air) the triangles that lie before the glass of some
// window to the outside and look at it, without what of terrain, terraces and sills is below all of these:
// it is about as bright as the ground that it hides; with their materials. Corners are one within `tolerance`
// (metres). Cost: faces times windows.
Occluders outsideShade(std::span<const SoupFace> faces, const Building& building, double tolerance);

} // namespace heliodon::geometry
