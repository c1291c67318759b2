#include "vision/homography.h"

#include <cmath>

#include <glm/glm.hpp>

namespace heliodon::vision {
namespace {

// Points as columns; none when they are nearly on a line.
std::optional<glm::dmat3> columns(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
    const glm::dmat3 out(glm::dvec3(a, 1), glm::dvec3(b, 1), glm::dvec3(c, 1));
    const double size = glm::distance(a, c);
    if (!(std::abs(glm::determinant(out)) > 1e-3 * size * size)) return std::nullopt;
    return out;
}

glm::dmat3 scaled(const glm::dmat3& m, glm::dvec3 by) {
    return {m[0] * by.x, m[1] * by.y, m[2] * by.z};
}

// The map that takes the projective basis to the four points (R. Hartley and A. Zisserman, Multiple View
// Geometry, 2003, section 2.3): columns are the first three, scaled so that their sum is the fourth.
std::optional<glm::dmat3> fromBasis(const std::array<glm::dvec2, 4>& p) {
    const auto corners = columns(p[0], p[1], p[2]);
    if (!corners) return std::nullopt;
    const glm::dvec3 scale = glm::inverse(*corners) * glm::dvec3(p[3], 1);
    for (int i = 0; i < 3; ++i)
        if (!(std::abs(scale[i]) > 1e-3)) return std::nullopt;
    return scaled(*corners, scale);
}

} // namespace

std::optional<Homography> homographyThrough(const std::array<glm::dvec2, 4>& from,
                                            const std::array<glm::dvec2, 4>& to) {
    const auto a = fromBasis(from), b = fromBasis(to);
    if (!a || !b) return std::nullopt;
    Homography out{*b * glm::inverse(*a)};
    out.matrix /= out.matrix[2][2];
    return out;
}

std::optional<Homography> homographyFromDisks(const std::array<glm::dvec2, 3>& from,
                                              const std::array<glm::dvec2, 3>& to,
                                              const std::array<double, 3>& radius) {
    const auto a = columns(from[0], from[1], from[2]), b = columns(to[0], to[1], to[2]);
    if (!a || !b) return std::nullopt;
    const auto depth = [&](size_t i) { return std::cbrt(1 / (radius[i] * radius[i])); };
    Homography out{scaled(*b, {depth(0), depth(1), depth(2)}) * glm::inverse(*a)};
    out.matrix /= out.matrix[2][2];
    return out;
}

} // namespace heliodon::vision
