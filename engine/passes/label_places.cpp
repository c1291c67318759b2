// Candidates about each outline, the cheapest taken in turn until none moves: J. Christensen, J. Marks, S.
// Shieber, "An Empirical Study of Algorithms for Point-Feature Label Placement", 1995, its discrete descent.
#include "engine/passes/label_places.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace heliodon::passes {

namespace {

constexpr int kDirections = 24, kSweeps = 6;
constexpr double kStep = 1, kFarthest = 200, kApart = 2; // pixels
constexpr double kAside = 0.3; // of cost, a pixel between middles: words stand square to what they name
constexpr double kCovered = 1e3,
                 kCrossed = 0.5; // in pixels further away, of a pixel of an outline, of a line

// Where a polygon's border crosses a row, in order: it is inside from each first to each second.
std::vector<double> crossings(const std::vector<glm::dvec2>& outline, double y) {
    std::vector<double> at;
    for (size_t i = 0; i < outline.size(); ++i) {
        const glm::dvec2 a = outline[i], b = outline[(i + 1) % outline.size()];
        if ((a.y > y) != (b.y > y)) at.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
    }
    std::ranges::sort(at);
    return at;
}

// Where a label starts from: the outline's middle, or for an arc the point of it that is nearest to that.
glm::dvec2 anchorOf(const std::vector<glm::dvec2>& outline) {
    glm::dvec2 middle{};
    for (const glm::dvec2& p : outline) middle += p / static_cast<double>(outline.size());
    const auto left =
        std::ranges::count_if(crossings(outline, middle.y), [&](double x) { return x < middle.x; });
    if (left % 2 != 0) return middle;
    return *std::ranges::min_element(outline, {},
                                     [&](const glm::dvec2& p) { return glm::distance(p, middle); });
}

// What it costs to cover each pixel, as sums over all above and left.
class Ground {
public:
    Ground(const Box& within, std::span<const Label> labels, double clear, std::span<const Line> lines)
        : within_(within), clear_(clear), width_(cells(within.high.x - within.low.x)),
          height_(cells(within.high.y - within.low.y)), sums_((width_ + 1) * (height_ + 1), 0) {
        for (const Line& line : lines) trace(line[0], line[1], kCrossed);
        for (const Label& label : labels) fill(label.outline);
        for (size_t y = 1; y <= height_; ++y)
            for (size_t x = 1; x <= width_; ++x) at(x, y) += at(x - 1, y) + at(x, y - 1) - at(x - 1, y - 1);
    }

    // Infinite where the box leaves `within`.
    double under(const Box& box) const {
        if (!within_.contains(box)) return std::numeric_limits<double>::infinity();
        const glm::dvec2 size(static_cast<double>(width_), static_cast<double>(height_)), none(0);
        const glm::dvec2 low = glm::clamp(glm::floor(box.low - clear_ - within_.low), none, size),
                         high = glm::clamp(glm::ceil(box.high + clear_ - within_.low), none, size);
        const auto x0 = static_cast<size_t>(low.x), y0 = static_cast<size_t>(low.y),
                   x1 = static_cast<size_t>(high.x), y1 = static_cast<size_t>(high.y);
        return at(x1, y1) - at(x0, y1) - at(x1, y0) + at(x0, y0);
    }

private:
    static size_t cells(double length) { return static_cast<size_t>(std::ceil(std::max(length, 0.0))); }
    double& at(size_t x, size_t y) { return sums_[y * (width_ + 1) + x]; }
    double at(size_t x, size_t y) const { return sums_[y * (width_ + 1) + x]; }

    void mark(double x, double y, double cost) { // from `within`'s corner
        if (!(x >= 0 && y >= 0 && x < static_cast<double>(width_) && y < static_cast<double>(height_)))
            return;
        double& cell = at(static_cast<size_t>(x) + 1, static_cast<size_t>(y) + 1);
        cell = std::max(cell, cost);
    }

    void trace(glm::dvec2 from, glm::dvec2 to, double cost) {
        const int steps = 1 + static_cast<int>(std::min(2 * glm::distance(from, to), 1e5));
        for (int i = 0; i <= steps; ++i) {
            const glm::dvec2 p = glm::mix(from, to, static_cast<double>(i) / steps) - within_.low;
            mark(p.x, p.y, cost);
        }
    }

    void fill(const std::vector<glm::dvec2>& outline) {
        for (size_t i = 0; i < outline.size(); ++i)
            trace(outline[i], outline[(i + 1) % outline.size()], kCovered);
        for (size_t row = 0; row < height_; ++row) {
            const double y = static_cast<double>(row) + 0.5;
            const std::vector<double> ends = crossings(outline, within_.low.y + y);
            for (size_t i = 0; i + 1 < ends.size(); i += 2) {
                const double from = std::max(ends[i] - within_.low.x, 0.0),
                             to = std::min(ends[i + 1] - within_.low.x, static_cast<double>(width_));
                for (double x = std::floor(from) + 0.5; x < to; ++x) mark(x, y, kCovered);
            }
        }
    }

    Box within_;
    double clear_;
    size_t width_, height_;
    std::vector<double> sums_;
};

// Pixels in which they come too close.
double common(const Box& a, const Box& b) {
    const glm::dvec2 overlap = glm::min(a.high, b.high) - glm::max(a.low, b.low) + kApart;
    return std::max(0.0, overlap.x) * std::max(0.0, overlap.y);
}

// The cheapest of its places beside `others`.
Box placeOf(const Label& label, glm::dvec2 anchor, const Ground& ground, std::span<const Box> others) {
    Box best{anchor - 0.5 * label.size, anchor + 0.5 * label.size};
    double least = std::numeric_limits<double>::infinity();
    for (double away = 0; away < kFarthest; away += kStep)
        for (int k = 0; k < kDirections; ++k) {
            const double angle = 2 * std::numbers::pi * k / kDirections;
            const glm::dvec2 direction(std::cos(angle), std::sin(angle)), middle = anchor + away * direction;
            const Box box{middle - 0.5 * label.size, middle + 0.5 * label.size};
            double cost = glm::distance(anchor, glm::clamp(anchor, box.low, box.high)) + kAside * away +
                          glm::length(label.towards) - glm::dot(direction, label.towards);
            if (cost >= least) continue;
            cost += ground.under(box);
            for (const Box& other : others) cost += kCovered * common(box, other);
            if (cost < least) least = cost, best = box;
        }
    return best;
}

} // namespace

std::vector<Box> placeLabels(std::span<const Label> labels, const Box& within, double clear,
                             std::span<const Line> lines) {
    const Ground ground(within, labels, clear, lines);
    std::vector<size_t> order(labels.size()); // wide ones first: they fit in fewer places
    std::iota(order.begin(), order.end(), size_t{0});
    std::ranges::stable_sort(order, std::ranges::greater{}, [&](size_t i) { return labels[i].size.x; });
    std::vector<glm::dvec2> anchors;
    for (const Label& label : labels) anchors.push_back(anchorOf(label.outline));
    constexpr Box kNowhere{{-1e9, -1e9}, {-1e9, -1e9}};
    std::vector<Box> boxes(labels.size(), kNowhere);
    bool moved = true;
    for (int sweep = 0; sweep < kSweeps && moved; ++sweep) {
        moved = false;
        for (const size_t i : order) {
            const Box before = std::exchange(boxes[i], kNowhere);
            boxes[i] = placeOf(labels[i], anchors[i], ground, boxes);
            moved |= boxes[i] != before;
        }
    }
    return boxes;
}

} // namespace heliodon::passes
