#include "engine/passes/tile_mask.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

namespace heliodon::passes {

TileMask::TileMask(int width, int height, int tile)
    : width_(width), height_(height), tile_(tile), columns_((width + tile - 1) / tile),
      rows_((height + tile - 1) / tile),
      marked_(static_cast<size_t>(columns_) * static_cast<size_t>(rows_), 0) {}

TileMask::Range TileMask::rangeOf(glm::dvec2 low, glm::dvec2 high) const {
    // In this order what is no number is none.
    const auto within = [&](glm::dvec2 tile) {
        return glm::min(glm::dvec2(columns_, rows_), glm::max(glm::dvec2(0), tile));
    };
    const glm::dvec2 first = within(glm::floor(low / double(tile_))),
                     end = within(glm::floor(high / double(tile_)) + 1.0);
    return {static_cast<int>(first.x), static_cast<int>(first.y), static_cast<int>(end.x),
            static_cast<int>(end.y)};
}

void TileMask::mark(glm::dvec2 low, glm::dvec2 high) {
    const Range r = rangeOf(low, high);
    for (int y = r.y0; y < r.y1; ++y)
        for (int x = r.x0; x < r.x1; ++x) marked_[static_cast<size_t>(y * columns_ + x)] = 1;
}

bool TileMask::touches(glm::dvec2 low, glm::dvec2 high) const {
    const Range r = rangeOf(low, high);
    for (int y = r.y0; y < r.y1; ++y)
        for (int x = r.x0; x < r.x1; ++x)
            if (at(x, y)) return true;
    return false;
}

std::vector<PixelRect> TileMask::rectangles() const {
    TileMask left = *this;
    std::vector<PixelRect> found;
    for (int y = 0; y < rows_; ++y)
        for (int x = 0; x < columns_; ++x) {
            if (!left.at(x, y)) continue;
            int endX = x, endY = y + 1;
            while (endX < columns_ && left.at(endX, y)) ++endX;
            const auto full = [&](int row) {
                for (int k = x; k < endX; ++k)
                    if (!left.at(k, row)) return false;
                return true;
            };
            while (endY < rows_ && full(endY)) ++endY;
            for (int row = y; row < endY; ++row)
                for (int k = x; k < endX; ++k) left.marked_[static_cast<size_t>(row * columns_ + k)] = 0;
            const int px = x * tile_, py = y * tile_;
            found.push_back(
                {px, py, std::min(endX * tile_, width_) - px, std::min(endY * tile_, height_) - py});
        }
    return found;
}

} // namespace heliodon::passes
