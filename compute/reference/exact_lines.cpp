#include "compute/reference/exact_lines.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace heliodon::compute::reference {

using glm::dvec3;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kMissed = 0.02, kQuick = 2, kLeast = 0.1, kAlone = 0.5; // as in the shader
constexpr double kNear = 0.470142064105, kFar = 0.101286507323;

// M. Jarzynski, M. Olano, "Hash Functions for GPU Rendering", 2020.
uint32_t hashOf(uint32_t x) {
    x = x * 747796405u + 2891336453u;
    x = ((x >> ((x >> 28u) + 4u)) ^ x) * 277803737u;
    return (x >> 22u) ^ x;
}

double unitOf(uint32_t bits) {
    return (bits >> 8u) / 16777216.0;
}

double areaOf(const Triangle& t) {
    return 0.5 * glm::length(glm::cross(t[1] - t[0], t[2] - t[0]));
}

dvec3 normalOf(const Triangle& t) {
    return glm::normalize(glm::cross(t[1] - t[0], t[2] - t[0]));
}

// Its longest edge that between the last two corners.
Triangle longestLast(const Triangle& t) {
    size_t apex = 0;
    double longest = 0;
    for (size_t k = 0; k < 3; ++k) {
        const double edge = glm::length(t[(k + 1) % 3] - t[(k + 2) % 3]);
        if (edge > longest) longest = edge, apex = k;
    }
    return {t[apex], t[(apex + 1) % 3], t[(apex + 2) % 3]};
}

// The stretch of the segment a b in the shadow of a convex blocker, as seen from `point`; empty: from >= to.
struct Stretch {
    double from = 0, to = 1;
    void cut(double atA, double atB) { // to where a linear value is positive
        const double t = atA / (atA - atB);
        if (atA < 0) from = atB < 0 ? 2 : std::max(from, t);
        if (atA >= 0 && atB < 0) to = std::min(to, t);
    }
};

Stretch shadowOf(const Polygon& blocker, const dvec3& point, const dvec3& a, const dvec3& b) {
    const dvec3 normal = glm::normalize(glm::cross(blocker[1] - blocker[0], blocker[2] - blocker[0]));
    const double height = glm::dot(normal, blocker[0] - point), sense = height > 0 ? 1 : -1;
    if (std::abs(height) <= 3e-7 * glm::length(blocker[0] - point)) return {2, 0}; // edge-on
    Stretch stretch;
    const auto beyond = [&](const dvec3& p) { return sense * (glm::dot(normal, p - point) - height); };
    stretch.cut(beyond(a), beyond(b));
    for (size_t k = 0; k < blocker.size(); ++k) {
        const dvec3 wall = sense * glm::cross(blocker[k] - point, blocker[(k + 1) % blocker.size()] - point);
        stretch.cut(glm::dot(wall, a - point), glm::dot(wall, b - point));
    }
    return stretch;
}

struct Look {
    double seen = 0, open = 0; // times pi, over the area of the inner piece
    uint32_t hiddenBits = 0;   // of 128
};

class Cubature {
public:
    Cubature(const Triangle& outer, const Triangle& inner, std::span<const Polygon> blockers, uint32_t seed)
        : outer_(outer), inner_(longestLast(inner)), outerNormal_(normalOf(outer)),
          innerNormal_(normalOf(inner)), blockers_(blockers), seed_(seed) {}

    Look lookFrom(const dvec3& barycentric, uint32_t k) const {
        const dvec3 point = barycentric.x * outer_[0] + barycentric.y * outer_[1] + barycentric.z * outer_[2];
        const dvec3 middle = (inner_[0] + inner_[1] + inner_[2]) / 3.0;
        double g[3], mean = 0; // the kernel as a linear function, from the rule of degree 2
        for (size_t c = 0; c < 3; ++c) g[c] = kernel(0.5 * (middle + inner_[c]) - point), mean += g[c] / 3;
        for (double& value : g) value = mean + 2 * (value - mean);
        const uint32_t bits = seed_ + k * 2654435769u;
        static constexpr double kShift[4]{0, 0.618034, 0.236068, 0.854102};
        Look look;
        double all = 0;
        for (size_t line = 0; line < 4; ++line) {
            const double u = unitOf(bits), across = line == 1 || line == 2 ? 1 - u : u;
            const double h = std::sqrt(0.25 * (static_cast<double>(line) + across));
            const double jitter = std::fmod(unitOf(hashOf(bits)) + kShift[line], 1.0);
            const uint32_t hidden =
                hiddenOf(point, glm::mix(inner_[0], inner_[1], h), glm::mix(inner_[0], inner_[2], h), jitter);
            look.hiddenBits += static_cast<uint32_t>(std::popcount(hidden));
            for (uint32_t bit = 0; bit < 32; ++bit) { // as heavy as its middle
                const double along = (bit + 0.5) / 32;
                const double weight = g[0] + h * (g[1] + along * (g[2] - g[1]) - g[0]);
                all += weight;
                if (!(hidden >> bit & 1u)) look.seen += weight;
            }
        }
        look.open = mean;
        look.seen = all > 0 ? mean * std::max(0.0, look.seen) / all : 0;
        return look;
    }

private:
    double kernel(const dvec3& d) const {
        const double r2 = glm::dot(d, d);
        return std::max(0.0, glm::dot(outerNormal_, d)) * std::max(0.0, -glm::dot(innerNormal_, d)) /
               (r2 * r2);
    }

