#include "vision/vivid_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "vision/chroma.h"

namespace heliodon::vision {
namespace {

constexpr size_t kBins = 64;
constexpr double kLeastShare = 0.15; // of either kind
using Histogram = std::array<double, kBins>;

float saturationAt(int x, int y, const PlanView& view) {
    const glm::dvec2 pixel(x, y);
    return saturationOf(view.light(pixel) / view.white(pixel));
}

// Otsu, "A threshold selection method from gray-level histograms", 1979: the bin that begins the upper of two
// kinds. None where they do not explain most of the variance: an even spread has 0.75 between its halves.
std::optional<size_t> threshold(const Histogram& histogram) {
    constexpr double kTwoKinds = 0.75;
    double all = 0, sum = 0, squares = 0;
    for (size_t i = 0; i < kBins; ++i) {
        const double v = static_cast<double>(i);
        all += histogram[i], sum += histogram[i] * v, squares += histogram[i] * v * v;
    }
    const double variance = squares / all - sum / all * (sum / all);
    double best = 0, below = 0, sumBelow = 0;
    size_t at = 0;
    for (size_t i = 0; i + 1 < kBins; ++i) {
        below += histogram[i], sumBelow += histogram[i] * static_cast<double>(i);
        const double above = all - below;
        if (std::min(below, above) < kLeastShare * all) continue;
        const double apart = (sum - sumBelow) / above - sumBelow / below;
        const double between = below * above / (all * all) * apart * apart;
        if (between > best) best = between, at = i + 1;
    }
    if (best <= kTwoKinds * variance) return std::nullopt;
    return at;
}

// As large as the region, without paint.
ClassImage emptyPart(const Component& region, const ClassImage& image) {
    ClassImage out;
    int x1 = 0;
    out.x0 = image.x0 + image.width, out.y0 = region.runs.front().y;
    for (const Run& run : region.runs) out.x0 = std::min(out.x0, run.x0), x1 = std::max(x1, run.x1);
    out.width = x1 - out.x0, out.height = region.runs.back().y + 1 - out.y0;
    out.paint.assign(static_cast<size_t>(out.width) * static_cast<size_t>(out.height), Paint::none);
    return out;
}

} // namespace

std::optional<ClassImage> vividPart(const Component& region, const ClassImage& image, const PlanView& view) {
    ClassImage out = emptyPart(region, image);
    std::vector<size_t> bins;
    Histogram histogram{};
    for (const Run& run : region.runs)
        for (int x = run.x0; x < run.x1; ++x) {
            bins.push_back(std::min(kBins - 1, static_cast<size_t>(saturationAt(x, run.y, view) * kBins)));
            histogram[bins.back()] += 1;
        }
    const auto vivid = threshold(histogram);
    if (!vivid) return std::nullopt;
    auto bin = bins.begin();
    for (const Run& run : region.runs)
        for (int x = run.x0; x < run.x1; ++x)
            if (*bin++ >= *vivid) out.set(x, run.y, image.at(x, run.y));
    return out;
}

ClassImage partOf(const Component& region, const ClassImage& image, Paint paint) {
    ClassImage out = emptyPart(region, image);
    for (const Run& run : region.runs)
        for (int x = run.x0; x < run.x1; ++x)
            if (image.at(x, run.y) == paint) out.set(x, run.y, paint);
    return out;
}

std::optional<ClassImage> bluePart(const Component& region, const ClassImage& image) {
    const double sky = static_cast<double>(region.minorityArea) / region.area;
    if (region.group != Paint::blue || sky < kLeastShare || sky > 1 - kLeastShare) return std::nullopt;
    return partOf(region, image, Paint::blue);
}

} // namespace heliodon::vision
