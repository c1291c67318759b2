// Luminance of linear Rec. 709 (ITU-R BT.709), the colour space of all light and reflectance here.
#pragma once

#include <glm/vec3.hpp>

namespace heliodon::geometry {

// What red, green and blue are of it; shaders have the same in shaders/io/display.io.h.
constexpr glm::dvec3 kLuminance{0.2126, 0.7152, 0.0722};

// Y, the photometric value, of lux or luminance per channel.
inline double photometric(const glm::dvec3& rgb) {
    return kLuminance.x * rgb.x + kLuminance.y * rgb.y + kLuminance.z * rgb.z;
}
inline double photometric(const glm::vec3& rgb) {
    return photometric(glm::dvec3(rgb));
}

// Whether one channel says what all three would.
inline bool isGrey(const glm::vec3& rgb) {
    return rgb.x == rgb.y && rgb.y == rgb.z;
}

} // namespace heliodon::geometry