    uint32_t hiddenOf(const dvec3& point, const dvec3& a, const dvec3& b, double jitter) const {
        uint32_t hidden = 0;
        for (const Polygon& blocker : blockers_) {
            const Stretch s = shadowOf(blocker, point, a, b);
            const auto bitOf = [&](double t) {
                return static_cast<uint32_t>(std::clamp(t * 32 + jitter, 0.0, 32.0));
            };
            for (uint32_t bit = bitOf(s.from); bit < bitOf(s.to); ++bit) hidden |= 1u << bit;
        }
        return hidden;
    }

    Triangle outer_, inner_;
    dvec3 outerNormal_, innerNormal_;
    std::span<const Polygon> blockers_;
    uint32_t seed_;
};

// Point k of Radon's rule: the far three, the centre, the near three.
dvec3 radonPoint(uint32_t k) {
    const double t = k == 3 ? 1.0 / 3 : k < 3 ? kFar : kNear;
    dvec3 place(t);
    if (k != 3) place[static_cast<int>(k % 4)] = 1 - 2 * t;
    return place;
}

// The weight of three points at (1 - 2 t, t, t) that with the centre integrate quadratics.
double lowWeight(double t) {
    return 0.25 / ((1 - 3 * t) * (1 - 3 * t));
}

struct Result {
    double value = 0, error = 0, open = 0;
    bool turned = false;
};

Result firstLook(const Cubature& cubature, double limit, bool mayGoOn) {
    Look look[7];
    uint32_t hidden = 0;
    double low = 1e300, high = 0;
    const auto take = [&](uint32_t k) {
        look[k] = cubature.lookFrom(radonPoint(k), k);
        low = std::min(low, look[k].seen), high = std::max(high, look[k].seen);
    };
    take(3);
    if (look[3].open <= limit) {
        const double share = look[3].hiddenBits / 128.0;
        return {look[3].seen, kAlone * std::sqrt(share * (1 - share)) * look[3].open, look[3].open};
    }
    for (uint32_t k = 0; k < 3; ++k) take(k);
    for (uint32_t k = 0; k < 4; ++k) hidden += look[k].hiddenBits;
    const double centre = look[3].seen, far = look[0].seen + look[1].seen + look[2].seen;
    const double byFar = lowWeight(kFar) / 3 * far + (1 - lowWeight(kFar)) * centre;
    Result result{byFar, std::max(kQuick * std::abs(byFar - centre), kLeast * (high - low)), look[3].open};
    const bool unproven = kMissed * result.open > limit;
    result.turned = mayGoOn && unproven && (hidden == 0 || hidden == 4 * 128);
    if (result.turned || (result.error <= limit && !unproven)) return result;
    for (uint32_t k = 4; k < 7; ++k) take(k);
    const double near = look[4].seen + look[5].seen + look[6].seen;
    const double byNear = lowWeight(kNear) / 3 * near + (1 - lowWeight(kNear)) * centre;
    result.value = 0.132394152788 * near + 0.125939180545 * far + 0.225 * centre;
    result.error = std::max(
        {std::abs(result.value - byNear), std::abs(result.value - byFar), 0.6 * kLeast * (high - low)});
    return result;
}

// The same from four points in each of the triangles that halving all edges `level` times makes.
Result closerLook(const Cubature& cubature, uint32_t level, double before) {
    Result result;
    const uint32_t points = 4u << (2 * level);
    for (uint32_t k = 0; k < points; ++k) {
        dvec3 place = radonPoint(k % 4);
        for (uint32_t l = 0; l < level; ++l) {
            const uint32_t quarter = (k / 4) >> (2 * l) & 3u;
            place = quarter == 3 ? 0.5 - 0.5 * place : 0.5 * place;
            if (quarter < 3) place[static_cast<int>(quarter)] += 0.5;
        }
        const Look look = cubature.lookFrom(place, k + 7 * level);
        const double weight = k % 4 == 3 ? 1 - lowWeight(kFar) : lowWeight(kFar) / 3;
        result.value += 4.0 / points * weight * look.seen;
        result.open = look.open;
    }
    result.error = std::abs(result.value - before);
    return result;
}

} // namespace

Estimate formFactorAlongLines(const LinesPair& pair, double tolerance, uint32_t levels) {
    const uint32_t first = std::min(pair.outerPiece, pair.innerPiece),
                   second = std::max(pair.outerPiece, pair.innerPiece);
    const uint32_t seed = hashOf(first * 0x9e3779b9u ^ hashOf(second));
    const double outerArea = areaOf(pair.outer), innerArea = areaOf(pair.inner);
    // Values are A_outer F pi over both areas, whichever piece carries the points.
    const double limit = kPi * tolerance / innerArea / std::max(1.0, outerArea / innerArea);
    const Cubature there(pair.outer, pair.inner, pair.blockers, seed),
        back(pair.inner, pair.outer, pair.blockers, seed);
    Result result = firstLook(there, limit, levels > 0);
    const bool turned = result.turned;
    for (uint32_t level = 0;; ++level) {
        if (level > 0) result = closerLook(turned ? back : there, level, result.value);
        const double missed = kMissed * std::pow(0.25, level) * result.open;
        result.error = std::max(result.error, missed);
        if (result.error <= limit || level == levels) break;
    }
    return {innerArea / kPi * std::max(0.0, result.value), innerArea / kPi * result.error};
}

} // namespace heliodon::compute::reference
