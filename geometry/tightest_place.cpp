#include "geometry/tightest_place.h"

#include <algorithm>
#include <limits>
#include <span>

#include "geometry/triangle_box.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kNarrow = 0.6;  // of the room at the end
constexpr ptrdiff_t kBeside = 6; // points that are moved, on either side of the narrowest
constexpr int kParts = 16, kRounds = 30;
constexpr double kPush = 0.25; // of the room there, at first

dvec3 nearestTo(dvec3 p, const std::vector<ShellTriangle>& triangles) {
    double least = std::numeric_limits<double>::max();
    dvec3 out(0);
    for (const ShellTriangle& t : triangles) {
        const dvec3 low = glm::min(glm::min(t.a, t.b), t.c), high = glm::max(glm::max(t.a, t.b), t.c);
        if (glm::length(p - glm::clamp(p, low, high)) >= least) continue;
        const dvec3 q = nearestPoint(t, p);
        if (glm::length(q - p) < least) least = glm::length(q - p), out = q;
    }
    return out;
}

struct Narrowest {
    size_t at = 0;
    double room = std::numeric_limits<double>::max();
};

Narrowest narrowestOf(const std::vector<dvec3>& way, const std::vector<ShellTriangle>& triangles) {
    Narrowest out;
    for (size_t k = 0; k < way.size(); ++k)
        if (const double room = glm::length(way[k] - nearestTo(way[k], triangles)); room < out.room)
            out = {k, room};
    return out;
}

// Away from what is nearest, across the way, and with points in between.
std::vector<dvec3> centred(std::vector<dvec3> way, const std::vector<ShellTriangle>& triangles) {
    for (int round = 0; round < kRounds; ++round)
        for (size_t k = 1; k + 1 < way.size(); ++k) {
            const dvec3 along = way[k + 1] - way[k - 1], away = way[k] - nearestTo(way[k], triangles);
            const double square = std::max(glm::dot(along, along), 1e-300);
            way[k] += kPush * (1 - double(round) / kRounds) * (away - glm::dot(away, along) / square * along);
        }
    std::vector<dvec3> out;
    for (size_t k = 1; k < way.size(); ++k)
        for (int part = 0; part < kParts; ++part)
            out.push_back(glm::mix(way[k - 1], way[k], part / double(kParts)));
    return out;
}

} // namespace

std::optional<TightPlace> tightestPlace(const std::vector<dvec3>& way,
                                        const std::vector<ShellTriangle>& triangles) {
    if (way.size() < 2) return std::nullopt;
    const auto at = static_cast<ptrdiff_t>(narrowestOf(way, triangles).at);
    const auto first = way.begin() + std::max<ptrdiff_t>(at - kBeside, 0),
               last = way.begin() + std::min<ptrdiff_t>(at + kBeside + 1, std::ssize(way));
    const std::vector<dvec3> around = centred({first, last}, triangles);
    const Narrowest neck = narrowestOf(around, triangles);
    if (neck.room > kNarrow * glm::length(way.back() - nearestTo(way.back(), triangles))) return std::nullopt;
    // Between what is nearest and what is opposite.
    const dvec3 p = around[neck.at], one = nearestTo(p, triangles),
                middle = 0.5 * (one + nearestTo(2.0 * p - one, triangles));
    return TightPlace{glm::length(middle - p) < neck.room ? middle : p, 2 * neck.room};
}

} // namespace heliodon::geometry
