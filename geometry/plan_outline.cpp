// Makes the outlines of rooms fit to be built: no jogs that only noise explains, no corner that two walls of
// air share, nothing that comes so near to something else that a triangle between them would have no area.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include <glm/geometric.hpp>

#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"
#include "geometry/plan_curves.h"
#include "geometry/plan_pinches.h"
#include "geometry/plan_rooms.h"

namespace heliodon::geometry {

namespace {

constexpr double kShortEdge = 0.12;  // inches: shorter steps are noise
constexpr double kOvershoot = 0.4;   // inches: a wall that runs on past another one by less was to end there,
constexpr double kThrough = 1.5;     // where this much of it is drawn, or in a corner twice what stands out
constexpr double kCorner = 0.6;      // inches from a corner: what the ends of the walls that meet there leave
constexpr double kHead = 1.0 / 3;    // of what stands out on both sides, on one: more is meant
constexpr double kSharp = 2;         // times the thickness of walls: how long tips of corners may be
constexpr double kSlant = 0.1;       // the sine of the angle between walls that are one side, or that meet
constexpr double kSquare = 0.2;      // the cosine of the angle between a wall and its end
constexpr double kNarrowCrack = 0.5; // inches
constexpr double kInLine = 1e-3;     // the sine of the angle between a straight wall and what goes on with it
constexpr double kRound = 0.4;       // the same of a curved one, whose facets turn
constexpr double kTouches = 1e-5;    // inches
constexpr double kTie = 1e-7;        // inches: lengths that differ by less are equal but for rounding
constexpr double kMostCut = 0.45;    // of an edge, at a sharp corner
constexpr double kOnLine = 1e-4;     // inches off the line between its neighbours: no corner
constexpr double kStraightSine = 1.1e-5; // nor is one that turns by less

// True when the two cross or touch.
bool meet(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d) {
    if (beside(a.x, b.x, c.x, d.x) || beside(a.y, b.y, c.y, d.y)) return false;
    const auto turn = [](glm::dvec2 p, glm::dvec2 q, glm::dvec2 r) { return cross(q - p, r - p); };
    return turn(a, b, c) * turn(a, b, d) <= 0 && turn(c, d, a) * turn(c, d, b) <= 0;
}

// From the line between its neighbours.
double offLine(glm::dvec2 before, glm::dvec2 at, glm::dvec2 after) {
    return std::abs(cross(after - before, at - before)) / glm::length(after - before);
}

bool straightCorner(glm::dvec2 before, glm::dvec2 at, glm::dvec2 after) {
    const glm::dvec2 in = at - before, out = after - at;
    if (glm::dot(in, out) <= 0) return false;
    return offLine(before, at, after) <= kOnLine ||
           std::abs(cross(in, out)) <= kStraightSine * glm::length(in) * glm::length(out);
}

// One loop of a room; what it does to that never makes outlines cross, of this room or of others.
class LoopCleaner {
public:
    LoopCleaner(const PlanWalls& plan, const std::vector<RoomPlan>& rooms, OutlineLoop& loop)
        : plan_(plan), rooms_(rooms), loop_(loop) {}

    void clean() {
        // Corners that are one but for rounding hide what lies beside them.
        while (size() > 3 && dropShort(kTouches)) {
        }
        // Before short steps go, which may take the wall's direction from cracks, and once what stood between
        // them and the wall has gone.
        for (int round = 0; round < 2; ++round) {
            hideCracks();
            while (size() > 3 && (mergeAlike() || dropOvershoot() || dropShort(kShortEdge) || dropSpike())) {
            }
        }
    }

private:
    size_t size() const { return loop_.points.size(); }
    glm::dvec2 point(size_t i) const { return loop_.points[i % size()]; }
    glm::dvec2 edge(size_t i) const { return point(i + 1) - point(i); }
    OutlineEdge& info(size_t i) { return loop_.edges[i % size()]; }

