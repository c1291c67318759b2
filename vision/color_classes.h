// Every pixel of the table's region put into one of the paint classes of the paper, independent of the light
// that falls on it.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/rig.h"
#include "vision/detect.h"
#include "vision/plan_view.h"

namespace heliodon::vision {

enum class Paint : uint8_t { none, red, orange, yellow, green, cyan, sky, blue, magenta };
constexpr size_t kPaints = 9;

// Red and orange, and blue and light blue, differ too little in hue for single noisy pixels: they are one
// group here, and shape and majority tell them apart later.
constexpr Paint groupOf(Paint p) {
    return p == Paint::orange ? Paint::red : p == Paint::sky ? Paint::blue : p;
}

struct ClassImage {
    int x0 = 0, y0 = 0, width = 0, height = 0; // where it lies in the photograph
    std::vector<Paint> paint;                  // row-major
    bool hasTable = true;                      // false: nothing white and lit where the table should be
    LightGrid white;                           // what the pixels were held against

    // Photograph pixel; `none` outside.
    Paint at(int x, int y) const {
        const int i = x - x0, j = y - y0;
        if (i < 0 || j < 0 || i >= width || j >= height) return Paint::none;
        return paint[static_cast<size_t>(j) * static_cast<size_t>(width) + static_cast<size_t>(i)];
    }
};

// About 10 ms for 1392 x 1032.
ClassImage classifyPixels(const PlanView& view, const geometry::Rig& rig, const DetectOptions& options);

} // namespace heliodon::vision
