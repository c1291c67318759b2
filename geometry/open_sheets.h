// Which faces of a model enclose nothing, as an overhang or the ground drawn as one plane.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "geometry/face_soup.h"

namespace heliodon::geometry {

struct OpenSheets {
    std::vector<SoupFace> closed; // what is left, each edge of two sheets or more
    std::vector<SoupFace> open;   // each piece once, also where it is drawn for both sides
};

// Takes off all that has an edge of its own, until nothing does, of the faces as they cut one another: the
// eaves of a roof, not what of it covers a room. Faces that others cover in `closed` are not repeated there.
// None where nothing is to be taken off, nothing would be left, or glass (`isGlass` of a material) would go.
// Corners are one within `tolerance` (metres). Cost: that of cutIntoSheets().
std::optional<OpenSheets> openSheets(const std::vector<SoupFace>& faces,
                                     const std::function<bool(uint32_t)>& isGlass, double tolerance);

} // namespace heliodon::geometry
