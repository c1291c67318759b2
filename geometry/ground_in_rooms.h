// The ground is often drawn as one surface that runs on through the houses that stand in it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "geometry/bounds.h"
#include "geometry/building.h"
#include "geometry/face_soup.h"
#include "geometry/open_sheets.h"

namespace heliodon::geometry {

// From above, as the ground is: three times the area of all rooms or more.
bool isMuchLarger(const Bounds& ground, const Bounds& rooms);

// Takes the ground off where it is drawn as a solid: what hangs together, is closed, has no glass (`isGlass`
// of a material), is level for the most part, covers three times the area of all that has glass in or between
// walls, or more, and reaches below that. Of it what looks up is open, the rest goes. None where there is no
// such body, or nothing else. Corners are one within `tolerance` (metres). Cost: n log n.
std::optional<OpenSheets> openGround(const std::vector<SoupFace>& faces,
                                     const std::function<bool(uint32_t)>& isGlass, double tolerance);

struct GroundOutside {
    std::vector<SoupFace> sheets;    // as given, what was ground in rooms left out
    std::optional<uint32_t> surface; // of a sheet that was cut; none where all are as given
    std::optional<uint32_t> onGlass; // of one that would be, but runs through a window
};

// Cuts open sheets at the walls of rooms where what they hang together with is level for the most part and
// covers three times the area of all rooms or more. What of them lies in a room goes, where there is less
// above or below it than a storey's height (geometry/missing_sides), so that it is no floor between two. What
// runs through glass is left as it is. `worldPerBuilding`: world metres a metre of building. Within
// `tolerance` (world metres) they touch. Cost: n log n, and sheets times faces of rooms that they cross.
GroundOutside groundOutside(const std::vector<SoupFace>& sheets, const Building& rooms,
                            double worldPerBuilding, double tolerance);

struct GroundAndOthers {
    std::vector<SoupFace> ground, others;
};

// Ground is what is level, hangs together by what is level too, and covers three times the area of all rooms
// or more: floors and ceilings that walls alone join to it are none. Corners are one within `tolerance`
// (metres). Cost: n log n.
GroundAndOthers groundAmong(const std::vector<SoupFace>& faces, const Building& rooms, double tolerance);

} // namespace heliodon::geometry
