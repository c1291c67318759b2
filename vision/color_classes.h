// Every pixel of the table's region put into one of the paint classes of the paper, independent of the light
// that falls on it.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/rig.h"
#include "vision/detect.h"
#include "vision/plan_view.h"
#include "vision/white_map.h"

namespace heliodon::vision {

enum class Paint : uint8_t { none, red, orange, yellow, green, cyan, sky, blue, magenta };
constexpr size_t kPaints = 9;

// Red and orange, and blue and light blue, differ too little in hue for single noisy pixels: they are one
// group here, and shape and majority tell them apart later.
constexpr Paint groupOf(Paint p) {
    return p == Paint::orange ? Paint::red : p == Paint::sky ? Paint::blue : p;
}

constexpr bool isWallPaint(Paint p) {
    return p == Paint::red || p == Paint::blue || p == Paint::green;
}
constexpr bool isMarker(Paint p) {
    return p == Paint::cyan || p == Paint::magenta || p == Paint::yellow;
}

struct ClassImage {
    int x0 = 0, y0 = 0, width = 0, height = 0; // where it lies in the photograph
    std::vector<Paint> paint;                  // row-major
    // The same, with what is too pale to be told from shadows by itself; may be empty.
    std::vector<Paint> withFaint;
    bool hasTable = true;        // false: nothing white and lit where the table should be
    LightGrid white;             // what the pixels were held against
    double noise = 0;            // of a pixel that is white, over its value
    double faintShare = 0;       // of the table's pixels: neither white nor vivid enough for paint
    bool hidesSky = false;       // light-blue card has the table's colour
    bool twoLights = false;      // of different colours, each with shadows of its own
    bool shadeHidesSky = false;  // it is white in shadows that light of another colour reaches
    glm::vec3 whiteOverTable{1}; // where that is card on a table of another colour

    // Photograph pixel; `none` outside.
    Paint at(int x, int y) const {
        const int i = x - x0, j = y - y0;
        if (i < 0 || j < 0 || i >= width || j >= height) return Paint::none;
        return paint[static_cast<size_t>(j) * static_cast<size_t>(width) + static_cast<size_t>(i)];
    }
    // The pixel must be within.
    void set(int x, int y, Paint as) {
        paint[static_cast<size_t>(y - y0) * static_cast<size_t>(width) + static_cast<size_t>(x - x0)] = as;
    }
    // The group of the pixel that a position in the photograph lies in.
    Paint groupAt(glm::dvec2 pixel) const {
        return groupOf(at(static_cast<int>(std::lround(pixel.x)), static_cast<int>(std::lround(pixel.y))));
    }
};

// `card`: see findWhite. About 10 ms for 1392 x 1032.
ClassImage classifyPixels(const PlanView& view, const geometry::Rig& rig, const DetectOptions& options,
                          const std::optional<CardWhite>& card = std::nullopt);

} // namespace heliodon::vision
