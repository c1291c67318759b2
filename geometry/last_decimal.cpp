#include "geometry/last_decimal.h"

#include <algorithm>

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

namespace heliodon::geometry {

double lastDecimal(std::span<const glm::dvec3> points, double least) {
    constexpr double kOff = 1e-3; // of the last decimal: what single precision makes of it
    for (double perUnit = 1; 1 > least * perUnit; perUnit *= 10)
        if (std::ranges::all_of(points, [&](glm::dvec3 p) {
                const glm::dvec3 steps = perUnit * p;
                return glm::all(glm::lessThan(glm::abs(steps - glm::round(steps)), glm::dvec3(kOff)));
            }))
            return 1 / perUnit;
    return 0;
}

} // namespace heliodon::geometry
