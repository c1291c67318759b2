// Directions over the upper hemisphere, a degree and a half apart and closer at the horizon, between which a
// sky's luminance is interpolated quadratically: many samples of the sky share them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/daylight/sky.h"

namespace heliodon::daylight {

class SkyGrid {
public:
    struct Share {
        uint32_t node;
        double weight;
    };
    using Shares = std::array<Share, 9>;

    SkyGrid();
    const std::vector<glm::vec3>& nodes() const { return nodes_; } // unit, y > 0

    // What nodes say of the luminance in a unit direction with y > 0: weights, of either sign, whose sum
    // is 1. For skies that are smooth with height off by 3e-3 of the sky's brightest, by 5e-2 within 5
    // degrees of a cone's tip at the sun (measured on 3000 skies drawn at random, a year of weather and all
    // CIE types); to both sides alike, by 1e-4 of the whole sky's light (85 skies).
    Shares sharesOf(glm::dvec3 direction) const;

    // Whether rows are close enough for the gradation with height: between them it is told to 1e-3 of the
    // sky's brightest. Not those of most skies with a ribbon at the horizon, nor of Perez's skies under a low
    // sun that are dark below a height of some degrees (b > 0 > a): those would be off by up to 20 %. 19 of
    // Chicago's 4691 hours of light. About 10 us.
    bool isSmoothWithHeight(const Sky& sky) const;

private:
    struct Row {
        double elevation; // radians
        uint32_t first, count;
    };
    // Three rows about an elevation, and what each counts there.
    struct Rows {
        size_t first;
        std::array<double, 3> weight;
    };
    Rows rowsAbout(double elevation) const;

    std::vector<Row> rows_; // from the horizon to the zenith
    std::vector<glm::vec3> nodes_;
};

} // namespace heliodon::daylight
