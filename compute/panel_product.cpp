#include "compute/panel_product.h"

#include <algorithm>
#include <cassert>

#include "compute/parallel.h"

namespace heliodon::compute {

namespace {

constexpr size_t kRows =
    4; // x 8 columns: as many sums as 16 registers of four floats hold beside their operands

// `rows` at most kRows; rows beyond are computed from the last and not stored.
void tile(const float* const a[kRows], const float* panel, size_t depth, float sums[kRows][Panels::kWidth]) {
    float s[kRows][Panels::kWidth]{};
    for (size_t k = 0; k < depth; ++k, panel += Panels::kWidth)
        for (size_t r = 0; r < kRows; ++r) {
            const float x = a[r][k];
            for (size_t c = 0; c < Panels::kWidth; ++c) s[r][c] += x * panel[c];
        }
    for (size_t r = 0; r < kRows; ++r) std::copy_n(s[r], Panels::kWidth, sums[r]);
}

} // namespace

void multiply(std::span<const float> a, size_t rows, const Panels& panels, std::span<float> out) {
    const size_t depth = panels.depth(), columns = panels.columns();
    assert(a.size() >= rows * depth && out.size() >= rows * columns);
    inParallel(panels.count(), [&](size_t p) {
        const size_t first = p * Panels::kWidth, width = std::min(Panels::kWidth, columns - first);
        float sums[kRows][Panels::kWidth];
        for (size_t row = 0; row < rows; row += kRows) {
            const float* from[kRows];
            for (size_t r = 0; r < kRows; ++r) from[r] = a.data() + std::min(row + r, rows - 1) * depth;
            tile(from, panels.panel(p), depth, sums);
            for (size_t r = 0; r < kRows && row + r < rows; ++r)
                std::copy_n(sums[r], width, &out[(row + r) * columns + first]);
        }
    });
}

} // namespace heliodon::compute
