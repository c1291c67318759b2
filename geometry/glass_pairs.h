// Glasses on the two sides of one wall -> the twins of an interior window.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/building.h"

namespace heliodon::geometry {

// Makes twins of faces of glass (materials that are openings, without holes) that stand back to back no
// farther apart than a wall is thick and have one shape to within `tolerance` (metres). A corner that only
// one side has, because something meets its edge there, is put into the other side's edge. Returns pairs that
// overlap but have different shapes: what falls on one would be lost. `extent`: of the model, metres.
std::vector<std::pair<uint32_t, uint32_t>> pairGlasses(Building& building, double tolerance, double extent);

} // namespace heliodon::geometry
