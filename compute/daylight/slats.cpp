#include "compute/daylight/slats.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "compute/daylight/frame.h"

namespace heliodon::daylight {

namespace {

constexpr size_t kStrips = 24; // of a face

struct Segment {
    glm::dvec2 a, b;
};

// Length of i times its view factor to j, both on the border of a convex region (Hottel's crossed strings).
double exchange(const Segment& i, const Segment& j) {
    const auto d = [](glm::dvec2 p, glm::dvec2 q) { return glm::length(p - q); };
    return 0.5 * std::abs((d(i.a, j.a) + d(i.b, j.b)) - (d(i.a, j.b) + d(i.b, j.a)));
}

} // namespace

Slats::Slats(double angleDeg, double spacing, double reflectance)
    : angle_(radians(angleDeg)), spacing_(spacing) {
    const glm::dvec2 outer = 0.5 * glm::dvec2(std::cos(angle_), -std::sin(angle_)), above(0, spacing);
    const auto along = [&](size_t k, glm::dvec2 offset) { // from the outer edge
        return outer * (1 - 2 * static_cast<double>(k) / kStrips) + offset;
    };
    std::array<Segment, 2 * kStrips> strip;
    for (size_t k = 0; k < kStrips; ++k) {
        strip[k] = {along(k, {0, 0}), along(k + 1, {0, 0})};
        strip[kStrips + k] = {along(k, above), along(k + 1, above)};
    }
    const Segment out{outer, outer + above}, in{-outer, -outer + above};
    const double width = 1.0 / kStrips;
    // Share of what falls on strip k that leaves in the end by an opening: y = rho (F_opening + F y).
    const auto leaving = [&](const Segment& opening) {
        std::array<double, 2 * kStrips> first{}, y{}, next{};
        for (size_t k = 0; k < y.size(); ++k)
            y[k] = first[k] = reflectance * exchange(strip[k], opening) / width;
        for (double change = 1; change > 1e-13;) {
            change = 0;
            for (size_t k = 0; k < y.size(); ++k) {
                double sum = 0;
                const size_t other = k < kStrips ? kStrips : 0; // the face opposite; its own is flat
                for (size_t j = other; j < other + kStrips; ++j) sum += exchange(strip[k], strip[j]) * y[j];
                next[k] = first[k] + reflectance * sum / width;
                change = std::max(change, std::abs(next[k] - y[k]));
            }
            y = next;
        }
        return y;
    };
    const auto toIn = leaving(in), toOut = leaving(out);
    lowerIn_.assign(toIn.begin(), toIn.begin() + kStrips),
        upperIn_.assign(toIn.begin() + kStrips, toIn.end());
    lowerOut_.assign(toOut.begin(), toOut.begin() + kStrips),
        upperOut_.assign(toOut.begin() + kStrips, toOut.end());
    transmitted_ = exchange(out, in) / spacing;
    for (size_t k = 0; k < strip.size(); ++k) {
        const double share = exchange(out, strip[k]) / spacing;
        transmitted_ += share * toIn[k];
        returned_ += share * toOut[k];
    }
}

// Height of a slat on the blind's plane, cast along the light, over the spacing.
double Slats::blocked(double profile) const {
    return std::abs(std::sin(angle_ + profile)) / (spacing_ * std::max(std::cos(profile), 1e-12));
}

double Slats::straight(double profile) const {
    return std::max(0.0, 1 - blocked(profile));
}

// Neighbours shade one another from the inner edges on.
double Slats::byWayOfSlats(double profile, const std::vector<double>& lower,
                           const std::vector<double>& upper) const {
    const double covered = blocked(profile);
    if (covered <= 0) return 0;
    const std::vector<double>& y = std::sin(angle_ + profile) > 0 ? lower : upper;
    const double lit = std::min(1.0, 1 / covered) * kStrips; // strips from the outer edge on
    double sum = 0;
    for (size_t k = 0; k < kStrips && static_cast<double>(k) < lit; ++k) {
        const double end = std::min(lit - static_cast<double>(k), 1.0);
        // The last strip is lit in part: its value at the middle of the light, on the line to its neighbours.
        const size_t next = std::min(k + 1, kStrips - 1), before = k > 0 ? k - 1 : 0;
        const double slope = (y[next] - y[before]) / static_cast<double>(std::max<size_t>(next - before, 1));
        sum += end * (y[k] + slope * 0.5 * (end - 1));
    }
    return std::min(1.0, covered) * sum / lit;
}

double Slats::scattered(double profile) const {
    return byWayOfSlats(profile, lowerIn_, upperIn_);
}

double Slats::reflected(double profile) const {
    return byWayOfSlats(profile, lowerOut_, upperOut_);
}

} // namespace heliodon::daylight
