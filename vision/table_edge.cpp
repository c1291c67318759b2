#include "vision/table_edge.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "vision/edges.h"

namespace heliodon::vision {

namespace {

constexpr int kDirections = 72, kLeastSeen = 36;
constexpr double kReach = 0.7;                               // inches within and beyond the edge
constexpr double kStep = 0.14;                               // of the logarithm of light
constexpr double kThere = 0.7, kClearly = 0.85;              // share of the directions with a step one way
constexpr double kFarthest = 10, kCoarse = 0.5, kFine = 0.1; // inches

// The logarithm of light on the table; none beyond the picture.
std::optional<double> lightAt(const PlanView& view, glm::dvec2 plan) {
    const glm::dvec2 p = view.pixel(plan, 0);
    if (!(p.x >= 0 && p.y >= 0 && p.x <= view.photo().width - 1 && p.y <= view.photo().height - 1))
        return std::nullopt;
    const glm::vec3 light = view.light(p);
    return std::log(std::max(1e-3, static_cast<double>(light.r + light.g + light.b) / 3));
}

// The share of the circle's directions, of those in the picture, in which it grows darker outwards, or
// lighter: whichever are more.
double agreement(const PlanView& view, glm::dvec2 centre, double radius) {
    int seen = 0, darker = 0, lighter = 0;
    for (int k = 0; k < kDirections; ++k) {
        const double angle = 2 * std::numbers::pi * k / kDirections;
        const glm::dvec2 out(std::cos(angle), std::sin(angle));
        const auto within = lightAt(view, centre + (radius - kReach) * out),
                   beyond = lightAt(view, centre + (radius + kReach) * out);
        if (!within || !beyond) continue;
        ++seen;
        darker += *within - *beyond > kStep;
        lighter += *beyond - *within > kStep;
    }
    return seen < kLeastSeen ? 0 : static_cast<double>(std::max(darker, lighter)) / seen;
}

// The mean of the places on a grid round `from` where the circle agrees best, and how well it does there.
std::pair<glm::dvec2, double> bestPlace(const PlanView& view, double radius, glm::dvec2 from, double reach,
                                        double step) {
    glm::dvec2 sum{};
    double best = 0;
    int count = 0;
    const int n = static_cast<int>(std::ceil(reach / step));
    for (int i = -n; i <= n; ++i)
        for (int j = -n; j <= n; ++j) {
            const glm::dvec2 off = step * glm::dvec2(i, j);
            if (glm::length(off) > reach) continue;
            const double here = agreement(view, from + off, radius);
            if (here < best) continue;
            if (here > best) best = here, sum = {}, count = 0;
            sum += from + off, ++count;
        }
    return {sum / static_cast<double>(std::max(count, 1)), best};
}

} // namespace

std::optional<glm::dvec2> edgeOffset(const PlanView& view, double radius) {
    constexpr size_t kLeast = 54;
    constexpr double kFar = 1.2, kOutlier = 0.05; // inches
    struct Place {
        glm::dvec2 out{};
        double past = 0;
    };
    std::vector<Place> places;
    for (int k = 0; k < kDirections; ++k) {
        const double angle = 2 * std::numbers::pi * k / kDirections;
        EdgeProbe probe;
        probe.outward = {std::cos(angle), std::sin(angle)};
        probe.at = radius * probe.outward;
        probe.lateral = 0.1 * turnedLeft(probe.outward);
        probe.inside = probe.outside = kFar;
        if (const auto edge = findEdge(view, probe)) places.push_back({probe.outward, *edge});
    }
    glm::dvec3 fit(0); // offset, and how much larger the table is
    for (int pass = 0; pass < 3; ++pass) {
        glm::dmat3 normal(0);
        glm::dvec3 right(0);
        for (const Place& place : places) {
            const glm::dvec3 row(place.out, 1);
            normal += glm::outerProduct(row, row);
            right += place.past * row;
        }
        if (places.size() < kLeast) return std::nullopt;
        fit = glm::inverse(normal) * right;
        std::erase_if(places, [&](const Place& place) {
            return std::abs(place.past - glm::dot(fit, glm::dvec3(place.out, 1))) > kOutlier * (3 - pass);
        });
    }
    if (places.size() < kLeast) return std::nullopt;
    return glm::dvec2(fit);
}

std::optional<glm::dvec2> tableOffset(const PlanView& view, double radius) {
    constexpr double kWorthSaying = 0.3, kWorthCoarse = 1; // inches
    if (radius < 2 * kReach) return std::nullopt;
    if (const auto near = edgeOffset(view, radius))
        return glm::length(*near) < kWorthSaying ? std::nullopt : near;
    if (agreement(view, {}, radius) >= kThere) return std::nullopt;
    const auto [coarse, clear] = bestPlace(view, radius, {}, kFarthest, kCoarse);
    if (clear < kClearly) return std::nullopt;
    const glm::dvec2 offset = bestPlace(view, radius, coarse, 1.5 * kCoarse, kFine).first;
    if (glm::length(offset) < kWorthCoarse) return std::nullopt;
    return offset;
}

std::optional<double> tableRadiusSeen(const PlanView& view, double radius) {
    constexpr double kWorth = 0.35, kMost = 1.0 / 3; // inches; of the radius
    if (radius < 2 * kReach ||
        std::min(agreement(view, {}, radius - kWorth), agreement(view, {}, radius + kWorth)) >= kThere)
        return std::nullopt;
    std::vector<double> radii, shares;
    for (double r = (1 - kMost) * radius; r <= (1 + kMost) * radius; r += kFine)
        radii.push_back(r), shares.push_back(agreement(view, {}, r));
    const auto best = std::max_element(shares.begin(), shares.end());
    if (*best < kClearly) return std::nullopt;
    // As clear, and beside it: the edge is in their middle.
    auto first = best, last = best;
    while (first != shares.begin() && *(first - 1) >= kClearly) --first;
    while (last + 1 != shares.end() && *(last + 1) >= kClearly) ++last;
    const double from = radii[static_cast<size_t>(first - shares.begin())],
                 to = radii[static_cast<size_t>(last - shares.begin())], seen = 0.5 * (from + to);
    if (to - from < kReach) return std::nullopt; // a clear edge does for twice that
    if (std::abs(seen - radius) < kWorth) return std::nullopt;
    return seen;
}

std::optional<std::string> tableElsewhere(const PlanView& view, double radius) {
    if (const auto offset = tableOffset(view, radius)) {
        const glm::dvec2 expected = view.pixel({}, 0), seen = view.pixel(*offset, 0);
        return fmt::format(
            "the table's edge shows {:.1f} in from where the rig has it (its middle at pixel {:.0f}, {:.0f}, "
            "not {:.0f}, {:.0f}): was the camera moved, the picture turned, or the calibration board not on "
            "the "
            "table's middle? Walls may be misread",
            glm::length(*offset), seen.x, seen.y, expected.x, expected.y);
    }
    const auto seen = tableRadiusSeen(view, radius);
    if (!seen) return std::nullopt;
    return fmt::format("the table seems to be {:.1f} in across, but the rig has {:.1f} in: was "
                       "the size of the calibration board, or of the table, another? All "
                       "lengths may be off",
                       2 * *seen, 2 * radius);
}

} // namespace heliodon::vision
