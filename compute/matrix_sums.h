// What closure and reciprocity of a matrix of form factors are measured by: on the device where the host does
// not see its memory, since all of it would have to cross the bus.
#pragma once

#include <span>
#include <vector>

#include "compute/gpu/buffer.h"

namespace heliodon::compute {

struct MatrixSums {
    std::vector<double> rows;      // sum of each; to 1e-12 of it
    double reciprocitySquares = 0; // sum over pairs of (A_i F_ij - A_j F_ji)^2; on the device to 1e-6 of it
};

// `values`: float32, n x n, row-major, n the count of `area`. Throws gpu::Error.
MatrixSums sumsOfMatrix(gpu::Device& device, const gpu::Buffer& values, std::span<const double> area);

} // namespace heliodon::compute
