// The outside as a short vector: Reinhart's division of the sky, and the ground as its last element. World
// axes, y up: azimuth from -z towards +x, so that turning north turns the sky's luminances and never the
// coefficients. Tregenza, Subdivision of the sky hemisphere, 1987; Reinhart and Walkenhorst, Dynamic
// RADIANCE-based daylight simulations, 2001.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <glm/vec3.hpp>

namespace heliodon::compute {

// 144 division^2 + 1 sky elements, by rows from the horizon up, each row from -z towards +x; then the ground.
constexpr uint32_t skyElementCount(uint32_t division) {
    return 144 * division * division + 2;
}

// Element that holds a unit direction; the same as shaders/lib/sky_elements.glsl but for rounding at borders.
uint32_t skyElementOf(glm::dvec3 direction, uint32_t division);

// One element as a rectangle in altitude and azimuth, radians. The ground is not one of them.
struct SkyElement {
    double lowAltitude = 0, highAltitude = 0, azimuth = 0, width = 0; // azimuth of the middle
    double solidAngle() const;
};
SkyElement skyElement(uint32_t element, uint32_t division);

// Mean of `luminance(direction)` over each sky element (`samples` squared points each, equal solid angles);
// the ground's entry is `ground`. cd/m2 in, cd/m2 out.
std::vector<float> skyElementMeans(uint32_t division, const std::function<double(glm::dvec3)>& luminance,
                                   double ground, uint32_t samples = 3);

} // namespace heliodon::compute
