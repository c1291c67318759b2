// Rooms taken out of a building.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/building.h"

namespace heliodon::geometry {

// The rooms that are `kept` (per room) stay, numbered in their order, with their faces; what was a twin of
// others' faces has none. Returns what place each face that stays had before, ascending.
std::vector<uint32_t> keepRooms(Building& building, const std::vector<bool>& kept);

} // namespace heliodon::geometry
