// The scale of false-colour pictures, logarithmic: its ends, and the legend drawn into a picture.
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

// The scale that `tone` asks for; open ends follow `lux`, the values at hand (any order, may be empty).
FalseScale falseScale(const Tone& tone, std::span<const float> lux);

// Where a legend of the scale has its numbers, ascending: 1, 2, 5 times powers of ten within it, over more
// than three decades the powers alone.
std::vector<double> legendTicks(const FalseScale& scale);

// A number of a legend or a drawing, three digits: "500", "2k".
std::string legendNumber(double lux);

// Colour at t in 0..1, sRGB-encoded, as shaders/lib/viridis.glsl.
glm::vec3 viridis(double t);

// Columns that the legend of a picture so high takes; 0 where it is too low for one.
int legendWidth(int height);

// A bar with numbers over the last legendWidth() columns, on a dark ground; nothing where the picture is too
// small for it.
void drawLegend(Image8& picture, const FalseScale& scale);

} // namespace heliodon::passes
