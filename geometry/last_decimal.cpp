#include "geometry/last_decimal.h"

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

} // namespace heliodon::geometry
