// A marker may hide that the wall under it is two. Its legs reach down an inch or so; below them the camera
// sees the wall's face, and a joint as an upright stripe: what lies behind the gap is lit otherwise.
#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

#include "geometry/segment_distance.h"
#include "vision/edges.h"
#include "vision/median.h"
#include "vision/wall_fit.h"

namespace heliodon::vision {
namespace {

constexpr double kStep = 0.04;        // inches along the wall
constexpr double kFoot = 0.6;         // below it: shadows and feet, inches
constexpr double kLegs = 1.6;         // longest leg of a marker, inches
constexpr double kWidest = 0.5;       // between panels of one wall; streaks of light are wider, inches
constexpr float kStripe = 0.12f;      // relative difference that makes a stripe; faces vary by 0.02
constexpr float kEveryHeight = 0.06f; // and that much, with the same sign, in each third of the height

struct Gap {
    double low, high; // along the wall from its `a`
};

struct FaceProfile {
    double start = 0;
    std::vector<float> all;
    std::array<std::vector<float>, 3> thirds;
};

std::optional<FaceProfile> readFace(const geometry::Wall& wall, double from, double to,
                                    const PlanView& view) {
    const double height = geometry::heightInches(wall.heightClass);
    const glm::dvec2 along = glm::normalize(wall.b - wall.a), left = turnedLeft(along);
    const glm::dvec3 eye = view.camera().centre() / geometry::kMetresPerInch;
    const double side = glm::dot(glm::dvec2(eye.x, -eye.z) - wall.a, left) > 0 ? 1 : -1;
    const glm::dvec2 face = wall.a + side * (0.5 * wall.thickness + 0.01) * left;
    const glm::dvec2 middle = face + 0.5 * (from + to) * along;
    if (glm::distance(view.pixel(middle, kFoot), view.pixel(middle, height - kLegs)) < 6)
        return std::nullopt; // seen edge-on from above
    FaceProfile out;
    out.start = from;
    for (double s = from; s <= to; s += kStep) {
        float sums[3] = {};
        constexpr int kRows = 5; // in each third
        for (int row = 0; row < 3 * kRows; ++row) {
            const double h = kFoot + (height - kLegs - kFoot) * (row + 0.5) / (3 * kRows);
            const glm::vec3 light = view.light(view.pixel(face + s * along, h));
            sums[row / kRows] += light.r + 2 * light.g + light.b;
        }
        for (size_t k = 0; k < 3; ++k) out.thirds[k].push_back(sums[k]);
        out.all.push_back(sums[0] + sums[1] + sums[2]);
    }
    return out;
}

// Relative difference of each sample from the face about it.
std::vector<float> againstSurround(const std::vector<float>& values) {
    std::vector<float> out(values.size());
    const auto n = static_cast<std::ptrdiff_t>(values.size()),
               reach = static_cast<std::ptrdiff_t>(1.4 / kStep);
    for (std::ptrdiff_t i = 0; i < n; ++i) {
        const auto begin = values.begin() + std::max<std::ptrdiff_t>(0, i - reach);
        const auto end = values.begin() + std::min(n, i + reach + 1);
        const float level = median(std::vector<float>(begin, end));
        out[static_cast<size_t>(i)] = level > 1e-6f ? values[static_cast<size_t>(i)] / level - 1 : 0;
    }
    return out;
}

std::optional<Gap> findGap(const geometry::Wall& wall, const geometry::WindowMarker& window,
                           const PlanView& view) {
    const double length = glm::distance(wall.a, wall.b);
    const double low = window.pos - 0.5 * window.width, high = window.pos + 0.5 * window.width;
    if (low < 0.5 || high > length - 0.5) return std::nullopt; // no wall is seen on one of its sides
    const auto face = readFace(wall, std::max(0.3, low - 1.2), std::min(length - 0.3, high + 1.2), view);
    if (!face) return std::nullopt;
    const auto all = againstSurround(face->all);
    std::array<std::vector<float>, 3> thirds;
    for (size_t k = 0; k < 3; ++k) thirds[k] = againstSurround(face->thirds[k]);
    size_t peak = 0;
    for (size_t i = 0; i < all.size(); ++i) {
        const double s = face->start + static_cast<double>(i) * kStep;
        if (s > low + 0.05 && s < high - 0.05 && std::abs(all[i]) > std::abs(all[peak])) peak = i;
    }
    const float sign = all[peak] < 0 ? -1.0f : 1.0f;
    if (sign * all[peak] < kStripe) return std::nullopt;
    for (const auto& third : thirds)
        if (sign * third[peak] < kEveryHeight) return std::nullopt;
    auto isIn = [&](size_t i) { return sign * all[i] > 0.5f * sign * all[peak]; };
    size_t first = peak, last = peak;
    while (first > 0 && isIn(first - 1)) --first;
    while (last + 1 < all.size() && isIn(last + 1)) ++last;
    const double width = static_cast<double>(last - first + 1) * kStep;
    if (first == 0 || last + 1 == all.size() || width > kWidest) return std::nullopt;
    // Nothing else on the face may stand out like it: a pattern of light is no joint.
    for (size_t i = 0; i < all.size(); ++i)
        if ((i + 5 < first || i > last + 5) && std::abs(all[i]) > 0.6f * std::abs(all[peak]))
            return std::nullopt;
    return Gap{face->start + (static_cast<double>(first) - 0.5) * kStep,
               face->start + (static_cast<double>(last) + 0.5) * kStep};
}

// The stripe is a wall that stands against this one's face.
bool isBehind(const std::vector<geometry::Wall>& others, const geometry::Wall& wall, const Gap& gap) {
    constexpr double kAgainst = 1.5; // inches: it is tall, and seen from the side covers more of the face
    const glm::dvec2 along = glm::normalize(wall.b - wall.a),
                     there = wall.a + 0.5 * (gap.low + gap.high) * along;
    return std::any_of(others.begin(), others.end(), [&](const geometry::Wall& other) {
        return geometry::distanceToSegment(there, other.a, other.b) < kAgainst;
    });
}

} // namespace

std::vector<StraightWall> splitAtJoints(const StraightWall& whole, const std::vector<geometry::Wall>& others,
                                        const PlanView& view, const DetectOptions& options) {
    const double length = glm::distance(whole.wall.a, whole.wall.b);
    const glm::dvec2 along = glm::normalize(whole.wall.b - whole.wall.a);
    std::vector<Gap> gaps;
    for (const auto& window : whole.windows)
        if (const auto gap = findGap(whole.wall, window, view); gap && !isBehind(others, whole.wall, *gap))
            gaps.push_back(*gap);
    if (gaps.empty()) return {whole};
    std::sort(gaps.begin(), gaps.end(), [](const Gap& a, const Gap& b) { return a.low < b.low; });
    std::vector<StraightWall> out;
    double begin = 0, seamBefore = -1e9;
    for (size_t i = 0; i <= gaps.size(); ++i) {
        const bool last = i == gaps.size();
        const double end = last ? length : gaps[i].low;
        const double seam = last ? 1e9 : 0.5 * (gaps[i].low + gaps[i].high);
        StraightWall part{whole.wall, {}};
        part.wall.a = whole.wall.a + begin * along, part.wall.b = whole.wall.a + end * along;
        part.wall.detection.outlinePx = wallOutline(part.wall, view);
        for (const auto& window : whole.windows) {
            // The marker goes on over the gap: its halves meet in the middle of it.
            const double low = std::max(window.pos - 0.5 * window.width, seamBefore);
            const double high = std::min(window.pos + 0.5 * window.width, seam);
            if (high - low < options.wallThickness) continue;
            part.windows.push_back(window);
            part.windows.back().pos = 0.5 * (low + high) - begin;
            part.windows.back().width = high - low;
            part.windows.back().detection.outlinePx =
                windowOutline(part.wall, part.windows.back(), view, options);
        }
        out.push_back(std::move(part));
        if (!last) begin = gaps[i].high, seamBefore = seam;
    }
    return out;
}

} // namespace heliodon::vision
