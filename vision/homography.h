// The projective map of one plane to another.
#pragma once

#include <array>
#include <optional>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace heliodon::vision {

struct Homography {
    glm::dmat3 matrix{1};
    glm::dvec2 operator()(glm::dvec2 p) const {
        const glm::dvec3 h = matrix * glm::dvec3(p, 1);
        return glm::dvec2(h) / h.z;
    }
};

// The one that takes four points to four others; none when three of them are nearly on a line.
std::optional<Homography> homographyThrough(const std::array<glm::dvec2, 4>& from,
                                            const std::array<glm::dvec2, 4>& to);

// The one that takes three points to three others where circles at the former look `radius` large (of the
// circle of the same area): the area changes with the third power of the point's depth. None when the points
// are nearly on a line.
std::optional<Homography> homographyFromDisks(const std::array<glm::dvec2, 3>& from,
                                              const std::array<glm::dvec2, 3>& to,
                                              const std::array<double, 3>& radius);

} // namespace heliodon::vision
