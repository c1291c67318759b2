// Rooms that share walls without thickness, drawn once for both or once for each: what the faces divide space
// into, each bounded part a room.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/building.h"
#include "geometry/face_soup.h"

namespace heliodon::geometry {

struct SharedWalls {
    std::vector<SoupFace> faces; // with room and `surface` as given; both sides of a shared wall
    uint32_t rooms = 0;
    std::vector<std::string> repairs;  // on walls that two rooms see; empty when there are none
    std::vector<std::string> warnings; // on what is solid and what is a room; empty when there is no doubt
    std::vector<std::array<uint32_t, 2>> pairs; // given faces (`surface`) that lie on one another
    Building outside; // the same as one closed shell seen from outside: to be proven free of crossings
};

// Faces may look either way, overlap in their planes, end on one another (a wall drawn once) and be given
// twice; edges must meet within `tolerance` (metres). Where faces lie on one another, each room gets the
// material of the one that is turned as the rest of its own faces are.
// Solid is what was drawn into a room without regard to it (its floor or walls run on behind it) and stands
// clear of its walls, unless it is not thin and its faces look into it as those of the room do; what is small
// or thin and has faces that look out of it into such a room; a closed shell that touches nothing. Each such
// guess is a warning, and so is a room whose faces look the other way than those of the largest.
// None where an edge is open, faces of different materials look the same way from one place, no part is
// bounded, or there is neither a wall that two rooms see nor a solid. Cost: faces times planes, n^2 in one
// plane, sheets times parts.
std::optional<SharedWalls> divideSpace(const std::vector<SoupFace>& faces, double tolerance);

} // namespace heliodon::geometry
