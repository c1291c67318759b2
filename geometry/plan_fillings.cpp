#include "geometry/plan_fillings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <ranges>
#include <span>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"

namespace heliodon::geometry {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFacingSine = 0.26;   // 15 degrees: ends that look at each other
constexpr double kFacingOffset = 0.6;  // inches: by which they may miss one another
constexpr double kDoor = 1.05;         // times a crack's width from end to end: as wide as a door
constexpr double kSpike = 2;           // times the thickness of walls that touch: a tip longer than that
constexpr double kBesideCorner = 0.1;  // inches off what fills it
constexpr double kRunsBy = 0.5;        // inches: nearer to its end a wall does not run by another one
constexpr double kJustOut = 0.4;       // inches: what is an overshoot of a wall
constexpr double kTouching = 0.02;     // inches: what facets leave between walls that touch
constexpr double kWidestHole = 8;      // inches: of one in a straight side that is closed without a warning
constexpr double kAtHole = 0.6;        // inches: by which a wall stops short of one
constexpr double kAcross = 0.5;        // the sine of the angle between a slot and a wall that ends it
constexpr double kBeforePocket = 1.05; // times a crack's width: what air there is before its mouth

bool areOpposed(const WallEnd& e, const WallEnd& f) {
    return glm::dot(e.out, f.out) <= -std::cos(std::asin(kFacingSine));
}

// Two ends that look at each other over a crack: the crack is the hull of the two end faces.
std::vector<glm::dvec2> facingFill(const WallEnd& e, const WallEnd& f) {
    if (!areOpposed(e, f)) return {};
    const glm::dvec2 between = f.middle - e.middle;
    // Each lies ahead of the other, not beside it.
    const double ahead = glm::dot(between, e.out), aside = std::abs(cross(e.out, between));
    if (ahead < 0 || glm::dot(between, f.out) > 0 || aside > kFacingOffset) return {};
    const double solid = 0.5 * (glm::length(e.right - e.left) + glm::length(f.right - f.left));
    if (ahead < kTouching && aside > solid) return {}; // a sliver
    return {e.right, f.left, f.right, e.left};
}

class CrackFiller {
public:
    CrackFiller(PlanWalls& plan, double width) : plan_(plan), width_(width) {
        for (size_t i = 0; i < plan.pieces.size(); ++i) {
            const WallPiece& piece = plan.pieces[i];
            if (piece.curved && piece.a1 - piece.a0 >= 2 * kPi - 1e-9) continue;
            for (const bool atB : {false, true}) ends_.push_back(wallEnd(piece, static_cast<int>(i), atB));
        }
        physical_ = plan.solids;
    }

    void fill() {
        findNiches();
        for (size_t i = 0; i < ends_.size(); ++i)
            for (size_t j = i + 1; j < ends_.size(); ++j) fillBetweenEnds(ends_[i], ends_[j]);
        for (const WallEnd& end : ends_) fillToFace(end);
        for (size_t i = 0; i < plan_.pieces.size(); ++i)
            for (size_t j = i + 1; j < plan_.pieces.size(); ++j) {
                fillBetweenFaces(i, j);
                fillBesideArc(plan_.pieces[i], plan_.pieces[j]);
            }
    }

private:
    void add(std::vector<glm::dvec2> outline) {
        const double area = twiceArea(outline);
        if (std::abs(area) < 1e-9) return;
        if (area < 0) std::ranges::reverse(outline);
        PlanSolid solid;
        solid.sides.assign(outline.size(), SolidSide::end);
        solid.outline = std::move(outline);
        plan_.solids.push_back(std::move(solid));
    }

    double thickness(const WallEnd& e) const { return plan_.pieces[static_cast<size_t>(e.piece)].thickness; }
    double length(const WallEnd& e) const { return lengthOf(plan_.pieces[static_cast<size_t>(e.piece)]); }
    bool isCurved(const WallEnd& e) const { return plan_.pieces[static_cast<size_t>(e.piece)].curved; }

