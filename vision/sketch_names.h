// Ids of what was read.
#pragma once

#include "geometry/sketch.h"

namespace heliodon::vision {

// Sorts each kind as it lies in the picture, from the top, then from the left, and gives ids "w1", "a1",
// "win1", "sky1", "token1" by that order: they do not depend on the order in which things were met. Windows
// name their walls by index before and by id after.
void nameInOrder(geometry::Sketch& sketch);

} // namespace heliodon::vision
