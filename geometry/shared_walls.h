// Rooms that share walls without thickness, drawn once for both or once for each: what the faces divide space
// into, each bounded part a room.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/building.h"
#include "geometry/face_soup.h"

namespace heliodon::geometry {

struct SharedWalls {
    std::vector<SoupFace> faces; // with room and `surface` as given; both sides of a shared wall
    uint32_t rooms = 0;
    // On walls that two rooms see, on faces that others divide, and where the smaller of two materials is
    // seen.
    std::vector<std::string> repairs;
    std::vector<std::string> warnings; // on what is solid and what is a room; empty when there is no doubt
    // Given faces (`surface`) of a material of their own that are turned away from a room on a wall without
    // thickness of which they cover most: taken as its outside, and as well a poster.
    std::vector<uint32_t> unseen;
    std::vector<std::array<uint32_t, 2>> pairs; // given faces (`surface`) that lie on one another
    std::vector<SoupFace>
        outer; // opaque, seen from outside of all rooms alone, as the outsides of thick walls
    std::vector<SoupFace> sheets; // of `outer`, what encloses nothing though each edge of it ends on others
    Building outside; // the same as one closed shell seen from outside: to be proven free of crossings
};

// Faces may look either way, overlap in their planes, end on one another (a wall drawn once) and be given
// twice; edges must meet within `tolerance` (metres). Where faces lie on one another, each room gets the
// material of the one that is turned as the rest of its own faces are, of several such the smallest of those
// that bound that room (a rug on the floor). Where all are those of the room behind, it gets the wall and not
// what is drawn on it there. Where no room is behind, a smaller one that is turned over is
// seen as well, unless nothing is behind and such cover half of the face or more: they are the wall's outer
// side. What that rule chose between materials is a repair.
// Solid is what was drawn into a room without regard to it (its floor or walls run on behind it) and stands
// clear of its walls, unless it is not thin and its faces look into it as those of the room do; what is small
// or thin and has faces that look out of it into such a room; a closed shell that touches nothing; what has
// no glass and looks out, where the largest room with windows looks in, as a neighbour or the ground does, or
// does not look out and it is as large and low as the ground (isMuchLarger()); and the inside of walls,
// however thick, round rooms whose windows lead through them to the outside; but nothing that glass
// (`isGlass` of a material) parts from one room and no other, or from two others unless it is the inside of a
// wall. Each such guess is a warning, and so is a room whose faces look the other way than those of the
// largest. None where an edge is open, some enclose nothing as they cross others, faces of one size and
// different materials look the same way from one place, no part is bounded, or no face lies or ends on
// another. Cost: faces times planes, n^2 in one plane, and sheets times parts in each of the rounds that find
// solids: one more than solids stand on one another.
std::optional<SharedWalls> divideSpace(const std::vector<SoupFace>& faces,
                                       const std::function<bool(uint32_t)>& isGlass, double tolerance);

} // namespace heliodon::geometry
