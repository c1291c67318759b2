// To how many decimals a file's coordinates are rounded.
#pragma once

#include <span>

#include <glm/vec3.hpp>

namespace heliodon::geometry {

// The largest of 1, 0.1, 0.01 ... of which all coordinates are multiples, as single precision has them; 0
// where that is `least` (above 0) or less, or fewer than two in five need its last digit, as where it was
// typed. Cost: n.
double lastDecimal(std::span<const glm::dvec3> points, double least);

} // namespace heliodon::geometry
