// To how many decimals, or bits, a file's coordinates are rounded.
#pragma once

#include <span>

#include <glm/vec3.hpp>

namespace heliodon::geometry {

// The largest of 1, 0.1, 0.01 ... of which all coordinates are multiples, as single precision has them; 0
// where that is `least` (above 0) or less, or fewer than two in five need its last digit, as where it was
// typed. Cost: n.
double lastDecimal(std::span<const glm::dvec3> points, double least);

// Of the largest coordinate, where all are of single precision, as of a building far from the origin; 0 where
// that is `least` or less, or fewer than one in four of its size need that bit. Cost: n.
double lastBit(std::span<const glm::dvec3> points, double least);

double singleStep(double value); // to the next larger number of single precision

} // namespace heliodon::geometry
