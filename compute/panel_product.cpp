#include "compute/panel_product.h"

#include <algorithm>
#include <cassert>

#include "compute/parallel.h"

namespace heliodon::compute {

namespace {

constexpr size_t kMostRows = 6; // of a tile
constexpr size_t kBlock = 128;  // terms summed apart, so that rounding does not grow with the depth

using Tile = void (*)(const float* const* a, const float* panel, size_t depth, float (*sums)[Panels::kWidth]);

template<size_t kRows>
[[gnu::always_inline]] inline void addProducts(const float* const* a, const float* panel, size_t depth,
                                               float (*sums)[Panels::kWidth]) {
    for (size_t r = 0; r < kRows; ++r) std::fill_n(sums[r], Panels::kWidth, 0.0f);
    for (size_t k = 0; k < depth;) {
        float s[kRows][Panels::kWidth]{};
        for (const size_t end = std::min(depth, k + kBlock); k < end; ++k, panel += Panels::kWidth)
            for (size_t r = 0; r < kRows; ++r) {
                const float x = a[r][k];
                for (size_t c = 0; c < Panels::kWidth; ++c) s[r][c] += x * panel[c];
            }
        for (size_t r = 0; r < kRows; ++r)
            for (size_t c = 0; c < Panels::kWidth; ++c) sums[r][c] += s[r][c];
    }
}

struct Shape {
    size_t rows; // of a panel's width: as many sums as the registers hold beside their operands
    Tile tile;
};

void narrowTile(const float* const* a, const float* panel, size_t depth, float (*sums)[Panels::kWidth]) {
    addProducts<2>(a, panel, depth, sums);
}

#if defined(__x86_64__)
[[gnu::target("avx2,fma")]] void wideTile(const float* const* a, const float* panel, size_t depth,
                                          float (*sums)[Panels::kWidth]) {
    addProducts<6>(a, panel, depth, sums);
}
#endif

Shape shapeOfThisProcessor() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return {6, wideTile};
#endif
    return {2, narrowTile};
}

} // namespace

void multiply(std::span<const float> a, size_t rows, const Panels& panels, std::span<float> out) {
    const size_t depth = panels.depth(), columns = panels.columns();
    assert(a.size() >= rows * depth && out.size() >= rows * columns);
    const Shape shape = shapeOfThisProcessor();
    inParallel(panels.count(), [&](size_t p) {
        const size_t first = p * Panels::kWidth, width = std::min(Panels::kWidth, columns - first);
        float sums[kMostRows][Panels::kWidth];
        for (size_t row = 0; row < rows; row += shape.rows) {
            const float* from[kMostRows]; // rows beyond the last are computed from the last and not stored
            for (size_t r = 0; r < shape.rows; ++r) from[r] = a.data() + std::min(row + r, rows - 1) * depth;
            shape.tile(from, panels.panel(p), depth, sums);
            for (size_t r = 0; r < shape.rows && row + r < rows; ++r)
                std::copy_n(sums[r], width, &out[(row + r) * columns + first]);
        }
    });
}

} // namespace heliodon::compute
