#include "geometry/last_decimal.h"

#include <algorithm>
#include <cmath>

namespace heliodon::geometry {

double lastDecimal(std::span<const glm::dvec3> points, double least) {
    constexpr double kOff = 1e-3;    // of the last decimal: what single precision makes of it
    constexpr double kRounded = 0.4; // of all: what is typed needs its last decimal now and then
    double coarser = 0;              // how many have the decimal before
    for (double perUnit = 1; 1 > least * perUnit; perUnit *= 10) {
        double have = 0;
        for (const glm::dvec3 p : points)
            for (int c = 0; c < 3; ++c) have += std::abs(perUnit * p[c] - std::round(perUnit * p[c])) < kOff;
        const double all = 3 * static_cast<double>(points.size());
        if (have == all) return coarser <= (1 - kRounded) * all ? 1 / perUnit : 0;
        coarser = have;
    }
    return 0;
}

double lastBit(std::span<const glm::dvec3> points, double least) {
    constexpr double kOff = 0.05;     // of it: what nine digits make of single precision
    constexpr double kRounded = 0.25; // of those that have it: half do by chance
    double largest = 0;
    for (const glm::dvec3 p : points)
        for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(p[c]));
    const double bit = singleStep(largest);
    if (bit <= least) return 0;
    double large = 0, odd = 0;
    for (const glm::dvec3 p : points)
        for (int c = 0; c < 3; ++c) {
            if (std::abs(p[c] - static_cast<double>(static_cast<float>(p[c]))) > kOff * bit) return 0;
            if (singleStep(p[c]) < bit) continue;
            ++large;
            odd += std::abs(std::remainder(p[c] / bit, 2)) > 0.5;
        }
    return odd >= kRounded * large ? bit : 0;
}

double singleStep(double value) {
    const auto size = static_cast<float>(std::abs(value));
    return static_cast<double>(std::nextafter(size, HUGE_VALF)) - static_cast<double>(size);
}

} // namespace heliodon::geometry
