// Connected regions of one paint.
#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "vision/color_classes.h"

namespace heliodon::vision {

struct Run {
    int y, x0, x1; // photograph pixels, x1 exclusive
};

struct Component {
    Paint group = Paint::none;
    int area = 0;          // pixels
    int minorityArea = 0;  // of these: orange among red, light blue among blue
    std::vector<Run> runs; // ordered by y, then x
    glm::dvec2 centre{};   // mean pixel
};

// Four-connected components of at least `minArea` pixels, in the order of their first pixel. One pass over
// the picture's runs.
std::vector<Component> findComponents(const ClassImage& image, int minArea);

} // namespace heliodon::vision
