// Walls, floors and furniture are often drawn as solids that run into one another.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "geometry/face_soup.h"

namespace heliodon::geometry {

enum class Solids { thatCross, thatMeet }; // the latter: that cross or touch

struct UnitedSolids {
    std::vector<SoupFace> faces;
    uint32_t solids = 0;  // that met others, farther than by rounding
    uint32_t surface = 0; // of a face that did
    uint32_t through = 0; // solids that so run through walls of rooms drawn without thickness
    uint32_t surfaceThrough = 0;
    std::vector<SoupFace> beyond;      // what of those is outside of rooms
    std::vector<uint32_t> muchOutside; // a face's surface of each of which much is
};

// Of opaque closed bodies whose faces look out of them and that meet one another the surface of
// their union, all else as it is; where such bodies run through walls of rooms drawn without thickness
// (geometry/sheet_rooms), as cupboards sunk into floors, these have the rest of the air. None where no two
// meet and none does that, more than 500 do, or nothing has glass (`isGlass` of a material): then they may be
// rooms. Where bodies share edges, faces near one another in the file
// (SoupFace::surface) are one's, and those of `boards` (by that) the one's of which they are elsewhere.
// Corners are one within `tolerance` (metres); what was meant to touch may cross by `rounding`. Cost: n log
// n, and faces times those of others that they meet.
std::optional<UnitedSolids> uniteSolids(const std::vector<SoupFace>& faces,
                                        const std::function<bool(uint32_t)>& isGlass, Solids which,
                                        double tolerance, double rounding = 0,
                                        const std::set<uint32_t>& boards = {});

// One sentence each. `place`: how a message names a face.
std::vector<std::string> warningsOf(const UnitedSolids& united, Solids which,
                                    const std::function<std::string(uint32_t)>& place);

} // namespace heliodon::geometry
