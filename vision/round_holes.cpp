#include "vision/round_holes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace heliodon::vision {

std::vector<RoundHole> roundHoles(const Component& region, double least, double most) {
    constexpr double kRound = 1.4; // farthest pixel over the radius; a square's corner is at 1.25
    if (region.runs.empty()) return {};
    int x0 = region.runs.front().x0, x1 = region.runs.front().x1;
    for (const Run& run : region.runs) x0 = std::min(x0, run.x0), x1 = std::max(x1, run.x1);
    ClassImage around; // all but the region
    around.x0 = x0, around.y0 = region.runs.front().y;
    around.width = x1 - x0, around.height = region.runs.back().y - around.y0 + 1;
    around.paint.assign(static_cast<size_t>(around.width) * static_cast<size_t>(around.height), Paint::green);
    for (const Run& run : region.runs)
        for (int x = run.x0; x < run.x1; ++x) around.set(x, run.y, Paint::none);
    std::vector<RoundHole> out;
    for (const Component& hole : findComponents(around, std::max(4, static_cast<int>(least * least)))) {
        const double radius = std::sqrt(hole.area / std::numbers::pi);
        if (radius < least || radius > most) continue;
        const bool isClosed = std::all_of(hole.runs.begin(), hole.runs.end(), [&](const Run& run) {
            return run.x0 > x0 && run.x1 < x1 && run.y > around.y0 && run.y < region.runs.back().y;
        });
        const bool isRound = std::all_of(hole.runs.begin(), hole.runs.end(), [&](const Run& run) {
            const double y = run.y - hole.centre.y;
            return std::max(std::hypot(run.x0 - hole.centre.x, y),
                            std::hypot(run.x1 - 1 - hole.centre.x, y)) < kRound * radius;
        });
        if (isClosed && isRound) out.push_back({hole.centre, radius});
    }
    return out;
}

bool liesRound(const Component& region, const std::vector<RoundHole>& holes, double rim) {
    constexpr double kMost = 0.6;
    return std::any_of(holes.begin(), holes.end(), [&](const RoundHole& hole) {
        int within = 0;
        for (const Run& run : region.runs)
            for (int x = run.x0; x < run.x1; ++x)
                within += glm::distance(glm::dvec2(x, run.y), hole.centre) < hole.radius + rim;
        return within > kMost * region.area;
    });
}

} // namespace heliodon::vision
