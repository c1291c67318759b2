// Keeps outlines of rooms a hair apart where they touch themselves or one another.
#pragma once

#include <algorithm>
#include <vector>

#include "geometry/plan_rooms.h"

namespace heliodon::geometry {

constexpr double kPinchGap = 0.01; // inches between parts of outlines that do not follow one another

// Whether the stretches from a to b and from c to d of one line have nothing in common.
inline bool beside(double a, double b, double c, double d) {
    return std::max(a, b) < std::min(c, d) || std::max(c, d) < std::min(a, b);
}

// Corners that coincide, or lie on another edge, are drawn a hair into their own side's air, or back from it
// where it narrows to nothing between them; those that are too near to one, away from it.
void separatePinches(std::vector<RoomPlan>& rooms);

} // namespace heliodon::geometry
