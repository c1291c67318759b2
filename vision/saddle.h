// Where four alternating dark and bright corners meet, to a fraction of a pixel: the extremal point of a
// quadratic fitted to a blurred neighbourhood (L. Lucchese and S. K. Mitra, "Using saddle points for subpixel
// feature detection in camera calibration targets", 2002). Ours weights the pixels by their distance and
// moves the window with the point, so that the pattern's symmetry cancels what a quadratic cannot follow.
#pragma once

#include <optional>

#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>

#include "vision/grey_picture.h"

namespace heliodon::vision {

struct Saddle {
    glm::dvec2 pixel{};
    double strength = 0; // how much the brightness of the picture bends over the window, 1 = full scale
};

// Starts at `start`; `pixelFromCell` maps the corner's own axes, in which each of the four corners is a unit
// square, to pixels. The window is an ellipse of `radius` cells, or a circle of 2 pixels where that is
// narrower.
// None when the neighbourhood is no saddle, leaves the picture, or its point lies more than a window away.
// About 3 us at 20 pixels a cell.
std::optional<Saddle> refineSaddle(const GreyPicture& picture, glm::dvec2 start,
                                   const glm::dmat2& pixelFromCell, double radius = 0.5);

// The blur that this fit wants, in pixels, for cells of so many pixels.
double saddleBlur(double cellPixels);

} // namespace heliodon::vision
