#include "compute/daylight/slats.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "compute/daylight/frame.h"

namespace heliodon::daylight {

namespace {

struct Segment {
    glm::dvec2 a, b;
};

// Length of i times its view factor to j, both on the border of a convex region (Hottel's crossed strings).
double exchange(const Segment& i, const Segment& j) {
    const auto d = [](glm::dvec2 p, glm::dvec2 q) { return glm::length(p - q); };
    return 0.5 * std::abs((d(i.a, j.a) + d(i.b, j.b)) - (d(i.a, j.b) + d(i.b, j.a)));
}

} // namespace

constexpr double kNodeStep = std::numbers::pi / (kSlatNodes - 1);

namespace {

// The light between nodes whose means about each node are given: of all that runs linearly between them the
// nearest in the square, weighed as a Lambertian face sends.
class NearestLine {
public:
    void add(BetweenNodes at, double weight) {
        const double lower = 1 - at.part, upper = at.part;
        own_[at.lower] += weight * lower * lower, own_[at.lower + 1] += weight * upper * upper;
        next_[at.lower] += weight * lower * upper;
    }
    SlatLight fitTo(const SlatLight& means) const { // a band of three, solved from node to node
        SlatLight light{}, factor{};
        for (size_t k = 0; k < kSlatNodes; ++k) {
            const double before = k > 0 ? next_[k - 1] : 0,
                         own = own_[k] - (k > 0 ? before * factor[k - 1] : 0);
            factor[k] = next_[k] / own;
            light[k] = (nodeShare(k) * means[k] - (k > 0 ? before * light[k - 1] : 0)) / own;
        }
        for (size_t k = kSlatNodes - 1; k-- > 0;) light[k] -= factor[k] * light[k + 1];
        return light;
    }

private:
    SlatLight own_{}, next_{}; // overlap of each node with itself and with the next one
};

} // namespace

// A Lambertian face sends half the cosine of the elevation, here times the tent over the node.
double nodeShare(size_t node) {
    static const SlatLight shares = [] {
        SlatLight values;
        for (size_t k = 0; k < kSlatNodes; ++k)
            values[k] = std::sin(kNodeStep * static_cast<double>(k)) * (1 - std::cos(kNodeStep)) / kNodeStep;
        values.front() = values.back() = 0.5 * (1 - std::sin(kNodeStep) / kNodeStep);
        return values;
    }();
    return shares[node];
}

BetweenNodes betweenNodes(double elevation) {
    const double at = std::clamp(elevation / std::numbers::pi + 0.5, 0.0, 1.0) * (kSlatNodes - 1);
    const size_t lower = std::min(static_cast<size_t>(at), kSlatNodes - 2);
    return {lower, at - static_cast<double>(lower)};
}

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
    std::array<std::array<double, kStrips>, kStrips> factor; // from one face to the one opposite; either way
    for (size_t k = 0; k < kStrips; ++k)
        for (size_t j = 0; j < kStrips; ++j) factor[k][j] = exchange(strip[k], strip[kStrips + j]) / width;
    // Light sent to and fro: y = rho (seen + F y), `seen` what one lux that leaves a strip gives at once.
    const auto settled = [&](const OnStrips& seen) {
        OnStrips y{}, next{};
        for (size_t k = 0; k < y.size(); ++k) y[k] = reflectance * seen[k];
        for (double change = 1; change > 1e-13;) {
            change = 0;
            for (size_t k = 0; k < kStrips; ++k) {
                double lower = seen[k], upper = seen[kStrips + k];
                for (size_t j = 0; j < kStrips; ++j)
                    lower += factor[k][j] * y[kStrips + j], upper += factor[j][k] * y[j];
                next[k] = reflectance * lower, next[kStrips + k] = reflectance * upper;
            }
            for (size_t k = 0; k < y.size(); ++k) change = std::max(change, std::abs(next[k] - y[k]));
            y = next;
        }
        return y;
    };
    const auto leaving = [&](const Segment& opening) {
        OnStrips seen;
        for (size_t k = 0; k < seen.size(); ++k) seen[k] = exchange(strip[k], opening) / width;
        return settled(seen);
    };
    toIn_ = leaving(in), toOut_ = leaving(out);
    transmitted_ = exchange(out, in) / spacing;
    for (size_t k = 0; k < strip.size(); ++k) {
        const double share = exchange(out, strip[k]) / spacing;
        transmitted_ += share * toIn_[k];
        returned_ += share * toOut_[k];
    }