    // Drops corner i and the edge that begins there.
    void erase(size_t i) {
        loop_.points.erase(loop_.points.begin() + static_cast<std::ptrdiff_t>(i % size()));
        loop_.edges.erase(loop_.edges.begin() + static_cast<std::ptrdiff_t>(i % loop_.edges.size()));
    }

    // Whether the outlines stay apart, those of other rooms too, when the corners between `from` and `to`
    // make way for one at `corner`, or for none.
    bool fits(size_t from, size_t to, std::optional<glm::dvec2> corner = std::nullopt) const {
        const size_t n = size(), gone = (to + n - from) % n; // edges
        const glm::dvec2 a = point(from), b = point(to);
        for (const RoomPlan& room : rooms_)
            for (const OutlineLoop& other : room.loops)
                for (size_t i = 0, m = other.points.size(); i < m; ++i) {
                    if (&other == &loop_ && (i + n - from % n) % n < gone) continue;
                    if (!keepsApart(a, b, corner, other.points[i], other.points[(i + 1) % m])) return false;
                }
        return true;
    }

    // The edge from c to d, from those from a to b by the corner.
    static bool keepsApart(glm::dvec2 a, glm::dvec2 b, std::optional<glm::dvec2> corner, glm::dvec2 c,
                           glm::dvec2 d) {
        // Where outlines touch already they are parted later.
        const auto touching = [&](glm::dvec2 p) {
            return glm::length(c - p) < kTouches || glm::length(d - p) < kTouches;
        };
        if (!corner) return touching(a) || touching(b) || !meet(a, b, c, d);
        return touching(*corner) ||
               ((touching(a) || !meet(a, *corner, c, d)) && (touching(b) || !meet(*corner, b, c, d)));
    }

    bool onArc(const OutlineEdge& edge) const {
        return edge.piece >= 0 && plan_.pieces[static_cast<size_t>(edge.piece)].curved;
    }

    // A crack in the side of a wall is too narrow to be told from it: it is shown as the wall is, and takes
    // part in its facets. Of walls on both its sides the higher one counts, of equals the longer one. Cracks
    // that follow one another are asked at once: the way round the outline changes nothing.
    void hideCracks() {
        const std::vector<OutlineEdge> drawn = loop_.edges;
        for (size_t i = 0; i < size(); ++i) {
            if (drawn[i].height > 0 || drawn[i].gap || glm::length(edge(i)) > kNarrowCrack) continue;
            std::pair best(0.0, 0.0);
            for (const size_t beside : {(i + size() - 1) % size(), (i + 1) % size()}) {
                const std::pair rank(drawn[beside].height, glm::length(edge(beside)));
                if (rank.first == 0 || rank <= best || glm::dot(edge(beside), edge(i)) <= 0 ||
                    std::abs(cross(edge(beside), edge(i))) >=
                        (onArc(drawn[beside]) ? kRound : kInLine) * rank.second * glm::length(edge(i)))
                    continue;
                best = rank;
                info(i) = drawn[beside];
            }
        }
    }

    // The straightest corner first: of two, one may be straight only as long as the other is there.
    bool mergeAlike() {
        std::vector<std::pair<double, size_t>> straight;
        for (size_t i = 0; i < size(); ++i) {
            const size_t before = i + size() - 1;
            if (info(before).height != info(i).height || info(before).gap != info(i).gap) continue;
            if (straightCorner(point(before), point(i), point(i + 1)))
                straight.emplace_back(offLine(point(before), point(i), point(i + 1)), i);
        }
        std::ranges::sort(straight);
        for (const auto& [off, i] : straight) {
            const size_t before = i + size() - 1;
            if (!fits(before, i + 1)) continue;
            if (glm::length(edge(i)) > glm::length(edge(before))) info(before) = info(i);
            erase(i);
            return true;
        }
        return false;
    }

    // Whether edge i is of the end of a wall, and not of its length.
    bool isEndOfWall(size_t i) {
        if (info(i).piece < 0 || onArc(info(i))) return false;
        const WallPiece& piece = plan_.pieces[static_cast<size_t>(info(i).piece)];
        const glm::dvec2 wall = piece.b - piece.a;
        return std::abs(glm::dot(wall, edge(i))) < kSquare * glm::length(wall) * glm::length(edge(i));
    }

