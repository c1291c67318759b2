// Which parts of space are rooms, and which are solid: walls with their thickness, what stands in rooms.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "geometry/space_parts.h"

namespace heliodon::geometry {

struct RoomParts {
    // Per part that is a room, or lies outside of a shell within the air of one: which.
    std::map<uint32_t, uint32_t> room;
    uint32_t count = 0;                // of rooms; 0: no part is bounded
    size_t walls = 0;                  // parts that are the inside of the walls all round
    std::vector<std::string> warnings; // on what is solid and what is a room; empty when there is no doubt
};

// By the rules of divideSpace() (geometry/shared_walls.h). `tolerance`: metres. Cost: sheets times parts in
// each of the rounds that find solids, one more than solids stand on one another.
RoomParts roomsAmong(const SpaceParts& space, double tolerance);

} // namespace heliodon::geometry
