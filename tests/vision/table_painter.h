// A plain photograph of a sketch: flat shading, no shadows, but the rig's lens and heights, uneven light of
// two colours and any paints. It shares no code with detection except the rig's projection, which has its own
// tests.
#pragma once

#include <array>

#include "geometry/rig.h"
#include "geometry/sketch.h"
#include "vision/photograph.h"

namespace heliodon::vision {

using Color = std::array<double, 3>; // linear reflectance

struct PaintBox {
    Color red{0.38, 0.06, 0.07}, blue{0.06, 0.12, 0.42}, green{0.09, 0.33, 0.12}, cyan{0.05, 0.38, 0.5},
        magenta{0.48, 0.06, 0.28}, yellow{0.68, 0.5, 0.08}, sky{0.42, 0.6, 0.78}, orange{0.66, 0.22, 0.04};
};

struct Lighting {
    Color left{0.7, 0.66, 0.58},
        right{0.52, 0.55, 0.6}; // light at the left and the right edge of the picture
};

Photograph paintTable(const geometry::Sketch& sketch, const geometry::Rig& rig, const PaintBox& paints = {},
                      const Lighting& lighting = {});

} // namespace heliodon::vision
