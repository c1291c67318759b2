// The largest magnitude of some numbers; 0 of none.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

namespace heliodon::compute {

inline double largest(std::span<const double> a) {
    double most = 0;
    for (const double x : a) most = std::max(most, std::abs(x));
    return most;
}

inline double largest(std::span<const float> a) {
    float most = 0;
    for (const float x : a) most = std::max(most, std::abs(x));
    return double{most};
}

} // namespace heliodon::compute
