// Which planes of a mesh may lie on one another, seen from opposite sides, without comparing all with all.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "geometry/bounds.h"

namespace heliodon::compute {

// Of the plane through `point`; that of the same plane seen from its back is the negative.
inline double planeOrder(const glm::dvec3& normal, const glm::dvec3& point, const geometry::Bounds& box) {
    return glm::dot(normal, glm::dvec3(0.37, 0.61, 0.7)) +
           glm::dot(normal, point - box.centre()) / box.diagonal();
}

// Of `sheets`, which have ascending planeOrder()s as `order`: those behind `sheet`, one of them, that may lie
// in its plane and look the other way. So each pair is found once.
template<typename Sheet>
std::span<const Sheet> oppositeSheets(const std::vector<Sheet>& sheets, const Sheet& sheet) {
    constexpr double kAlike = 3e-3; // of orders of one plane
    const std::span<const Sheet> rest(&sheet + 1, sheets.data() + sheets.size());
    const auto first = std::ranges::lower_bound(rest, -sheet.order - kAlike, {}, &Sheet::order),
               end = std::ranges::upper_bound(rest, -sheet.order + kAlike, {}, &Sheet::order);
    return first < end ? std::span<const Sheet>(first, end) : std::span<const Sheet>();
}

} // namespace heliodon::compute
