// Boards that are lost where solids run into one another and were not united.
#pragma once

#include <vector>

#include "geometry/face_soup.h"

namespace heliodon::geometry {

// Whether of each sheet (SoupFace::surface) as much is seen in the rooms as one side of it, nearly: of the
// sides of its `boards` the largest triangle's middle has to lie on a face of the building that looks the
// same way, with its material. `tolerance` (metres): how far off that may be. Cost: n log n.
bool areBoardsSeen(const std::vector<SoupFace>& boards, const Building& building, double tolerance);

} // namespace heliodon::geometry
