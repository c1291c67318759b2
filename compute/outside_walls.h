// Of what stands outside of a building, what a window can see.
#pragma once

#include <span>
#include <vector>

#include "compute/convex_regions.h"

namespace heliodon::compute {

// Of `outside` (outsideRegions), those that look at the opening and that no single other one, of the sixteen
// nearest, hides from all of it: of a row of recessed windows each sees its own reveal. Ends count as hidden
// within `tolerance` (metres). Cost: regions times sixteen.
std::vector<const ConvexRegion*> seenFrom(const ConvexRegion& opening, std::span<const ConvexRegion> outside,
                                          double tolerance);

} // namespace heliodon::compute
