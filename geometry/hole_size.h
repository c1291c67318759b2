// How large a hole in a model is, in words.
#pragma once

#include <span>
#include <string>

#include <glm/vec3.hpp>

namespace heliodon::geometry {

// Of the hole within a border, given by both ends of each of its edges: "1 wide and 2 high" where it stands
// upright, "5 by 4" along its longest edge and across where it lies or leans, and with a third length where
// it is no plane hole: deeper than `offPlane`, and than a tenth of its lesser side.
std::string sizeOfHole(std::span<const glm::dvec3> border, double offPlane);

} // namespace heliodon::geometry