    void fillBetweenEnds(const WallEnd& e, const WallEnd& f) {
        const double apart = glm::length(f.middle - e.middle);
        const glm::dvec2 middle = 0.5 * (e.middle + f.middle);
        if (std::ranges::any_of(niches_, [&](const Niche& n) { return glm::length(n.mouth - middle) < 0.5; }))
            return;
        if (apart > 2.5 * width_ || (e.piece == f.piece && apart > width_)) return;
        if (apart <= width_)
            if (auto hull = facingFill(e, f); !hull.empty()) return add(hull);
        if (e.piece == f.piece || joined(e, f)) return;
        fillCorner(e, f);
        fillPast(e, f);
    }

    bool meetsWall(const WallEnd& e) const {
        return touches(physical_, e) || firstHit(physical_, e.middle, e.out, e.piece) <= width_;
    }

    // A divider with a step, whose parts hardly lie side by side, if at all: a bar leads across.
    void fillPast(const WallEnd& e, const WallEnd& f) {
        if (isCurved(e) || isCurved(f) || !areOpposed(e, f)) return;
        const glm::dvec2 between = f.middle - e.middle;
        const double ahead = glm::dot(between, e.out), aside = std::abs(cross(e.out, between)),
                     solid = (thickness(e) + thickness(f)) / 2;
        if (ahead < -kRunsBy || aside <= solid || clearance(e, f) > kNarrowSlot) return;
        if (meetsWall(e) || meetsWall(f)) return;
        const glm::dvec2 from = e.middle - thickness(e) / 2 * e.out, to = f.middle - thickness(f) / 2 * f.out,
                         half = std::min(thickness(e), thickness(f)) / 2 * leftOf(glm::normalize(to - from));
        add({from - half, to - half, to + half, from + half});
    }

    // By a piece from the one end to the other: a bevel, a rounding or a short side is no open corner.
    bool joined(const WallEnd& e, const WallEnd& f) const {
        const double near = 0.3 * glm::length(f.middle - e.middle);
        for (size_t k = 0; k + 1 < ends_.size(); ++k) {
            const WallEnd &a = ends_[k], &b = ends_[k + 1];
            if (a.piece != b.piece || a.piece == e.piece || a.piece == f.piece) continue;
            const auto between = [&](const WallEnd& from, const WallEnd& to) {
                return glm::length(from.middle - e.middle) < near && glm::length(to.middle - f.middle) < near;
            };
            if (between(a, b) || between(b, a)) return true;
        }
        return false;
    }

    // A corner that was left open: both walls run on to the far face of the other. Where they turn little it
    // may be as wide as a door.
    void fillCorner(const WallEnd& e, const WallEnd& f) {
        const double sine = cross(e.out, f.out);
        if (std::abs(sine) < kFacingSine) return;
        const glm::dvec2 between = f.middle - e.middle;
        const double te = cross(between, f.out) / sine, tf = cross(between, e.out) / sine;
        const double behindE = -thickness(f) / std::abs(sine), behindF = -thickness(e) / std::abs(sine);
        if (te < behindE || tf < behindF || te > width_ || tf > width_) return;
        if (te < -length(e) || tf < -length(f)) return; // beyond the wall's other end
        if ((te > kJustOut && endsInWall(e, f.piece)) || (tf > kJustOut && endsInWall(f, e.piece))) return;
        const glm::dvec2 crossing = e.middle + te * e.out;
        const glm::dvec2 u = e.out * (0.5 * thickness(f) / std::abs(sine));
        const glm::dvec2 v = f.out * (0.5 * thickness(e) / sine);
        const double tip = std::max(te + glm::length(u), tf + glm::length(v));
        if (glm::dot(e.out, f.out) > 0 && tip > kSpike * std::max(thickness(e), thickness(f)) &&
            (endsIn(e, f) || endsIn(f, e)))
            return;
        const size_t first = plan_.solids.size();
        const bool curved = isCurved(e) || isCurved(f);
        addStub(e, crossing + u - v, crossing + u + v, curved);
        addStub(f, crossing + v * std::copysign(1.0, sine) + u * std::copysign(1.0, sine),
                crossing + v * std::copysign(1.0, sine) - u * std::copysign(1.0, sine), curved);
        if (clearance(e, f) <= kDoor * width_) return;
        const glm::dvec2 middle = 0.5 * (e.middle + f.middle), beyond = glm::normalize(e.out + f.out);
        const double apex = std::min(glm::length(u - v), glm::length(u + v)),
                     half = std::max(thickness(e), thickness(f)) / 2;
        plan_.wideCorners.push_back(
            {first,
             plan_.solids.size(),
             {crossing + (apex + kBesideCorner) * beyond, middle - (half + kBesideCorner) * beyond}});
    }

