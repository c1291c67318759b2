// Candidates about each mark, the cheapest taken in turn until none moves: J. Christensen, J. Marks, S.
// Shieber, "An Empirical Study of Algorithms for Point-Feature Label Placement", 1995, its discrete descent.
#include "engine/app/label_places.h"

#include <algorithm>
#include <cmath>

namespace heliodon::app {

namespace {

constexpr int kRings = 16, kSweeps = 6;
constexpr double kRingStep = 9;                              // pixels
constexpr double kCovers = 1e4, kCrosses = 8, kFarther = 12; // costs

struct Candidate {
    Box box;
    double cost; // of its place about the mark
};

std::vector<Candidate> candidatesOf(const Label& label, double markRadius) {
    std::vector<Candidate> candidates;
    const auto add = [&](int ring, double right, double down, double cost) {
        const double gap = markRadius + 2 + kRingStep * ring;
        const glm::dvec2 middle =
            label.mark + glm::dvec2(right * (gap + 0.5 * label.size.x), down * (gap + 0.5 * label.size.y));
        candidates.push_back({{middle - 0.5 * label.size, middle + 0.5 * label.size}, cost});
    };
    for (int ring = 0; ring < kRings; ++ring) {
        const int steps = ring == 0 ? 1 : 4; // on each side of the square from the middle to a corner
        for (int k = -steps; k <= steps; ++k) {
            const double t = static_cast<double>(k) / steps, aside = std::abs(t), far = kFarther * ring;
            add(ring, 1, t, far + 2 * aside);
            add(ring, -1, t, far + 3 + aside);
            if (aside == 1) continue; // corners are those of the sides
            add(ring, t, -1, far + 1);
            add(ring, t, 1, far + 1);
        }
    }
    return candidates;
}

bool crosses(const std::array<glm::dvec2, 2>& line, const Box& box) {
    double from = 0, to = 1;
    for (int axis = 0; axis < 2; ++axis) {
        const double at = line[0][axis], along = line[1][axis] - at;
        if (along == 0) {
            if (at <= box.low[axis] || at >= box.high[axis]) return false;
            continue;
        }
        const double a = (box.low[axis] - at) / along, b = (box.high[axis] - at) / along;
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    }
    return from < to;
}

} // namespace

std::vector<Box> placeLabels(std::span<const Label> labels, double markRadius, const Box& within,
                             std::span<const std::array<glm::dvec2, 2>> lines) {
    std::vector<std::vector<Candidate>> candidates;
    for (const Label& label : labels) {
        auto& own = candidates.emplace_back(candidatesOf(label, markRadius));
        for (Candidate& candidate : own) {
            const Box& box = candidate.box;
            if (box.low.x < within.low.x || box.low.y < within.low.y || box.high.x > within.high.x ||
                box.high.y > within.high.y)
                candidate.cost += kCovers;
            for (const Label& other : labels)
                if (box.covers({other.mark - markRadius, other.mark + markRadius})) candidate.cost += kCovers;
            for (const auto& line : lines)
                if (crosses(line, box)) candidate.cost += kCrosses;
        }
    }
    std::vector<size_t> taken(labels.size(), 0);
    for (int sweep = 0; sweep < kSweeps; ++sweep)
        for (size_t k = 0; k < labels.size(); ++k) {
            double least = INFINITY;
            for (size_t c = 0; c < candidates[k].size(); ++c) {
                double cost = candidates[k][c].cost;
                for (size_t other = 0; other < labels.size() && cost < least; ++other)
                    if (other != k && candidates[other][taken[other]].box.covers(candidates[k][c].box))
                        cost += kCovers;
                if (cost < least) least = cost, taken[k] = c;
            }
        }
    std::vector<Box> boxes;
    for (size_t k = 0; k < labels.size(); ++k) boxes.push_back(candidates[k][taken[k]].box);
    return boxes;
}

} // namespace heliodon::app
