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
constexpr double kLeaning = 0.07;  // the sine of 4 degrees: walls at more stand side by side along some of
                                   // their length, and are no layers of one wall

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

bool leans(const WallLine& line, const WallLine& other) {
    return std::abs(cross(line.direction, other.direction)) > kLeaning;
}

// Where on the stretch the offset, which rises or falls evenly along it, lies between the two.
template<class Offset> Stretch within(Stretch on, const Offset& offset, double least, double most) {
    const double first = offset(on.from), last = offset(on.to), slope = (last - first) / on.length();
    const auto [low, high] =
        std::minmax({on.from + (least - first) / slope, on.from + (most - first) / slope});
    return {std::max(on.from, low), std::min(on.to, high)};
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
        bool partsRooms = false;
        for (const WallRun& beyond : runs)
            if (beyond.line == id && glm::dot(leftOf(beyond.to - beyond.from), out) > 0) {
                const auto [low, high] = std::minmax({other.along(beyond.from), other.along(beyond.to)});
                wall.push_back({low - kIntoCorner, high + kIntoCorner});
                partsRooms = true;
            }
        for (const Stretch& theirs : merged(std::move(wall), 0)) {
            const auto [low, high] = std::minmax({start + cosine * theirs.from, start + cosine * theirs.to});
            Stretch both{std::max(on.from, low), std::min(on.to, high)};
            if (both.length() <= 0) continue;
            const auto offsetAt = [&](double s) {
                return glm::dot(other.at((s - start) / cosine) - line.origin, out);
            };
            const auto thicknessAt = [&](Stretch s) {
                const double t = ((s.from + s.to) / 2 - start) / cosine, half = s.length() / 2;
                return thicknessAlong(plan, id, {t - half, t + half});
            };
            const auto standsBetween = [&](Stretch s, bool filling) { // by solids of this kind
                const double middle = (s.from + s.to) / 2, gap = offsetAt(middle) - face - thicknessAt(s) / 2;
                const glm::dvec2 before = line.at(middle) + (face + gap / 2) * out;
                return gap > kTouching && std::ranges::any_of(plan.solids, [&](const PlanSolid& solid) {
                           return (solid.piece < 0) == filling && contains(solid.outline, before);
                       });
            };
            const double most =
                face + thicknessAt(both) / 2 + (standsBetween(both, true) ? kNarrowSlot : kNarrowestNiche);
            // One that leans against this wall, or crosses it, stands before it from there on. Of those that
            // hardly turn, a copy may cross it; one with a room behind it is none.
            const auto [inner, outer] = std::minmax({offsetAt(low), offsetAt(high)});
            const bool slanted =
                outer > kSameWall && (leans(line, other) || (partsRooms && inner < -kSameWall));
            const double least = slanted ? 0 : kSameWall;
            if (slanted) both = within(both, offsetAt, least, most);
            const double middle = (both.from + both.to) / 2, t = (middle - start) / cosine,
                         half = both.length() / 2;
            if (half <= 0 || offsetAt(middle) < least || offsetAt(middle) > most ||
                standsBetween(both, false))
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
    if (leans(line, layer) || isSeen(plan, runs, wall.line, on)) return false;
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
