// The logarithmic scale of lux as colours, in pictures and drawings: its ends, and the legend drawn into a
// picture. What lies below the scale, darkness too, is black.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/passes/picture.h"
#include "engine/passes/tone.h"

namespace heliodon::passes {

struct FalseScale {
    double lowLux = 10, highLux = 10000;
};

// A scale that nearly all of the positive values lie on: from 1, 2 or 5 times a power of ten to another, at
// least five times as much. Of fewer than 200 values it holds all but the smallest hundredth. 100 lux where
// there are none.
FalseScale scaleHolding(std::vector<double> lux);

// The scale that `tone` asks for; open ends are scaleHolding() of `lux`, the values at hand (any order).
FalseScale falseScale(const Tone& tone, std::span<const float> lux);

// Where a legend of the scale has its numbers, ascending: 1, 2, 5 times powers of ten within it, over more
// than three decades the powers alone, and the ends.
std::vector<double> legendTicks(const FalseScale& scale);

// A number of a legend or a drawing, three digits: "500", "2k".
std::string legendNumber(double lux);

// Colour at t in 0..1, sRGB-encoded, as shaders/lib/viridis.glsl.
glm::vec3 viridis(double t);

// Columns that the legend of a picture so high takes; 0 where it is too low for one.
int legendWidth(int height);

// "< 100", beside black.
std::string belowScale(const FalseScale& scale);

// A bar with numbers, and black below it, over the last legendWidth() columns, on a dark ground; nothing
// where the picture is too small for it.
void drawLegend(Image8& picture, const FalseScale& scale);

} // namespace heliodon::passes