    bool ofOneSide(int piece, int other) const { // straight ones
        const WallPiece& wall = plan_.pieces[static_cast<size_t>(piece)];
        return piece == other || (!wall.curved && wall.line == plan_.pieces[static_cast<size_t>(other)].line);
    }

    double thicknessOf(int piece) const { return plan_.pieces[static_cast<size_t>(piece)].thickness; }
    double lengthOf(int piece) const { // of a straight one
        const WallPiece& wall = plan_.pieces[static_cast<size_t>(piece)];
        return glm::length(wall.b - wall.a);
    }

    // By which edges are taken in turn, so that where the outline begins changes nothing: the length, and of
    // equal ones, as ends of walls are, those of the edges beside it. Lengths are equal but for rounding.
    std::array<double, 3> rank(size_t i) const {
        const auto rounded = [&](size_t k) { return std::round(glm::length(edge(k)) / kTie); };
        const auto [least, most] = std::minmax({rounded(i + size() - 1), rounded(i + 1)});
        return {rounded(i), most, least};
    }

    // A wall that runs on past another one by little, or whose square end does at a slant, ends where the
    // faces of the two meet. The longest ends first.
    bool dropOvershoot() {
        std::vector<std::pair<std::array<double, 3>, size_t>> ends;
        for (size_t i = 0; i < size(); ++i)
            if (isEndOfWall(i) || (info(i).piece < 0 && !info(i).gap)) ends.emplace_back(rank(i), i);
        std::ranges::sort(ends, std::greater(), [](const auto& end) { return end.first; });
        return std::ranges::any_of(ends, [&](const auto& end) {
            return (isEndOfWall(end.second) && endAtFace(end.second)) || endAtCorner(end.second);
        });
    }

    // Edge i stands before a face that runs on behind it, or a part of it at a slant.
    bool endAtFace(size_t i) {
        const size_t before = i + size() - 1;
        return standsOut(i, before, i + 2) || standsOut(i, i, i + 2) || standsOut(i, before, i + 1);
    }

    // Edge i, with one or both sides of its wall, between two corners on that face.
    bool standsOut(size_t i, size_t first, size_t last) {
        const size_t count = (last + size() - first) % size();
        if (size() < count + 3 || lengthOf(info(i).piece) < kThrough + kTouches) return false;
        const glm::dvec2 face = point(last) - point(first);
        double sides = 0; // of the wall
        for (size_t k = first; k < first + count; ++k) {
            if (info(k).piece != info(i).piece || (k > first && cross(edge(k + size() - 1), edge(k)) >= 0))
                return false;
            if (k % size() != i % size()) sides += glm::length(edge(k));
        }
        for (const size_t k : {first + size() - 1, last})
            if (glm::dot(edge(k), face) <= 0 ||
                std::abs(cross(edge(k), face)) > kSlant * glm::length(edge(k)) * glm::length(face))
                return false;
        if (beyondFace(i, sides, count) > kOvershoot || !fits(first, last)) return false;
        info(first) = info(first + size() - 1);
        erase(first + 1, count - 1);
        return true;
    }

    // How far the middle of the wall stands out; of a corner of it (two edges) that stands out at a slant.
    double beyondFace(size_t end, double sides, size_t count) {
        if (count == 3) return sides / 2;
        if (sides > kSharp * thicknessOf(info(end).piece)) return sides;
        return sides * (1 - thicknessOf(info(end).piece) / (2 * glm::length(edge(end))));
    }

    // Edge i lies among short ones between the faces of two walls: these go on to where they meet.
    bool endAtCorner(size_t i) {
        for (size_t count = 2; count < 10 && count + 2 < size(); ++count) // of corners that go
            for (size_t first = i + size() + 2 - count; first <= i + size(); ++first)
                if (meetAt(first, count)) return true;
        return false;
    }

