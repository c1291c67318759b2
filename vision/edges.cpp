#include "vision/edges.h"
#include "vision/median.h"

#include <algorithm>
#include <cmath>

#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

namespace heliodon::vision {
namespace {

glm::vec3 mean(const std::vector<glm::vec3>& values, size_t begin, size_t end) {
    glm::vec3 sum(0);
    for (size_t i = begin; i < end; ++i) sum += values[i];
    return sum / static_cast<float>(end - begin);
}

struct Levels {
    size_t begin, end; // samples of the profile
};

// In samples.
std::optional<double> crossing(const std::vector<glm::vec3>& profile, Levels inside, Levels outside,
                               size_t expected) {
    const glm::vec3 in = mean(profile, inside.begin, inside.end);
    const glm::vec3 difference = mean(profile, outside.begin, outside.end) - in;
    const float span = glm::dot(difference, difference);
    const float brighter = std::max(glm::length(in), glm::length(in + difference));
    if (span < 1e-12f || std::sqrt(span) < 0.1f * brighter) return std::nullopt;
    std::optional<double> best;
    float before = glm::dot(profile[0] - in, difference) / span;
    for (size_t i = 1; i < profile.size(); ++i) {
        const float here = glm::dot(profile[i] - in, difference) / span;
        if (before < 0.5f && here >= 0.5f) {
            const double place =
                static_cast<double>(i - 1) + static_cast<double>((0.5f - before) / (here - before));
            const double wanted = static_cast<double>(expected);
            if (!best || std::abs(place - wanted) < std::abs(*best - wanted)) best = place;
        }
        before = here;
    }
    return best;
}

} // namespace

std::optional<double> findEdge(const PlanView& view, const EdgeProbe& probe) {
    const glm::dvec2 from = probe.at - probe.inside * probe.outward,
                     to = probe.at + probe.outside * probe.outward;
    const double length = glm::distance(view.pixel(from, probe.height), view.pixel(to, probe.height));
    const size_t n = static_cast<size_t>(std::clamp(2 * length, 12.0, 120.0)); // half a pixel apart
    std::vector<glm::vec3> profile(n, glm::vec3(0));
    for (int j = 0; j < probe.lateralSamples; ++j) {
        const double side = probe.lateralSamples == 1 ? 0 : 2.0 * j / (probe.lateralSamples - 1) - 1;
        const glm::dvec2 a = view.pixel(from + side * probe.lateral, probe.height);
        const glm::dvec2 step =
            (view.pixel(to + side * probe.lateral, probe.height) - a) / static_cast<double>(n - 1);
        for (size_t i = 0; i < n; ++i) profile[i] += view.light(a + static_cast<double>(i) * step);
    }
    if (probe.look == EdgeLook::encoded)
        for (glm::vec3& p : profile) p = glm::sqrt(p);
    if (probe.look == EdgeLook::colour) {
        const glm::vec3 gain = 1.0f / view.white(view.pixel(probe.at, probe.height));
        for (glm::vec3& p : profile) {
            p *= gain;
            p -= (p.r + p.g + p.b) / 3;
        }
    }
    const double perInch = static_cast<double>(n - 1) / (probe.inside + probe.outside);
    const size_t expected = static_cast<size_t>(probe.inside * perInch);
    const size_t tail = std::max<size_t>(2, 2 * (n - expected) / 5);
    auto edge = crossing(profile, {0, std::max<size_t>(2, expected / 2)}, {n - tail, n}, expected);
    if (!edge) return std::nullopt;
    // Once more with levels from close by: behind the edge may lie a wall's narrow white face and then a
    // shaded table. The blur of lens and mosaic ends within two pixels.
    const double pixel = static_cast<double>(n - 1) / length;
    auto within = [&](double near, double far) {
        const double last = static_cast<double>(n);
        const double begin = std::clamp(*edge + near * pixel, 0.0, last - 2);
        const double end = std::clamp(*edge + far * pixel + 1, begin + 2, last);
        return Levels{static_cast<size_t>(begin), static_cast<size_t>(end)};
    };
    const auto place = static_cast<size_t>(std::clamp(*edge, 0.0, static_cast<double>(n - 1)));
    if (const auto closer = crossing(profile, within(-3.5, -2), within(2, 2.5), place)) edge = closer;
    *edge = *edge / perInch - probe.inside;
    return edge;
}

std::optional<LineFit> fitLine(const std::vector<glm::dvec2>& points, double outlier) {
    if (points.size() < 3) return std::nullopt;
    // Start from the line through the medians of the two halves: up to half of each may be wrong.
    std::vector<glm::dvec2> sorted = points;
    std::sort(sorted.begin(), sorted.end(), [](glm::dvec2 a, glm::dvec2 b) { return a.x < b.x; });
    std::vector<double> x[2], y[2];
    for (size_t i = 0; i < sorted.size(); ++i) {
        const size_t half = i < sorted.size() / 2 ? 0 : 1;
        x[half].push_back(sorted[i].x), y[half].push_back(sorted[i].y);
    }
    const double run = median(x[1]) - median(x[0]);
    LineFit fit;
    fit.slope = run > 1e-9 ? (median(y[1]) - median(y[0])) / run : 0;
    std::vector<double> residual;
    for (const auto& p : points) residual.push_back(p.y - fit.slope * p.x);
    fit.offset = median(residual);

    double limit = outlier;
    for (int round = 0; round < 4; ++round) {
        double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
        for (const auto& p : points) {
            if (std::abs(p.y - fit.offset - fit.slope * p.x) > limit) continue;
            n += 1, sx += p.x, sy += p.y, sxx += p.x * p.x, sxy += p.x * p.y;
        }
        if (n < 3) return std::nullopt;
        const double det = n * sxx - sx * sx;
        fit.slope = det > 1e-9 * n * n ? (n * sxy - sx * sy) / det : 0;
        fit.offset = (sy - fit.slope * sx) / n;
        residual.clear();
        for (const auto& p : points) {
            const double r = std::abs(p.y - fit.offset - fit.slope * p.x);
            if (r <= limit) residual.push_back(r);
        }
        if (residual.size() < 3) return std::nullopt;
        double squares = 0;
        for (const double r : residual) squares += r * r;
        fit.rms = std::sqrt(squares / static_cast<double>(residual.size()));
        fit.kept = residual.size();
        // 1.4826: median absolute deviation to standard deviation. Never tighter than a hundredth of an inch.
        limit = std::min(outlier, std::max(0.01, 3 * 1.4826 * median(residual)));
    }
    return fit;
}

Pca principalAxes(const std::vector<glm::dvec2>& points) {
    Pca pca;
    if (points.empty()) return pca;
    const double n = static_cast<double>(points.size());
    for (const auto& p : points) pca.mean += p / n;
    double xx = 0, xy = 0, yy = 0;
    for (const auto& p : points) {
        const glm::dvec2 d = p - pca.mean;
        xx += d.x * d.x / n, xy += d.x * d.y / n, yy += d.y * d.y / n;
    }
    const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
    const double middle = 0.5 * (xx + yy), half = std::hypot(0.5 * (xx - yy), xy);
    pca.axis = {std::cos(angle), std::sin(angle)};
    pca.major = std::sqrt(middle + half);
    pca.minor = std::sqrt(std::max(0.0, middle - half));
    for (const auto& p : points) {
        const double s = glm::dot(p - pca.mean, pca.axis);
        pca.low = std::min(pca.low, s), pca.high = std::max(pca.high, s);
    }
    return pca;
}

} // namespace heliodon::vision
