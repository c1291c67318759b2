// Connected regions of one paint.
#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "vision/color_classes.h"

namespace heliodon::vision {

struct Run {
    int y, x0, x1; // photograph pixels, x1 exclusive
};

// Red and orange, and blue and light blue, differ too little in hue for single noisy pixels: they are one group here, and
// shape and majority tell them apart later.
constexpr Paint groupOf(Paint p) {
    return p == Paint::orange ? Paint::red : p == Paint::sky ? Paint::blue : p;
}

struct Component {
    Paint group = Paint::none;
    int area = 0;              // pixels
    int minorityArea = 0;      // of these: orange among red, light blue among blue
    std::vector<Run> runs;     // ordered by y, then x
    glm::dvec2 centre{};       // mean pixel
};

// Four-connected components of at least `minArea` pixels, in the order of their first pixel. One pass over the picture's runs.
std::vector<Component> findComponents(const ClassImage& image, int minArea);

} // namespace heliodon::vision