    // Walls that meet side by side, as where an arc runs into a straight one, leave no corner open: a tip
    // before them would stand in whatever they end at, a door say.
    bool endsIn(const WallEnd& e, const WallEnd& f) const {
        const auto& outline = physical_[static_cast<size_t>(f.piece)].outline;
        return contains(outline, e.right) || contains(outline, e.left) || contains(outline, e.middle);
    }

    // In a wall, other than this one and not along it, or little out of one that it runs through: it was to
    // end there, and is not on its way to what lies ahead.
    bool endsInWall(const WallEnd& e, int except = -1) const {
        return std::ranges::any_of(physical_, [&](const PlanSolid& solid) {
            if (solid.piece == e.piece || solid.piece == except) return false;
            const WallPiece& other = plan_.pieces[static_cast<size_t>(solid.piece)];
            if (!other.curved && std::abs(cross(e.out, glm::normalize(other.b - other.a))) <= kParallelSine)
                return false;
            return contains(solid.outline, e.middle) ||
                   firstHit({&solid, 1}, e.middle, -e.out, -2) <= kJustOut;
        });
    }

    static double clearance(const WallEnd& e, const WallEnd& f) {
        return std::min({glm::length(e.right - f.right), glm::length(e.right - f.left),
                         glm::length(e.left - f.right), glm::length(e.left - f.left)});
    }

    // Lets the wall run on from its end face to the line from `right` to `left`, where that lies ahead of it.
    // A curved wall has its facets beside that line, and goes on over all of its end.
    void addStub(const WallEnd& e, glm::dvec2 right, glm::dvec2 left, bool curved) {
        constexpr double kWorthFilling = 1e-3;
        const double aheadRight = glm::dot(right - e.right, e.out),
                     aheadLeft = glm::dot(left - e.left, e.out);
        if (std::max(aheadRight, aheadLeft) < kWorthFilling) return;
        if (curved || std::min(aheadRight, aheadLeft) >= 0)
            return add({e.right, aheadRight > 0 ? right : e.right, aheadLeft > 0 ? left : e.left, e.left});
        const glm::dvec2 at = glm::mix(right, left, aheadRight / (aheadRight - aheadLeft)); // the end face
        aheadRight > 0 ? add({e.right, right, at}) : add({at, left, e.left});
    }

    // An end that stops short of another wall's face.
    void fillToFace(const WallEnd& e) {
        if (touches(plan_.solids, e) && !endsBesideCopy(e)) return weldOn(e);
        int hit = -1;
        const double t = firstHit(physical_, e.middle, e.out, e.piece, &hit);
        if (std::isinf(t)) return fillToHole(e);
        if (t > width_ || endsInWall(e)) return;
        const std::span target(&physical_[static_cast<size_t>(hit)], 1);
        const auto reach = [&](glm::dvec2 corner) {
            const double own = firstHit(target, corner, e.out, -2);
            return corner + ((own < t + 2 * thickness(e) ? own : t) + 0.02) * e.out;
        };
        add({e.right, reach(e.right), reach(e.left), e.left});
    }

