// A plain photograph of a sketch: flat shading, no shadows, but the rig's lens and heights, uneven light of
// two colours and any paints. It shares no code with detection except the rig's projection, which has its own
// tests.
#pragma once

#include <array>
#include <vector>

#include <glm/vec2.hpp>

#include "geometry/rig.h"
#include "geometry/sketch.h"
#include "vision/photograph.h"

namespace heliodon::vision {

using Color = std::array<double, 3>; // linear reflectance

struct PaintBox {
    Color red{0.38, 0.06, 0.07}, blue{0.06, 0.12, 0.42}, green{0.09, 0.33, 0.12}, cyan{0.05, 0.38, 0.5},
        magenta{0.48, 0.06, 0.28}, yellow{0.68, 0.5, 0.08}, sky{0.42, 0.6, 0.78}, orange{0.66, 0.22, 0.04};
    Color table{0.84, 0.84, 0.83}, face{0.6, 0.6, 0.59}, floor{0.03, 0.03, 0.03};
};

struct Lighting {
    Color left{0.7, 0.66, 0.58},
        right{0.52, 0.55, 0.6}; // light at the left and the right edge of the picture
};

// Multiplies the light within the corners (plan, inches, at that height) by a gain for each channel: a
// shadow, or a patch of light; its border is a Gaussian of that standard deviation.
void shade(Photograph& photo, const geometry::Rig& rig, const std::vector<glm::dvec2>& corners, double height,
           const Color& gain, double softPx = 2);
// Something of that colour, as bright as a white of 1 would be 0.6.
void cover(Photograph& photo, const geometry::Rig& rig, const std::vector<glm::dvec2>& corners, double height,
           const Color& color);
// As where a picture is scaled after it was taken: blurred in encoded values, not in light.
void smoothEncoded(Photograph& photo, double px);
// A camera whose filters overlap: each channel takes that share of either other one.
void mixChannels(Photograph& photo, double share);

Photograph paintTable(const geometry::Sketch& sketch, const geometry::Rig& rig, const PaintBox& paints = {},
                      const Lighting& lighting = {});

} // namespace heliodon::vision
