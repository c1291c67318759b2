// Walls that touch or cross make one region of paint, and so does a wall with a patch of the same colour
// behind it: cloth beside the table, a hand, the floor. What is wider than any joint of walls is taken away
// first; the rest falls into straight strips, the longest first, each followed only as far as it is filled.
#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "vision/edges.h"
#include "vision/pieces.h"
#include "vision/wall_fit.h"

namespace heliodon::vision {
namespace {

struct Pixel {
    glm::dvec2 plan;
    int x, y;
    bool taken = false; // by a strip: it may still carry another one that crosses
};

// Two strips that cross at right angles hold a circle of 0.71 of their width; slanted ones a little more.
constexpr double kWidestJoint = 0.85;
constexpr int kTrials = 150;
constexpr size_t kMostStrips = 16;
constexpr size_t kMostPixels = 6000; // more are thinned out while a strip is sought

void append(Component& component, int x, int y) {
    auto& runs = component.runs;
    if (!runs.empty() && runs.back().y == y && runs.back().x1 == x)
        ++runs.back().x1;
    else
        runs.push_back({y, x, x + 1});
    component.centre += glm::dvec2(x, y);
    ++component.area;
}

// A straight band and the stretch along it that is filled without a gap.
struct Band {
    glm::dvec2 from{}, along{1, 0};
    double low = 0, high = 0, reach = 0;
    double filled = 0; // pixels that no other strip has
    bool holds(glm::dvec2 p) const {
        const double s = glm::dot(p - from, along);
        return s >= low && s <= high && std::abs(glm::dot(p - from, turnedLeft(along))) < reach;
    }
};

// The longest stretch whose every step of half a width holds more than half of the pixels that it can.
void followFilled(Band& band, const std::vector<Pixel>& pixels, size_t stride, double width,
                  double pixelsPerSquareInch) {
    constexpr int kHalf = 400;
    const double step = 0.5 * width;
    std::array<int, 2 * kHalf> bins{}, fresh{};
    for (size_t i = 0; i < pixels.size(); i += stride) {
        const glm::dvec2 p = pixels[i].plan - band.from;
        if (std::abs(glm::dot(p, turnedLeft(band.along))) >= band.reach) continue;
        const int bin = static_cast<int>(std::floor(glm::dot(p, band.along) / step)) + kHalf;
        if (bin < 0 || bin >= 2 * kHalf) continue;
        ++bins[static_cast<size_t>(bin)];
        fresh[static_cast<size_t>(bin)] += !pixels[i].taken;
    }
    const double enough = 0.55 * step * width * pixelsPerSquareInch / static_cast<double>(stride);
    int begin = -1, sum = 0;
    for (int i = 0; i <= 2 * kHalf; ++i) {
        const int n = i < 2 * kHalf ? bins[static_cast<size_t>(i)] : 0;
        if (n > enough) {
            if (begin < 0) begin = i, sum = 0;
            sum += fresh[static_cast<size_t>(i)];
            continue;
        }
        if (begin >= 0 && sum * static_cast<double>(stride) > band.filled) {
            // Half a step more at either end, which is filled in part.
            band.low = (begin - kHalf - 0.5) * step, band.high = (i - kHalf + 0.5) * step;
            band.filled = sum * static_cast<double>(stride);
        }
        begin = -1;
    }
}

} // namespace

std::vector<Component> thinParts(const Component& component, const PlanView& view,
                                 const DetectOptions& options) {
    const double height = heightOf(component.group);
    const double perInch = view.pixelsPerInch(view.plan(component.centre, height), height);
    const double radius = kWidestJoint * options.wallThickness * perInch + 1;
    int x0 = component.runs.front().x0, x1 = x0;
    const int y0 = component.runs.front().y, y1 = component.runs.back().y + 1;
    for (const Run& run : component.runs) x0 = std::min(x0, run.x0), x1 = std::max(x1, run.x1);
    cv::Mat mask = cv::Mat::zeros(y1 - y0 + 2, x1 - x0 + 2, CV_8U);
    for (const Run& run : component.runs)
        mask.row(run.y - y0 + 1).colRange(run.x0 - x0 + 1, run.x1 - x0 + 1).setTo(1);
    cv::Mat depth, label;
    cv::distanceTransform(mask, depth, cv::DIST_L2, 3);
    const cv::Mat wide = depth > radius;
    if (cv::countNonZero(wide) == 0) return {component};
    cv::distanceTransform(wide == 0, depth, cv::DIST_L2, 3); // every pixel within reach of the wide part
    mask.setTo(0, depth <= radius + 1.5);
    const int labels = cv::connectedComponents(mask, label, 4);
    std::vector<Component> out(static_cast<size_t>(labels));
    for (int y = 0; y < label.rows; ++y)
        for (int x = 0; x < label.cols; ++x)
            if (const int k = label.at<int>(y, x))
                append(out[static_cast<size_t>(k)], x + x0 - 1, y + y0 - 1);
    const double least = 0.5 * options.wallThickness * perInch * perInch;
    std::erase_if(out, [&](const Component& part) { return part.area < least; });
    for (Component& part : out) part.group = component.group, part.centre /= part.area;
    return out;
}

std::vector<Component> splitStrips(const Component& component, const PlanView& view,
                                   const DetectOptions& options) {
    const double height = heightOf(component.group), width = options.wallThickness;
    const double perInch = view.pixelsPerInch(view.plan(component.centre, height), height);
    std::vector<Pixel> pixels;
    for (const Run& run : component.runs)
        for (int x = run.x0; x < run.x1; ++x)
            pixels.push_back({view.plan(glm::dvec2(x, run.y), height), x, run.y});
    const double enough = 0.6 * width * perInch * perInch; // pixels; the paint of the shortest wall is longer
    std::vector<Component> out;
    uint32_t random = 12345; // the same every time: detection is deterministic
    auto pick = [&] { return (random = random * 1664525u + 1013904223u) >> 8; };
    const size_t stride = 1 + pixels.size() / kMostPixels;
    while (out.size() < kMostStrips) {
        std::vector<size_t> fresh;
        for (size_t i = 0; i < pixels.size(); ++i)
            if (!pixels[i].taken) fresh.push_back(i);
        if (static_cast<double>(fresh.size()) < enough) break;
        Band best;
        for (int trial = 0; trial < kTrials; ++trial) {
            const glm::dvec2 a = pixels[fresh[pick() % fresh.size()]].plan,
                             b = pixels[fresh[pick() % fresh.size()]].plan;
            if (glm::distance(a, b) < 2 * width) continue;
            Band band{a, glm::normalize(b - a), 0, 0, 0.6 * width, 0};
            followFilled(band, pixels, stride, width, perInch * perInch);
            if (band.filled > best.filled) best = band;
        }
        if (best.filled < enough) break;
        Component strip;
        strip.group = component.group;
        for (Pixel& p : pixels) {
            if (!best.holds(p.plan)) continue;
            p.taken = true;
            append(strip, p.x, p.y);
        }
        if (strip.area == 0) break;
        strip.centre /= strip.area;
        out.push_back(std::move(strip));
    }
    return out;
}

bool isStripOrArc(const Component& region, const PlanView& view, const DetectOptions& options) {
    const double height = heightOf(region.group);
    const Pca pca = principalAxes(planPoints(region, view, height));
    return pca.minor <= 1.5 * stripSpread(view, pca.mean, height, options) ||
           fitArc({region.group, {&region}, {}}, view, options);
}

} // namespace heliodon::vision
