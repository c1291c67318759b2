// What of a building's outside may stand between its windows and the sky.
#pragma once

#include <span>

#include "geometry/building.h"
#include "geometry/face_soup.h"

namespace heliodon::geometry {

// Of `faces` (counter-clockwise seen from the outside air) the triangles that lie before the glass of some
// window to the outside and look at it, and those that these look at, or that the outer sides of walls before
// some window do, which shade them or light them; with their materials. Of more than a thousand, as of
// terrain, the former alone, and without what of slopes, terraces and sills is below all windows that it
// looks at: that is about as bright as the ground that it hides. Corners are one within `tolerance` (metres).
// Cost: triangles times windows, of the few times one another.
Occluders outsideShade(std::span<const SoupFace> faces, const Building& building, double tolerance);

} // namespace heliodon::geometry
