// The transfer function of sRGB (IEC 61966-2-1).
#pragma once

#include <cmath>

namespace heliodon::geometry {

// 0 to 1, of a value from 0 to 255.
inline double linearOfSrgb(double value) {
    const double s = value / 255;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

} // namespace heliodon::geometry