    bool meetAt(size_t first, size_t count) {
        const size_t before = first + size() - 1, last = first + count - 1;
        const int a = info(before).piece, b = info(last).piece;
        if (a < 0 || b < 0 || onArc(info(before)) || onArc(info(last)) || isEndOfWall(before) ||
            isEndOfWall(last))
            return false;
        const glm::dvec2 in = edge(before), out = edge(last);
        if (std::min(glm::length(in), glm::length(out)) < kOvershoot) return false;
        const double sine = cross(in, out);
        if (sine > -kSlant * glm::length(in) * glm::length(out)) return false;
        const glm::dvec2 corner = point(first) + in * (cross(point(last) - point(first), out) / sine);
        // In a sharp corner a square end looks out of the other wall's face far behind the corner.
        const double thickness = std::max(thicknessOf(a), thicknessOf(b)),
                     behind = thickness * std::min(kSharp, -glm::length(in) * glm::length(out) / sine);
        const double near =
            std::max({kCorner, std::hypot(kOvershoot, thickness), glm::dot(in, out) < 0 ? behind : 0});
        for (size_t k = first; k <= last; ++k) {
            const int own = info(k).piece;
            if (glm::length(point(k) - corner) > near + kTouches) return false;
            if (k == last || own < 0) continue;
            if (!(ofOneSide(own, a) || ofOneSide(own, b)) || glm::length(edge(k)) > lengthOf(own) / 2 ||
                isHead(k, ofOneSide(own, a) ? b : a))
                return false;
            if (glm::length(edge(k)) <= kOvershoot) continue;
            const glm::dvec2 on = ofOneSide(own, a) ? in : -out;
            for (const glm::dvec2 p : {point(k), point(k + 1)})
                if (glm::dot(p - corner, on) > kOvershoot * glm::length(on)) return false;
        }
        // Both keep some of their length: a nib's own foot is no such corner.
        if (glm::dot(corner - point(before), in) <= kTouches * glm::length(in) ||
            glm::dot(point(last + 1) - corner, out) <= kTouches * glm::length(out) ||
            !fits(before, last + 1, corner))
            return false;
        loop_.points[last % size()] = corner;
        erase(first, count - 1);
        return true;
    }

    // Whether edge k is of a wall that stands out on both sides of the one at whose end it lies, as the head
    // of a T does.
    bool isHead(size_t k, int stem) {
        return !isEndOfWall(k) &&
               glm::length(edge(k)) > kHead * (lengthOf(info(k).piece) - thicknessOf(stem));
    }

    // Drops corners and the edges that begin there.
    void erase(size_t first, size_t count) {
        const size_t n = size();
        std::vector<size_t> gone;
        for (size_t k = first; k < first + count; ++k) gone.push_back(k % n);
        std::ranges::sort(gone, std::greater{});
        for (const size_t k : gone) erase(k);
    }

    bool dropShort(double shortest) {
        std::vector<std::pair<std::array<double, 3>, size_t>> shortOnes;
        for (size_t i = 0; i < size(); ++i)
            if (glm::length(edge(i)) < shortest) shortOnes.emplace_back(rank(i), i);
        std::ranges::sort(shortOnes);
        for (const auto& [rank, i] : shortOnes)
            for (const glm::dvec2 corner : replacements(i)) {
                if (glm::length(edge(i)) > kTouches && !fits(i + size() - 1, i + 2, corner)) continue;
                loop_.points[(i + 1) % size()] = corner;
                erase(i);
                return true;
            }
        return false;
    }

    // What may take the place of a short edge: where the edges on either side of it meet, if that is near;
    // its middle; its ends, first that of the longer one of these edges.
    std::vector<glm::dvec2> replacements(size_t i) const {
        const glm::dvec2 before = edge(i + size() - 1), after = edge(i + 1),
                         middle = 0.5 * (point(i) + point(i + 1));
        std::vector<glm::dvec2> out{middle, point(i), point(i + 1)};
        if (glm::length(after) > glm::length(before)) std::swap(out[1], out[2]);
        const double sine = cross(before, after);
        if (std::abs(sine) > 0.1 * glm::length(before) * glm::length(after)) {
            const glm::dvec2 corner = point(i) + before * (cross(point(i + 1) - point(i), after) / sine);
            if (glm::length(corner - middle) < 2 * kShortEdge) out.insert(out.begin(), corner);
        }
        return out;
    }

