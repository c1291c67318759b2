// Serial double-precision gather and radiosity: oracles of shaders/radiosity_gather.comp and of the solver.
#pragma once

#include <span>
#include <vector>

namespace heliodon::compute::reference {

// `factors`: patchCount^2, row-major; `in` and what is returned: columns x patchCount.
// out[c][i] = sum_j F(i, j) in[c][j].
std::vector<double> gather(std::span<const float> factors, size_t patchCount, std::span<const float> in,
                           size_t columns);

// B = E + diag(rho) F B of one column, by Gaussian elimination with partial pivoting. Reflectances in [0, 1);
// `radiosity` has the unit of `emitted`, whose size says how many patches there are. O(n^3).
std::vector<double> radiosity(std::span<const float> factors, std::span<const float> reflectance,
                              std::span<const float> emitted);

} // namespace heliodon::compute::reference
