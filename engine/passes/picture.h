// Pictures in host memory, rows from the top, tightly packed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace heliodon::passes {

// Three bytes a pixel, R G B, as a display or a PNG wants them (already encoded for it).
struct Image8 {
    int width = 0, height = 0;
    std::vector<uint8_t> rgb;

    uint8_t* pixel(int x, int y) {
        return rgb.data() +
               3 * (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x));
    }
    const uint8_t* pixel(int x, int y) const { return const_cast<Image8*>(this)->pixel(x, y); }
};

// Three linear floats a pixel, Rec. 709 primaries.
struct ImageF {
    int width = 0, height = 0;
    std::vector<float> rgb;

    const float* pixel(int x, int y) const {
        return rgb.data() +
               3 * (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x));
    }
};

} // namespace heliodon::passes
