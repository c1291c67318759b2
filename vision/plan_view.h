// The camera as a map between pixels and plan inches on horizontal planes, and the photograph as linear
// light.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "geometry/rig.h"
#include "vision/photograph.h"

namespace heliodon::vision {

// Light on white, a value for each square of pixels.
struct LightGrid {
    int x0 = 0, y0 = 0; // first pixel in the photograph
    int columns = 0, rows = 0;
    int square = 8;               // pixels
    std::vector<glm::vec3> light; // linear, row-major
};

class PlanView {
public:
    PlanView(const Photograph& photo, const geometry::OpticalDevice& camera, double gamma);

    // Plan inches (x right, y up, seen from above) at a height in inches over the table, and back.
    glm::dvec2 pixel(glm::dvec2 plan, double height) const;
    glm::dvec2 plan(glm::dvec2 pixel, double height) const;
    double pixelsPerInch(glm::dvec2 plan, double height) const;

    // Linear light at a pixel position, bilinear, clamped to the picture; white is 1.
    glm::vec3 light(glm::dvec2 pixel) const;
    // What the paints are told from; 1 before it is known and outside the grid.
    void setWhite(LightGrid white) { white_ = std::move(white); }
    glm::vec3 white(glm::dvec2 pixel) const;
    const Photograph& photo() const { return photo_; }
    const geometry::OpticalDevice& camera() const { return camera_; }
    const std::array<float, 256>& linearFromByte() const { return linear_; }

private:
    const Photograph& photo_;
    const geometry::OpticalDevice& camera_;
    std::array<float, 256> linear_{};
    LightGrid white_;
};

} // namespace heliodon::vision
