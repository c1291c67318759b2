// Counts for messages: "6 walls, 1 arc, 5 windows, 2 skylights, 4 tokens, north".
#pragma once

#include <cstddef>
#include <string>

#include "geometry/sketch.h"

namespace heliodon::app {

// "1 wall", "2 walls".
std::string counted(size_t count, const char* what);

// What lies on the table; arcs only where there are any.
std::string inWords(const geometry::Sketch& sketch);

} // namespace heliodon::app
