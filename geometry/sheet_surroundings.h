// Whether open sheets stand outside of rooms, or are what is drawn of a room with a hole in its shell.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/building.h"
#include "geometry/face_soup.h"
#include "geometry/missing_sides.h"

namespace heliodon::geometry {

struct SheetFault {
    uint32_t surface;  // SoupFace's, of the sheet
    std::string words; // what it does: "lies in a room ..."
};

struct SheetVerdict {
    std::optional<SheetFault> fault; // none: all stand outside
    // Without fault: windows, by face of the rooms, that look at nothing but sheets, as behind an outer skin
    // without holes.
    std::vector<uint32_t> blindWindows;
    MissingSides missing; // without fault; no room
};

// No fault where no sheet lies in a room, crosses a face of one or lies on its glass, and they enclose no
// space of a room's size but for one side or less (geometry/missing_sides): walls and ceiling beside a closed
// room are a room that is not closed. `looksIn`: the faces of the rooms are drawn so that they look in.
// Nor do they without the ground, which may divide such a space into low ones (geometry/ground_in_rooms).
// `solids`: closed bodies that stand outside; the ground among them may be the floor of such a space.
// `worldPerBuilding`: world metres a metre of building. Within `tolerance` (world metres) all may touch.
// Cost: n log n, and sheets times faces of rooms that are near.
SheetVerdict judgeSheets(const std::vector<SoupFace>& sheets, const Building& rooms,
                         const std::vector<SoupFace>& solids, bool looksIn, double worldPerBuilding,
                         double tolerance);

// A sentence on sheets without fault. `place`: how a message names a face.
std::string sheetsOutside(const std::vector<SoupFace>& sheets,
                          const std::function<std::string(uint32_t)>& place);

// Sentences on what else is guessed without fault. `source`: per face of the rooms, its number in the file.
std::vector<std::string> warningsOf(const SheetVerdict& verdict,
                                    const std::function<std::string(uint32_t)>& place,
                                    const std::vector<uint32_t>& source);

} // namespace heliodon::geometry