    // One that stops short of a hole in a straight side: that is closed in line with the wall's face, if it
    // is an outer one, and parts two rooms there.
    void fillToHole(const WallEnd& e) {
        for (size_t i = 0; i + 1 < plan_.pieces.size(); ++i) {
            const WallPiece &p = plan_.pieces[i], &q = plan_.pieces[i + 1]; // along their side
            if (p.line < 0 || p.line != q.line || p.line == plan_.pieces[static_cast<size_t>(e.piece)].line)
                continue;
            const glm::dvec2 d = glm::normalize(p.b - p.a);
            const double sine = cross(e.out, d), width = glm::dot(q.a - p.b, d);
            if (std::abs(sine) < kAcross) continue;
            const auto toFace = [&](glm::dvec2 from) {
                return cross(p.b - from, d) / sine - std::max(p.thickness, q.thickness) / 2 / std::abs(sine);
            };
            const double ahead = toFace(e.middle), at = glm::dot(e.middle + ahead * e.out - p.b, d);
            if (ahead <= 0 || ahead > kAtHole || at < 0 || at > width || width > kWidestHole) continue;
            add({e.right, e.right + (toFace(e.right) + 0.02) * e.out,
                 e.left + (toFace(e.left) + 0.02) * e.out, e.left});
        }
    }

    // With air ahead of it and only walls that run beside it round it: one of a wall that was laid twice, no
    // end that stands against another wall.
    bool endsBesideCopy(const WallEnd& e) const {
        const glm::dvec2 ahead = e.middle + 1e-4 * e.out, behind = e.middle - 1e-2 * e.out;
        return std::ranges::none_of(plan_.solids, [&](const PlanSolid& solid) {
            if (solid.piece == e.piece) return false;
            if (contains(solid.outline, ahead)) return true;
            if (!contains(solid.outline, behind)) return false;
            if (solid.piece < 0) return true;
            const WallPiece& other = plan_.pieces[static_cast<size_t>(solid.piece)];
            return other.curved || std::abs(cross(e.out, glm::normalize(other.b - other.a))) > kParallelSine;
        });
    }

    // Faces that touch may miss one another by a rounding error: a hair more wall closes that.
    void weldOn(const WallEnd& e) {
        constexpr double kHair = 0.02;
        const bool overlaps = std::ranges::any_of(plan_.solids, [&](const PlanSolid& solid) {
            const glm::dvec2 inside = e.middle + (solid.piece < 0 ? 1e-4 : -kHair / 2) * e.out;
            return solid.piece != e.piece && contains(solid.outline, inside);
        });
        if (!overlaps) add({e.right, e.right + kHair * e.out, e.left + kHair * e.out, e.left});
    }

    // The air between two walls side by side.
    struct Slot {
        std::array<glm::dvec2, 2> onP, onQ; // from end to end along the walls' centre lines
        double least = 0, most = 0;         // inches from face to face
        std::array<glm::dvec2, 2> middle;   // of the air, from end to end
    };

