// A light's colour without its brightness.
#pragma once

#include <cmath>

#include <glm/vec2.hpp>

namespace heliodon::vision {

// Logarithms of red and blue over green.
inline glm::vec2 chroma(float r, float g, float b) {
    constexpr float kTiny = 1e-6f;
    return {std::log((r + kTiny) / (g + kTiny)), std::log((b + kTiny) / (g + kTiny))};
}

} // namespace heliodon::vision
