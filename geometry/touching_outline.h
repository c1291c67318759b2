// Faces whose outlines touch themselves, as a floor's does round a body that touches a wall in one upright
// edge, a hair off it beside that, or a wall's along a slit of no width where such an edge meets it.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "geometry/building.h"

namespace heliodon::geometry {

using FaceLoops = std::vector<std::vector<uint32_t>>;

// The loops of parts of the face, divided along edges of its triangles, that visit no corner twice and are
// whole by `isWhole` (but for single triangles, of which that is not asked); none where the face cannot be
// triangulated. Asks once for each inner edge of the triangles.
std::vector<FaceLoops> partsOfTouching(const Building& building, const Face& face,
                                       const std::function<bool(const FaceLoops&)>& isWhole);

} // namespace heliodon::geometry
