// Directions over the upper hemisphere, a degree and a half apart and closer at the horizon, between which a
// sky's luminance is interpolated quadratically: many samples of the sky share them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

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
    // is 1. Off by 1e-3 of the sky's brightest, by 2e-2 within 4 degrees of a cone's tip at the sun, to both
    // sides alike: by 4e-5 of the whole sky's light. Not for skies with a ribbon at the horizon.
    Shares sharesOf(glm::dvec3 direction) const;

private:
    struct Row {
        double elevation; // radians
        uint32_t first, count;
    };
    std::vector<Row> rows_; // from the horizon to the zenith
    std::vector<glm::vec3> nodes_;
};

} // namespace heliodon::daylight
