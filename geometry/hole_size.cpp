#include "geometry/hole_size.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"

namespace heliodon::geometry {

namespace {

constexpr double kUpright = 0.05;   // of the normal, vertical: its height is the side to a thousandth
constexpr double kCollinear = 1e-6; // of the longest edge, across it
constexpr double kDeepOfSide = 0.1;

double along(std::span<const glm::dvec3> points, glm::dvec3 direction) {
    double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
    for (const glm::dvec3& p : points) {
        low = std::min(low, glm::dot(p, direction));
        high = std::max(high, glm::dot(p, direction));
    }
    return high - low;
}

} // namespace

std::string sizeOfHole(std::span<const glm::dvec3> border, double offPlane) {
    glm::dvec3 longest{0}, across{0};
    for (size_t i = 0; i + 1 < border.size(); i += 2)
        if (const glm::dvec3 edge = border[i + 1] - border[i]; glm::length(edge) > glm::length(longest))
            longest = edge;
    if (glm::length(longest) == 0) return "0 by 0";
    const glm::dvec3 side = glm::normalize(longest);
    for (size_t i = 0; i + 1 < border.size(); i += 2)
        if (const glm::dvec3 c = glm::cross(side, border[i + 1] - border[i]);
            glm::length(c) > glm::length(across))
            across = c;
    const glm::dvec3 normal = glm::length(across) > kCollinear * glm::length(longest) ? glm::normalize(across)
                                                                                      : perpendicular(side);
    const double a = along(border, side), b = along(border, glm::cross(normal, side)),
                 depth = along(border, normal);
    if (depth > std::max(offPlane, kDeepOfSide * std::min(a, b)))
        return fmt::format("{:.3g} by {:.3g} by {:.3g}", a, b, depth);
    if (std::abs(normal.y) > kUpright) return fmt::format("{:.3g} by {:.3g}", a, b);
    return fmt::format("{:.3g} wide and {:.3g} high", along(border, perpendicular(normal)),
                       along(border, {0, 1, 0}));
}

} // namespace heliodon::geometry