    std::optional<Slot> slotBetween(const WallPiece& p, const WallPiece& q) const {
        if (p.curved || q.curved || p.line == q.line) return std::nullopt;
        const glm::dvec2 d = glm::normalize(p.b - p.a);
        if (std::abs(cross(d, glm::normalize(q.b - q.a))) > kParallelSine) return std::nullopt;
        const bool same = glm::dot(d, q.b - q.a) > 0;
        const glm::dvec2 qa = same ? q.a : q.b, qb = same ? q.b : q.a;
        const double length = glm::length(p.b - p.a), q0 = glm::dot(qa - p.a, d), q1 = glm::dot(qb - p.a, d);
        const double s0 = std::max(0.0, q0), s1 = std::min(length, q1);
        if (s1 - s0 < 0.5) return std::nullopt;
        const auto onP = [&](double s) { return p.a + s * d; };
        const auto onQ = [&](double s) { return qa + (s - q0) / (q1 - q0) * (qb - qa); };
        const double to0 = cross(d, onQ(s0) - onP(s0)), to1 = cross(d, onQ(s1) - onP(s1));
        if ((to0 < 0) != (to1 < 0)) return std::nullopt; // they cross
        const double gap0 = std::abs(to0), gap1 = std::abs(to1), solid = (p.thickness + q.thickness) / 2;
        Slot slot{{onP(s0), onP(s1)},
                  {onQ(s0), onQ(s1)},
                  std::min(gap0, gap1) - solid,
                  std::max(gap0, gap1) - solid};
        for (const size_t k : {0, 1}) {
            const glm::dvec2 across = slot.onQ[k] - slot.onP[k];
            slot.middle[k] =
                slot.onP[k] + (0.5 + (p.thickness - q.thickness) / 4 / glm::length(across)) * across;
        }
        return slot;
    }

    // Where along the slot's middle, from 0 to 1, a third wall lies across it: from face to face, but for
    // what a hand leaves.
    std::vector<double> wallsAcross(const Slot& slot, size_t i, size_t j) const {
        std::vector<double> out;
        const glm::dvec2 along = slot.middle[1] - slot.middle[0];
        const double length = glm::length(along), reach = slot.most / 2 - kJustOut;
        for (size_t k = 0; k < plan_.pieces.size(); ++k) {
            const WallPiece& wall = plan_.pieces[k];
            if (k == i || k == j || wall.curved) continue;
            const glm::dvec2 d = glm::normalize(wall.b - wall.a);
            const double sine = cross(along / length, d);
            if (std::abs(sine) < kAcross) continue;
            const double at = cross(wall.a - slot.middle[0], d) / sine, // inches
                toA = cross(along / length, wall.a - slot.middle[0]),
                         toB = cross(along / length, wall.b - slot.middle[0]),
                         beyond = wall.thickness / 2 + kJustOut;
            if (std::max(toA, toB) >= reach && std::min(toA, toB) <= -reach && at > -beyond &&
                at < length + beyond)
                out.push_back(std::clamp(at / length, 0.0, 1.0));
        }
        std::ranges::sort(out);
        return out;
    }

    // How far a straight wall goes on beyond the point.
    static double aheadOf(const WallPiece& wall, glm::dvec2 from, glm::dvec2 way) {
        return std::max(glm::dot(wall.a - from, way), glm::dot(wall.b - from, way));
    }

    // Whether the next piece of a wall's straight side begins within a crack ahead.
    bool goesOn(size_t wall, glm::dvec2 from, glm::dvec2 way) const {
        for (size_t k = 0; k < plan_.pieces.size(); ++k) {
            const WallPiece& next = plan_.pieces[k];
            if (k == wall || next.line < 0 || next.line != plan_.pieces[wall].line) continue;
            const double toA = glm::dot(next.a - from, way), toB = glm::dot(next.b - from, way);
            if (std::min(toA, toB) < width_ && std::max(toA, toB) > kRunsBy) return true;
        }
        return false;
    }

    // Whether a third wall beside one of the two, as far from it as is no crack, ends with them.
    bool isAmongFins(size_t i, size_t j, glm::dvec2 mouth, glm::dvec2 way) const {
        for (size_t k = 0; k < plan_.pieces.size(); ++k) {
            const WallPiece& third = plan_.pieces[k];
            if (k == i || k == j || third.curved || std::abs(aheadOf(third, mouth, way)) > kRunsBy) continue;
            for (const size_t beside : {i, j})
                if (const auto slot = slotBetween(plan_.pieces[beside], third);
                    slot && slot->least >= kNarrowestNiche && slot->most <= kNarrowSlot)
                    return true;
        }
        return false;
    }

