// Makes what coincides but for rounding coincide to the last bit, so that rounding decides nothing of what is
// made from it.
#pragma once

#include <vector>

#include "geometry/plan_arrangement.h"

namespace heliodon::geometry {

// Ends of segments within `near` (inches) of one another become one, in the place of the first of them from
// left to right; segments that pass an end so closely run through it, as several with the same tag. Their
// order is kept and does not matter. Cost: ends times segments.
std::vector<PlanSegment> snapped(const std::vector<PlanSegment>& segments, double near);

} // namespace heliodon::geometry
