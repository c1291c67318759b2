// What is asked of many samples of light.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <glm/vec2.hpp>

namespace heliodon::vision {

// The upper one of two in the middle; changes the order. Not of none.
inline float median(std::vector<float>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// Logarithms of red and blue over green.
inline glm::vec2 chroma(float r, float g, float b) {
    constexpr float kTiny = 1e-6f;
    return {std::log((r + kTiny) / (g + kTiny)), std::log((b + kTiny) / (g + kTiny))};
}

} // namespace heliodon::vision
