// Counts for messages: "6 walls, 1 arc, 5 windows, 2 skylights, 4 tokens, north".
#pragma once

#include <string>

#include "geometry/counted.h"
#include "geometry/sketch.h"

namespace heliodon::app {

using geometry::counted;

// What lies on the table; arcs only where there are any.
std::string inWords(const geometry::Sketch& sketch);

} // namespace heliodon::app
