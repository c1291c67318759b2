// Pairs in the open that cubature in float32 serves ill: they nearly touch, or one lies nearly in the other's
// plane, as needles along an edge, wedges of a few degrees, small patches beside large ones and sheets across
// a narrow gap do. Directions good to 1e-7 err by much of what lies between such, and cells are many. They
// are done along contours, in double.
#pragma once

#include <vector>

#include <glm/vec4.hpp>

#include "compute/exact_scene.h"
#include "shaders/io/exact_form_factors.io.h"

namespace heliodon::compute {

// Moves such pairs to the end of `records` and returns their sums, in this order, as cubature leaves them.
// `tolerance`: of a form factor. On all cores; 0.1 ms for each such pair.
std::vector<glm::uvec4> sumsByContours(const ExactScene& scene, std::vector<io::ExactRecord>& records,
                                       double tolerance);

} // namespace heliodon::compute
