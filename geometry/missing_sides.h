// Spaces that open sheets and the faces of rooms enclose but for a side.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/building.h"
#include "geometry/flat_faces.h"

namespace heliodon::geometry {

// World metres: of the lowest room, as it says how high rooms are: between 2 and 3 metres of building.
double heightOfLowRoom(const Building& rooms, double worldPerBuilding);

// World metres: what is lower is no room, beside rooms of which the lowest is so high.
double heightOfFences(double lowRoom, double worldPerBuilding);

struct LackingSide {
    uint32_t surface; // SoupFace's, of a sheet of what lacks it
    const char* side; // "wall", "floor" or "ceiling"
};

// None where nothing is such.
struct MissingSides {
    std::optional<LackingSide> room;
    // Has floor and ceiling and lacks a wall, before a window of a room at most one and a half rooms' heights
    // off.
    std::optional<LackingSide> loggia;
    std::optional<LackingSide> court; // lacks its ceiling, windows of rooms look at it
    // Whatever lacks a side but is too low for a room. Without floor or ceiling: 1.2 m high or more, and no
    // yard, with walls all about within four lowest rooms' heights.
    std::optional<LackingSide> low;
};

// No room is what is lower than people are, unless it has floor and ceiling and is 1.6 m high on the mean, by
// itself or with such spaces above and below that lack a wall too, as what sheets divide; or
// has no ceiling and walls up to their height alone, as a garden with a fence, or whose walls are of parts
// that do not hang together and are much smaller, as the leaves of a tree. `looksIn`: what is behind a sheet
// is solid, as a neighbour without its floor. `ofSheets`, `ofRooms`, `solidGround`: flat faces, the last of
// ground that is no sheet. `worldPerBuilding`: world metres a metre of building. Within `tolerance` (world
// metres) they touch. Cost: n log n, some thousands of points each look about.
MissingSides missingSides(const Building& sheets, const std::vector<FlatFace>& ofSheets,
                          const Building& rooms, const std::vector<FlatFace>& ofRooms,
                          const std::vector<FlatFace>& solidGround, bool looksIn, double worldPerBuilding,
                          double tolerance);

} // namespace heliodon::geometry
