// What a region of paint lies round: rolls of tape, cups and pots have a rim as broad as a wall's top.
#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "vision/components.h"

namespace heliodon::vision {

struct RoundHole {
    glm::dvec2 centre{}; // pixel
    double radius = 0;   // pixels, of a disc of its area
};

// Holes of the region as wide as they are long, with radii from `least` to `most` pixels. Walls of one region
// enclose none: each has white ends.
std::vector<RoundHole> roundHoles(const Component& region, double least, double most);

// Whether most of the region lies within `rim` pixels of one of the holes.
bool liesRound(const Component& region, const std::vector<RoundHole>& holes, double rim);

} // namespace heliodon::vision