    // What is seen of the strips from about each node's direction: light that travels in from outside at some
    // elevation falls on what is seen against it; on the room's side the channel's mirror image is seen.
    constexpr size_t kFine = 16;            // looks between two nodes
    std::array<OnStrips, kSlatNodes> lit{}; // shares of the plane, by light that travels in
    NearestLine line;
    for (size_t q = 0; q < kFine * (kSlatNodes - 1); ++q) {
        const double elevation = (static_cast<double>(q) + 0.5) * kNodeStep / kFine - 0.5 * std::numbers::pi;
        const BetweenNodes at = betweenNodes(elevation);
        const double profile = -elevation, look = 0.5 * std::cos(elevation) * kNodeStep / kFine;
        line.add(at, look);
        const OnStrips seen = seenFromOutside(profile);
        for (const auto& [node, part] :
             {std::pair(at.lower, 1 - at.part), std::pair(at.lower + 1, at.part)}) {
            const double weight = part * look / nodeShare(node);
            passing_[node] += weight * straight(profile);
            for (size_t k = 0; k < seen.size(); ++k) lit[node][k] += weight * seen[k];
        }
    }
    std::array<OnStrips, kSlatNodes> seen{};
    for (size_t k = 0; k < strip.size(); ++k) {
        SlatLight means;
        for (size_t node = 0; node < kSlatNodes; ++node) means[node] = lit[node][k];
        const SlatLight nodes = line.fitTo(means);
        for (size_t node = 0; node < kSlatNodes; ++node) seen[node][k] = nodes[node];
    }
    for (size_t node = 0; node < kSlatNodes; ++node) {
        // Seen from the room is, of light that travels there, what light the same way round falls on in the
        // mirror.
        OnStrips fromRoom = mirrored(seen[node]), fromOutside = seen[kSlatNodes - 1 - node];
        for (size_t k = 0; k < strip.size(); ++k)
            fromRoom[k] *= spacing / width, fromOutside[k] *= spacing / width;
        nodesIn_[node] = settled(fromRoom), nodesOut_[node] = settled(fromOutside);
    }
    for (size_t from = 0; from < kSlatNodes; ++from) {
        onward_[from][from] = passing_[from];
        for (size_t to = 0; to < kSlatNodes; ++to)
            for (size_t k = 0; k < strip.size(); ++k) {
                onward_[from][to] += nodeShare(from) * lit[from][k] * nodesIn_[to][k];
                backward_[from][to] += nodeShare(from) * lit[from][k] * nodesOut_[to][k];
            }
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
Slats::OnStrips Slats::seenFromOutside(double profile) const {
    OnStrips seen{};
    const double covered = blocked(profile);
    if (covered <= 0) return seen;
    const size_t face = std::sin(angle_ + profile) > 0 ? 0 : kStrips;
    const double lit = std::min(1.0, 1 / covered) * kStrips; // strips from the outer edge on
    for (size_t k = 0; k < kStrips && static_cast<double>(k) < lit; ++k)
        seen[face + k] = std::min(lit - static_cast<double>(k), 1.0) * std::min(1.0, covered) / lit;
    return seen;
}

// Turned by half a turn about the channel's middle.
Slats::OnStrips Slats::mirrored(const OnStrips& strips) {
    OnStrips turned = strips;
    std::reverse(turned.begin(), turned.end());
    return turned;
}

double Slats::byWayOfSlats(double profile, const OnStrips& toSide) const {
    const double covered = blocked(profile);
    if (covered <= 0) return 0;
    const double* y = &toSide[std::sin(angle_ + profile) > 0 ? 0 : kStrips];
    const double lit = std::min(1.0, 1 / covered) * kStrips;
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
    return byWayOfSlats(profile, toIn_);
}

double Slats::reflected(double profile) const {
    return byWayOfSlats(profile, toOut_);
}

SlatLight Slats::scatteredLight(double profile) const {
    SlatLight light;
    for (size_t node = 0; node < kSlatNodes; ++node) light[node] = byWayOfSlats(profile, nodesIn_[node]);
    return light;
}

SlatLight Slats::reflectedLight(double profile) const {
    SlatLight light;
    for (size_t node = 0; node < kSlatNodes; ++node) light[node] = byWayOfSlats(profile, nodesOut_[node]);
    return light;
}

SlatLight Slats::straightOn(const SlatLight& arriving) const {
    SlatLight light;
    for (size_t node = 0; node < kSlatNodes; ++node) light[node] = passing_[node] * arriving[node];
    return light;
}

SlatLight Slats::times(const SlatLight& arriving, const Exchange& exchange) {
    SlatLight light{};
    for (size_t from = 0; from < kSlatNodes; ++from)
        for (size_t to = 0; to < kSlatNodes; ++to) light[to] += arriving[from] * exchange[from][to];
    return light;
}

} // namespace heliodon::daylight
