// Products of float matrices on the host, where one factor is used again and again: it is packed once into
// panels of sixteen columns, which stream through the first-level cache.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "compute/vector_width.h"

namespace heliodon::compute {

class Panels {
public:
    static constexpr size_t kWidth = 16;
    static constexpr size_t kBlock = 128; // terms summed apart, so that rounding does not grow with the depth

    Panels() = default;
    Panels(size_t depth, size_t columns) : depth_(depth), columns_(columns) {
        values_.resize((columns + kWidth - 1) / kWidth * kWidth * depth);
    }
    size_t depth() const { return depth_; }
    size_t columns() const { return columns_; }
    size_t count() const { return (columns_ + kWidth - 1) / kWidth; }
    size_t bytes() const { return values_.size() * sizeof(float); }
    float& at(size_t row, size_t column) {
        return values_[(column / kWidth * depth_ + row) * kWidth + column % kWidth];
    }
    const float* panel(size_t p) const { return values_.data() + p * depth_ * kWidth; }

private:
    size_t depth_ = 0, columns_ = 0;
    std::vector<float> values_;
};

// out(r, c) = sum_k a(r, k) panels(k, c), row-major, `rows` rows: the sum over blocks, in their order, of the
// sum over each block's terms, in theirs, without fused multiplications, so the same bits on every processor.
// On all cores; about 1.3e10 multiplications a second and core, 2.5e10 with AVX2, 5e10 to 9e10 with AVX-512,
// of many rows.
void multiply(std::span<const float> a, size_t rows, const Panels& panels, std::span<float> out,
              VectorWidth width = widestVectors());

} // namespace heliodon::compute
