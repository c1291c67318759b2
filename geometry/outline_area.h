// Areas of outlines, in a plane and of plane ones in space.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "geometry/perpendicular.h"

namespace heliodon::geometry {

// Twice the area, along the normal about which the outline runs counter-clockwise. at(0) .. at(count - 1):
// its corners; taken from the first, so that nothing cancels far from the origin.
template<class CornerAt> glm::dvec3 areaVector(size_t count, const CornerAt& at) {
    glm::dvec3 sum{0};
    for (size_t k = 1; k + 1 < count; ++k) sum += glm::cross(at(k) - at(0), at(k + 1) - at(0));
    return sum;
}

inline glm::dvec3 areaVector(std::span<const glm::dvec3> outline) {
    return areaVector(outline.size(), [&](size_t k) { return outline[k]; });
}

// Signed, positive where it runs counter-clockwise; of outlines that touch themselves, too.
inline double twiceArea(std::span<const glm::dvec2> outline) {
    double sum = 0;
    for (size_t k = 0; k < outline.size(); ++k) sum += cross(outline[k], outline[(k + 1) % outline.size()]);
    return sum;
}

inline double perimeter(std::span<const glm::dvec3> outline) {
    double sum = 0;
    for (size_t k = 0; k < outline.size(); ++k)
        sum += glm::length(outline[(k + 1) % outline.size()] - outline[k]);
    return sum;
}

inline glm::dvec3 areaVector(std::span<const glm::dvec3> vertices, std::span<const uint32_t> outline) {
    return areaVector(outline.size(), [&](size_t k) { return vertices[outline[k]]; });
}

// Whether normals of length one are those of one plane: files hold 6 or 7 digits.
inline bool inOnePlane(glm::dvec3 a, glm::dvec3 b) {
    constexpr double kSine = 1e-4;
    return glm::dot(a, b) > 0 && glm::length(glm::cross(a, b)) < kSine;
}

} // namespace heliodon::geometry
