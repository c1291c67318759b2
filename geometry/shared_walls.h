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
    std::vector<std::string> warnings; // on solids that stand against walls; empty when there are none
    std::vector<std::array<uint32_t, 2>> pairs; // given faces (`surface`) that lie on one another
    Building outside; // the same as one closed shell seen from outside: to be proven free of crossings
};

// Faces may look either way, overlap in their planes and be given twice; edges must meet within `tolerance`
// (metres). Where two faces lie on one another, each room gets the material of the one that is turned as the
// rest of its own faces are. Shells that share no wall with a room they stand in are solids in its air; so
// are small parts of space, against a wall or on the floor, whose faces look out of them where those of the
// largest part look into it. None where an edge is open, two faces with different materials look the same way
// from one place, no part is bounded, or there is neither a wall that two rooms see nor a solid against a
// wall. Cost: n log n, n^2 in one plane.
std::optional<SharedWalls> divideSpace(const std::vector<SoupFace>& faces, double tolerance);

} // namespace heliodon::geometry
