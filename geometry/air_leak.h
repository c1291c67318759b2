// Where the air of a room gets out of a model that does not close: the tightest place on the widest way out.
#pragma once

#include <optional>
#include <vector>

#include "geometry/face_soup.h"
#include "geometry/tightest_place.h"

namespace heliodon::geometry {

// Of the largest space that faces, of walls and of glass, enclose but for holes much narrower than it is;
// none where there is no such space, or its holes are narrower than a 50,000th of the model or so, or too
// many faces lie beside one another to tell with 300,000 cells. Corners are one within `tolerance` (metres).
// Cost: that of openSheets() and partsOfSpace(), and about a second at most.
std::optional<TightPlace> airLeak(const std::vector<SoupFace>& faces, double tolerance);

} // namespace heliodon::geometry