    void fillBetweenFaces(size_t i, size_t j) {
        if (std::ranges::find(niches_, std::pair(i, j), &Niche::walls) != niches_.end()) return;
        const std::optional<Slot> slot = slotBetween(plan_.pieces[i], plan_.pieces[j]);
        if (!slot || slot->least <= 0 || slot->most > kNarrowSlot) return;
        double from = 0, to = 1;
        if (slot->least >= kNarrowestNiche) {
            // What a third wall parts off is a pocket of the room that it opens to, as beside a pilaster and
            // behind the head of a T, where one of the two walls runs on. Two that end together are one wall,
            // three and more are fins.
            const std::vector<double> across = wallsAcross(*slot, i, j);
            const glm::dvec2 out = glm::normalize(slot->middle[1] - slot->middle[0]);
            const auto isOpen = [&](glm::dvec2 mouth, glm::dvec2 way) {
                const size_t ending =
                    aheadOf(plan_.pieces[i], mouth, way) < aheadOf(plan_.pieces[j], mouth, way) ? i : j;
                return (aheadOf(plan_.pieces[i + j - ending], mouth, way) > kRunsBy ||
                        isAmongFins(i, j, mouth, way)) &&
                       !goesOn(ending, mouth, way) &&
                       firstHit(physical_, mouth, way, -2) > kBeforePocket * width_;
            };
            if (!across.empty() && isOpen(slot->middle[0], -out)) from = across.front();
            if (!across.empty() && isOpen(slot->middle[1], out)) to = across.back();
        }
        const auto at = [](const std::array<glm::dvec2, 2>& line, double t) {
            return glm::mix(line[0], line[1], t);
        };
        if (from < to) add({at(slot->onP, from), at(slot->onP, to), at(slot->onQ, to), at(slot->onQ, from)});
    }

    // Whether the arc has a part to either side of the point in that direction from its centre.
    static bool runsBy(const WallPiece& arc, glm::dvec2 direction) {
        double angle = std::atan2(direction.y, direction.x) - arc.a0;
        angle -= 2 * kPi * std::floor(angle / (2 * kPi));
        const double turn = arc.a1 - arc.a0, beside = kRunsBy / arc.radius;
        return turn >= 2 * kPi - 1e-9 || (angle > beside && angle < turn - beside);
    }

    // Where a curved wall bulges towards another one and comes nearest to it, there is no way through: the
    // crack has a bar across.
    void fillBesideArc(const WallPiece& p, const WallPiece& q) {
        if (!p.curved && !q.curved) return;
        const WallPiece &arc = p.curved ? p : q, &other = p.curved ? q : p;
        glm::dvec2 onArc, onOther;
        double apart = 0; // of the centre lines
        if (other.curved) {
            const glm::dvec2 d = other.center - arc.center;
            const double off = glm::length(d);
            if (off < kNarrowSlot) return; // side by side
            const glm::dvec2 to = d / off;
            const bool outside = off > std::max(arc.radius, other.radius);
            const double way = outside || arc.radius > other.radius ? 1 : -1,
                         back = outside || arc.radius < other.radius ? -1 : 1;
            onArc = arc.center + way * arc.radius * to;
            onOther = other.center + back * other.radius * to;
            if (!runsBy(arc, way * to) || !runsBy(other, back * to)) return;
            apart = outside ? off - arc.radius - other.radius : std::abs(arc.radius - other.radius) - off;
        } else {
            const glm::dvec2 along = glm::normalize(other.b - other.a);
            const double at = glm::dot(arc.center - other.a, along);
            if (at < kRunsBy || at > glm::length(other.b - other.a) - kRunsBy) return;
            onOther = other.a + at * along;
            const double off = glm::length(onOther - arc.center);
            if (off < arc.radius || !runsBy(arc, onOther - arc.center)) return;
            onArc = glm::mix(arc.center, onOther, arc.radius / off);
            apart = off - arc.radius;
        }
        const double gap = apart - (arc.thickness + other.thickness) / 2;
        if (gap < -kTouching || gap > kNarrowSlot || apart <= 0) return;
        const glm::dvec2 d = (onOther - onArc) / apart,
                         side = std::min(arc.thickness, other.thickness) / 2 * glm::dvec2(-d.y, d.x);
        add({onArc - side, onArc + side, onOther + side, onOther - side});
    }

