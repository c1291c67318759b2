// Which tiles of a plane something lies in.
#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "engine/passes/view.h"

namespace heliodon::passes {

class TileMask {
public:
    // Tiles of `tile` x `tile` over the places from 0 to `width` and `height`.
    TileMask(int width, int height, int tile);

    // The tiles that a box touches; what lies outside is left out, and what ends at no number.
    void mark(glm::dvec2 low, glm::dvec2 high);
    bool touches(glm::dvec2 low, glm::dvec2 high) const;

    // Disjoint, of whole tiles cut at `width` and `height`: together all that is marked. Few and large where
    // that goes.
    std::vector<PixelRect> rectangles() const;

private:
    struct Range {
        int x0, y0, x1, y1; // tiles; ends are not in it
    };
    Range rangeOf(glm::dvec2 low, glm::dvec2 high) const;
    bool at(int x, int y) const { return marked_[static_cast<size_t>(y * columns_ + x)] != 0; }

    int width_, height_, tile_, columns_, rows_;
    std::vector<char> marked_;
};

} // namespace heliodon::passes
