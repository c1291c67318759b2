#include "geometry/facing_walls.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"
#include "geometry/plan_fillings.h"
#include "geometry/plan_windows.h"

namespace heliodon::geometry {

namespace {

constexpr double kTouching = 1e-6; // inches: nothing stands in a narrower gap
constexpr double kSameWall = 0.1;  // inches: what is nearer to a wall's middle does not stand before it

// Those that are no farther apart than `gap` as one.
std::vector<Stretch> merged(std::vector<Stretch> all, double gap) {
    std::ranges::sort(all, {}, &Stretch::from);
    for (size_t i = 0; i + 1 < all.size();)
        if (all[i + 1].from <= all[i].to + gap) {
            all[i].to = std::max(all[i].to, all[i + 1].to);
            all.erase(all.begin() + static_cast<std::ptrdiff_t>(i) + 1);
        } else
            ++i;
    return all;
}

// The longest piece of the side along the stretch, or the nearest one; `height` is that of the highest.
FacingWall pieceAlong(const PlanWalls& plan, int id, Stretch on) {
    const WallLine& line = plan.lines[static_cast<size_t>(id)];
    FacingWall out{id};
    double most = -1e9;
    for (const WallPiece& piece : plan.pieces) {
        if (piece.line != id) continue;
        const double common = std::min(on.to, line.along(piece.b)) - std::max(on.from, line.along(piece.a));
        if (common > 0 || out.id.empty()) out.height = std::max(out.height, piece.height);
        if (common > most) {
            most = common;
            out.id = piece.ids.front();
        }
    }
    return out;
}

double thicknessAlong(const PlanWalls& plan, int id, Stretch on) {
    const WallLine& line = plan.lines[static_cast<size_t>(id)];
    double most = 0;
    for (const WallPiece& piece : plan.pieces)
        if (piece.line == id && line.along(piece.b) > on.from && line.along(piece.a) < on.to)
            most = std::max(most, piece.thickness);
    return most;
}

} // namespace

std::vector<Stretch> coveredStretches(const PlanWalls& plan, int id) {
    const WallLine& line = plan.lines[static_cast<size_t>(id)];
    std::vector<Stretch> out;
    for (const WallPiece& piece : plan.pieces)
        if (piece.line == id) out.push_back({line.along(piece.a), line.along(piece.b)});
    return merged(std::move(out), plan.crackWidth);
}

std::vector<FacingWall> wallsBefore(const PlanWalls& plan, const std::vector<WallRun>& runs,
                                    const WallRun& run, Stretch on) {
    const WallLine& line = plan.lines[static_cast<size_t>(run.line)];
    const glm::dvec2 out = (run.leftFace ? -1.0 : 1.0) * leftOf(line.direction);
    const double face = thicknessAlong(plan, run.line, on) / 2;
    std::vector<FacingWall> walls;
    for (int id = 0; id < static_cast<int>(plan.lines.size()); ++id) {
        const WallLine& other = plan.lines[static_cast<size_t>(id)];
        if (id == run.line || std::abs(cross(line.direction, other.direction)) > kParallelSine) continue;
        const double start = line.along(other.origin), cosine = glm::dot(line.direction, other.direction);
        std::vector<Stretch> wall = coveredStretches(plan, id);
        for (const WallRun& beyond : runs)
            if (beyond.line == id && glm::dot(leftOf(beyond.to - beyond.from), out) > 0) {
                const auto [low, high] = std::minmax({other.along(beyond.from), other.along(beyond.to)});
                wall.push_back({low - kIntoCorner, high + kIntoCorner});
            }
        for (const Stretch& theirs : merged(std::move(wall), 0)) {
            const auto [low, high] = std::minmax({start + cosine * theirs.from, start + cosine * theirs.to});
            const Stretch both{std::max(on.from, low), std::min(on.to, high)};
            if (both.length() <= 0) continue;
            const double middle = (both.from + both.to) / 2, t = (middle - start) / cosine,
                         half = both.length() / 2;
            const double offset = glm::dot(other.at(t) - line.origin, out);
            const double gap = offset - face - thicknessAlong(plan, id, {t - half, t + half}) / 2;
            const glm::dvec2 before = line.at(middle) + (face + gap / 2) * out;
            bool filled = false, another = false; // what stands between the two
            for (const PlanSolid& solid : plan.solids)
                if (gap > kTouching && contains(solid.outline, before))
                    (solid.piece < 0 ? filled : another) = true;
            if (offset < kSameWall || another || gap > kNarrowSlot || (gap > kNarrowestNiche && !filled))
                continue;
            FacingWall found = pieceAlong(plan, id, {t - half, t + half});
            found.on = both;
            walls.push_back(found);
        }
    }
    return walls;
}

bool isOuterLayer(const PlanWalls& plan, const std::vector<WallRun>& runs, const WallRun& run,
                  const FacingWall& wall) {
    const WallLine &line = plan.lines[static_cast<size_t>(run.line)],
                   &layer = plan.lines[static_cast<size_t>(wall.line)];
    const Stretch on = alongOther(line, wall.on, layer);
    if (isSeen(plan, runs, wall.line, on)) return false;
    WallRun outside;
    outside.line = wall.line;
    outside.leftFace = run.leftFace == (glm::dot(line.direction, layer.direction) > 0);
    return std::ranges::all_of(wallsBefore(plan, runs, outside, on), [&](const FacingWall& next) {
        return isOuterLayer(plan, runs, outside, next);
    });
}

bool isSeen(const PlanWalls& plan, const std::vector<WallRun>& runs, int line, Stretch on) {
    return std::ranges::any_of(runs, [&](const WallRun& run) {
        if (run.line != line) return false;
        const WallLine& side = plan.lines[static_cast<size_t>(line)];
        const auto [low, high] = std::minmax({side.along(run.from), side.along(run.to)});
        return low < on.to - kIntoCorner && high > on.from + kIntoCorner;
    });
}

Stretch alongOther(const WallLine& line, Stretch on, const WallLine& other) {
    const auto [from, to] = std::minmax({other.along(line.at(on.from)), other.along(line.at(on.to))});
    return {from, to};
}

} // namespace heliodon::geometry
