// Rings of walls with gaps between them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/plan_arrangement.h"

namespace heliodon::geometry {

constexpr size_t kFewestGaps = 3; // of a ring

// Whether the outline has gaps and walls by turns, no gap of them wider than the walls beside it or with a
// corner that points into the space. `outline`: half-edges with the space on their left; `solid`: per cell.
bool isRing(const PlanArrangement& map, const std::vector<bool>& solid, const std::vector<uint32_t>& outline);

} // namespace heliodon::geometry
