// Evens out the areas of a triangulation whose angles have been raised already.
#pragma once

#include "geometry/planar_net.h"

namespace heliodon::geometry {

// Moves single points to where the squares of the areas round them have the least sum, as far on that way as
// leaves angles 37 degrees, or as large as they are where they are smaller. `onFoldsOnly`: others stay.
void evenAreas(PlanarNet& net, bool onFoldsOnly);

} // namespace heliodon::geometry
