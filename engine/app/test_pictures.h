// Pictures for setting projectors up.
#pragma once

#include "engine/passes/picture.h"
#include "geometry/rig.h"

namespace heliodon::app {

// Lines every 64 pixels, the border to the last pixel, the middle, and circles that are round where pixels
// are square.
passes::Image8 gridPicture(const geometry::Projector& projector);
passes::Image8 plainPicture(const geometry::Projector& projector, uint8_t value);
// Its number, its id and its display, and which edge is up.
passes::Image8 namePicture(const geometry::Projector& projector, size_t number);

} // namespace heliodon::app
