#include "compute/panel_product.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "compute/parallel.h"

namespace heliodon::compute {

namespace {

using Tile = void (*)(const float* const* a, const float* panel, size_t depth, float (*sums)[Panels::kWidth]);

template<size_t kLanes> struct Vector { using Floats [[gnu::vector_size(kLanes * sizeof(float))]] = float; };

// Sums stay in registers where the loops over them are unrolled.
template<size_t kRows, size_t kLanes>
[[gnu::always_inline]] inline void addProducts(const float* const* a, const float* panel, size_t depth,
                                               float (*sums)[Panels::kWidth]) {
    using Floats = typename Vector<kLanes>::Floats;
    constexpr size_t kParts = Panels::kWidth / kLanes;
    for (size_t r = 0; r < kRows; ++r) std::fill_n(sums[r], Panels::kWidth, 0.0f);
    for (size_t k = 0; k < depth;) {
        Floats s[kRows][kParts]{};
        for (const size_t end = std::min(depth, k + Panels::kBlock); k < end; ++k, panel += Panels::kWidth) {
#pragma GCC unroll 16
            for (size_t c = 0; c < kParts; ++c) {
                Floats part;
                std::memcpy(&part, panel + c * kLanes, sizeof part);
#pragma GCC unroll 16
                for (size_t r = 0; r < kRows; ++r) s[r][c] += a[r][k] * part;
            }
        }
#pragma GCC unroll 16
        for (size_t r = 0; r < kRows; ++r)
#pragma GCC unroll 16
            for (size_t c = 0; c < kParts; ++c) {
                Floats sum;
                std::memcpy(&sum, sums[r] + c * kLanes, sizeof sum);
                sum += s[r][c];
                std::memcpy(sums[r] + c * kLanes, &sum, sizeof sum);
            }
    }
}

// Tiles of 1, 2, ... rows of a panel's width: as many sums as the registers hold beside their operands.
constexpr size_t kMostRows = 12;
using Tiles = std::span<const Tile>;

template<size_t kRows>
void narrowTile(const float* const* a, const float* panel, size_t depth, float (*sums)[Panels::kWidth]) {
    addProducts<kRows, 4>(a, panel, depth, sums);
}
constexpr Tile kNarrow[]{narrowTile<1>, narrowTile<2>, narrowTile<3>};

#if defined(__x86_64__)
template<size_t kRows>
[[gnu::target("avx2")]] void wideTile(const float* const* a, const float* panel, size_t depth,
                                      float (*sums)[Panels::kWidth]) {
    addProducts<kRows, 8>(a, panel, depth, sums);
}
constexpr Tile kWide[]{wideTile<1>, wideTile<2>, wideTile<3>, wideTile<4>, wideTile<5>, wideTile<6>};

template<size_t kRows>
[[gnu::target("avx512f")]] void widestTile(const float* const* a, const float* panel, size_t depth,
                                           float (*sums)[Panels::kWidth]) {
    addProducts<kRows, 16>(a, panel, depth, sums);
}
constexpr Tile kWidest[]{widestTile<1>, widestTile<2>,  widestTile<3>,  widestTile<4>,
                         widestTile<5>, widestTile<6>,  widestTile<7>,  widestTile<8>,
                         widestTile<9>, widestTile<10>, widestTile<11>, widestTile<12>};
static_assert(std::size(kWidest) <= kMostRows);
#endif

Tiles tilesOf([[maybe_unused]] VectorWidth width) {
#if defined(__x86_64__)
    if (width == VectorWidth::avx512) return kWidest;
    if (width == VectorWidth::avx2) return kWide;
#endif
    return kNarrow;
}

} // namespace

void multiply(std::span<const float> a, size_t rows, const Panels& panels, std::span<float> out,
              VectorWidth width) {
    const size_t depth = panels.depth(), columns = panels.columns();
    assert(a.size() >= rows * depth && out.size() >= rows * columns);
    const Tiles tiles = tilesOf(width);
    inParallel(panels.count(), [&](size_t p) {
        const size_t first = p * Panels::kWidth, count = std::min(Panels::kWidth, columns - first);
        float sums[kMostRows][Panels::kWidth];
        for (size_t row = 0; row < rows;) {
            // Shared out evenly: of thirteen rows seven and six.
            const size_t left = rows - row, times = (left + tiles.size() - 1) / tiles.size(),
                         height = (left + times - 1) / times;
            const float* from[kMostRows];
            for (size_t r = 0; r < height; ++r) from[r] = a.data() + (row + r) * depth;
            tiles[height - 1](from, panels.panel(p), depth, sums);
            for (size_t r = 0; r < height; ++r, ++row)
                std::copy_n(sums[r], count, &out[row * columns + first]);
        }
    });
}

} // namespace heliodon::compute
