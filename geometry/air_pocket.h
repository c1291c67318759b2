// Walls drawn with their thickness as one closed shell, with a hole and no glass in it: what is closed is the
// inside of the walls, and the air of the room lies outside of it.
#pragma once

#include <optional>

#include "geometry/building.h"

namespace heliodon::geometry {

// Metres, as the directions in which one sees out through the hole have it.
struct AirPocket {
    glm::dvec3 hole{0}; // its middle, about
    double width = 0, height = 0;
};

// What faces without glass enclose on nearly all sides from outside but for a hole, where that is larger than
// what is in them. Cost: 40,000 rays.
std::optional<AirPocket> airPocket(const Building& building, double tolerance);

} // namespace heliodon::geometry
