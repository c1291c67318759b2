#include "geometry/plan_rings.h"

#include <algorithm>

#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"

namespace heliodon::geometry {

namespace {

constexpr double kStraight = 0.1; // the sine of the angle between parts of a straight gap
constexpr double kSpeck = 1e-3;   // inches: edges that only rounding has made
constexpr double kJog = 0.5;      // inches: how far walls of one side may miss one another

struct Run {
    bool gap = false;
    glm::dvec2 from{}, to{};
    double length = 0;
    bool reflex = false; // a corner of it points into the space
};

// Gaps and walls by turns.
std::vector<Run> runs(const PlanArrangement& map, const std::vector<bool>& solid,
                      const std::vector<uint32_t>& outline) {
    std::vector<Run> out;
    glm::dvec2 direction{};
    for (const uint32_t h : outline) {
        const glm::dvec2 from = map.points[map.source(h)], to = map.points[map.target[h]];
        const double length = glm::length(to - from);
        if (length < kSpeck) continue;
        const bool gap = !solid[map.cell[h ^ 1u]], starts = out.empty() || out.back().gap != gap;
        if (starts) out.push_back({gap, from});
        out.back().to = to;
        out.back().length += length;
        if (length < kJog) continue; // it may point anywhere
        const glm::dvec2 next = glm::normalize(to - from);
        out.back().reflex |= !starts && cross(direction, next) < -kStraight;
        direction = next;
    }
    if (out.size() > 1 && out.front().gap == out.back().gap) {
        out.front().from = out.back().from;
        out.front().length += out.back().length;
        out.front().reflex |= out.back().reflex;
        out.pop_back();
    }
    return out;
}

} // namespace

bool isRing(const PlanArrangement& map, const std::vector<bool>& solid,
            const std::vector<uint32_t>& outline) {
    const std::vector<Run> around = runs(map, solid, outline);
    const size_t n = around.size();
    for (size_t i = 0; i < n; ++i)
        if (around[i].gap &&
            (around[i].reflex ||
             glm::length(around[i].to - around[i].from) >
                 std::min(around[(i + 1) % n].length, around[(i + n - 1) % n].length) + kJog))
            return false;
    return n >= 2 * kFewestGaps;
}

} // namespace heliodon::geometry