    // Out and back again.
    bool dropSpike() {
        for (size_t i = 0; i < size(); ++i) {
            const size_t before = i + size() - 1;
            const glm::dvec2 in = edge(before), out = edge(i);
            if (glm::dot(in, out) < 0 &&
                std::abs(cross(in, out)) < 1e-3 * glm::length(in) * std::max(glm::length(out), kShortEdge) &&
                fits(before, i + 1)) {
                erase(i);
                return true;
            }
        }
        return false;
    }

    const PlanWalls& plan_;
    const std::vector<RoomPlan>& rooms_;
    OutlineLoop& loop_; // of one of them
};

double loopArea(const OutlineLoop& loop) {
    return twiceArea(loop.points) / 2;
}

// Corners at which nothing but the height of the wall changes lie exactly on the line, so that walls are
// flat.
void straighten(OutlineLoop& loop) {
    const size_t n = loop.points.size();
    const auto point = [&](size_t i) -> glm::dvec2& { return loop.points[i % n]; };
    const auto straight = [&](size_t i) { return straightCorner(point(i + n - 1), point(i), point(i + 1)); };
    size_t first = 0;
    while (first < n && straight(first)) ++first;
    for (size_t i = first; i < first + n;) {
        size_t end = i + 1;
        while (end < first + n && straight(end)) ++end;
        const glm::dvec2 a = point(i), d = glm::normalize(point(end) - a);
        for (size_t k = i + 1; k < end && a != point(end); ++k) point(k) = a + glm::dot(point(k) - a, d) * d;
        i = end;
    }
}

// Sharp corners end where they are a hair wide, those of walls as those of rooms.
void bluntTips(OutlineLoop& loop) {
    constexpr double kSharpTip = 0.06; // radians
    OutlineLoop out;
    for (size_t i = 0, n = loop.points.size(); i < n; ++i) {
        const glm::dvec2 p = loop.points[i], back = loop.points[(i + n - 1) % n] - p,
                         on = loop.points[(i + 1) % n] - p;
        const double sine = std::abs(cross(glm::normalize(back), glm::normalize(on))), cut = kPinchGap / sine;
        const bool sharp = sine < kSharpTip && glm::dot(back, on) > 0 &&
                           cut < kMostCut * std::min(glm::length(back), glm::length(on));
        if (sharp) {
            out.points.push_back(p + cut * glm::normalize(back));
            out.edges.push_back(loop.edges[i]);
        }
        out.points.push_back(sharp ? p + cut * glm::normalize(on) : p);
        out.edges.push_back(loop.edges[i]);
    }
    loop = std::move(out);
}

void clean(const PlanWalls& plan, const std::vector<RoomPlan>& rooms, std::vector<OutlineLoop>& loops) {
    for (OutlineLoop& loop : loops) LoopCleaner(plan, rooms, loop).clean();
    std::erase_if(loops, [](const OutlineLoop& loop) {
        return loop.points.size() < 3 || std::abs(loopArea(loop)) < 0.05;
    });
}

} // namespace

void cleanOutlines(const PlanWalls& plan, PlanRooms& found) {
    for (RoomPlan& room : found.rooms) {
        clean(plan, found.rooms, room.loops);
        evenFacets(plan, room.loops);
    }
    separatePinches(found.rooms);
    std::erase_if(found.rooms, [](const RoomPlan& room) { return room.loops.empty(); });
    for (RoomPlan& room : found.rooms) {
        for (OutlineLoop& loop : room.loops) {
            bluntTips(loop);
            straighten(loop);
        }
        room.area = 0;
        for (const OutlineLoop& loop : room.loops) room.area += loopArea(loop);
    }
}

} // namespace heliodon::geometry
