// Curved walls in upright strips: every facet stays flat, where triangles across the folds of an unrolled
// wall would each lie in a plane of its own. A wall that bulges outwards then hides nothing, one that bulges
// inwards hides as a few rectangles, whatever their number of triangles.
#pragma once

#include <optional>

#include "geometry/planar_mesher.h"

namespace heliodon::geometry {

// The domain cut into columns between points of its lower and upper side, which are filled with triangles
// between points at the heights of those of its left and right side. None where the domain is not a rectangle
// or its lower and upper side are divided differently, and none where angles would fall under 36 degrees or
// triangles be a quarter larger or a fifth smaller than elsewhere.
std::optional<PlanarMesh> meshUprightGrid(const PlanarDomain& domain);

} // namespace heliodon::geometry
