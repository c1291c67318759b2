// What two convex polygons exchange with nothing between them, in double precision, on the host: of pairs
// that touch along needles or face each other across a gap of little of their size, where float32 loses the
// width and cubature needs cells by the million.
#pragma once

#include <span>

#include <glm/vec3.hpp>

namespace heliodon::compute {

// A_i F_ij, square metres; both counter-clockwise seen from their fronts, each is cut at the other's plane.
// Absolute error about 1e-9 of the smaller area. Cost: 10 us for each pair of edges.
double contourExchange(std::span<const glm::dvec3> from, std::span<const glm::dvec3> to);

} // namespace heliodon::compute
