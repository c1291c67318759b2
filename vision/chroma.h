// A light's colour without its brightness.
#pragma once

#include <algorithm>
#include <cmath>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace heliodon::vision {

// Logarithms of red and blue over green.
inline glm::vec2 chroma(float r, float g, float b) {
    constexpr float kTiny = 1e-6f;
    return {std::log((r + kTiny) / (g + kTiny)), std::log((b + kTiny) / (g + kTiny))};
}

// Degrees from red. `high`, `low`: the largest and the smallest component, high > low.
inline float hueOf(float r, float g, float b, float high, float low) {
    const float span = high - low;
    if (high == r) return 60 * (g - b) / span + (g < b ? 360.0f : 0.0f);
    if (high == g) return 120 + 60 * (b - r) / span;
    return 240 + 60 * (r - g) / span;
}

// 0 of greys too.
inline float hueOf(glm::vec3 p) {
    const float high = std::max(std::max(p.r, p.g), p.b), low = std::min(std::min(p.r, p.g), p.b);
    return high > low ? hueOf(p.r, p.g, p.b, high, low) : 0;
}

// P' of a colour, 0 of black.
inline float saturationOf(glm::vec3 p) {
    const float high = std::max(std::max(p.r, p.g), p.b), low = std::min(std::min(p.r, p.g), p.b);
    return high > 0 ? (high - low) / high : 0;
}

} // namespace heliodon::vision