    // A slot that a third wall ends, with nothing before its mouth: whoever laid that wall meant it.
    struct Niche {
        std::pair<size_t, size_t> walls;
        glm::dvec2 mouth;
    };

    void findNiches() {
        for (size_t i = 0; i < plan_.pieces.size(); ++i)
            for (size_t j = i + 1; j < plan_.pieces.size(); ++j) {
                const std::optional<Slot> slot = slotBetween(plan_.pieces[i], plan_.pieces[j]);
                if (!slot || slot->least < kNarrowestNiche || slot->most > width_) continue;
                if (const auto mouth = mouthOf(i, j)) niches_.push_back({{i, j}, *mouth});
            }
    }

    std::optional<glm::dvec2> mouthOf(size_t i, size_t j) const {
        std::optional<glm::dvec2> mouth;
        int ends = 0;
        for (const WallEnd& e : ends_) {
            if (e.piece != static_cast<int>(i)) continue;
            for (const WallEnd& f : ends_) {
                if (f.piece != static_cast<int>(j) || glm::dot(e.out, f.out) < 0) continue;
                const glm::dvec2 middle = 0.5 * (e.middle + f.middle);
                if (joined(e, f))
                    ++ends;
                else if (firstHit(physical_, middle, e.out, -2) > 2 * width_)
                    mouth = middle;
            }
        }
        return ends == 1 ? mouth : std::nullopt;
    }

    PlanWalls& plan_;
    double width_;
    std::vector<WallEnd> ends_;
    std::vector<PlanSolid> physical_;
    std::vector<Niche> niches_;
};

} // namespace

void fillCracks(PlanWalls& plan, double width) {
    CrackFiller(plan, width).fill();
}

bool openDoorsInCorners(PlanWalls& plan, const std::vector<RoomPlan>& rooms) {
    const size_t before = plan.solids.size();
    const auto inRoom = [&](glm::dvec2 p) {
        return std::ranges::any_of(rooms, [&](const RoomPlan& room) { return contains(room, p); });
    };
    for (const WideCorner& corner : std::views::reverse(plan.wideCorners))
        if (std::ranges::all_of(corner.beside, inRoom))
            plan.solids.erase(plan.solids.begin() + static_cast<std::ptrdiff_t>(corner.firstSolid),
                              plan.solids.begin() + static_cast<std::ptrdiff_t>(corner.endSolid));
    plan.wideCorners.clear();
    return plan.solids.size() < before;
}

void reachWalls(PlanWalls& plan) {
    constexpr double kHair = 0.3, kOnFace = 1e-6; // inches
    for (WallPiece& piece : plan.partitions) {
        if (piece.curved) continue;
        for (const bool atB : {false, true}) {
            const WallEnd end = wallEnd(piece, 0, atB);
            const glm::dvec2 at = end.middle - kOnFace * end.out; // what lies on a face is not within
            const bool within = std::ranges::any_of(
                plan.solids, [&](const PlanSolid& solid) { return contains(solid.outline, at); });
            if (within) continue; // on would be out again, into the next room
            const double ahead = firstHit(plan.solids, at, end.out, -2),
                         behind = firstHit(plan.solids, at, -end.out, -2);
            glm::dvec2& moved = atB ? piece.b : piece.a;
            if (ahead < kHair)
                moved += (ahead + piece.thickness / 2) * end.out;
            else if (behind < kHair && glm::length(piece.b - piece.a) > 2 * kHair + piece.thickness)
                moved -= (behind + piece.thickness / 2) * end.out;
        }
    }
}

} // namespace heliodon::geometry
