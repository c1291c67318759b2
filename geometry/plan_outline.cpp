// Makes the outlines of rooms fit to be built: no jogs that only noise explains, no corner that two walls of
// air share.
#include <algorithm>
#include <cmath>
#include <map>

#include <glm/geometric.hpp>

#include "geometry/plan_rooms.h"

namespace heliodon::geometry {

namespace {

constexpr double kShortEdge = 0.12;  // inches: shorter steps are noise
constexpr double kNarrowCrack = 0.5; // inches
constexpr double kOnLine = 1e-6;     // inches off the line that two edges share
constexpr double kTouches = 1e-5;    // inches
constexpr double kPinchGap = 0.01;   // inches between outlines that would touch in a point

double cross(glm::dvec2 u, glm::dvec2 v) {
    return u.x * v.y - u.y * v.x;
}

class LoopCleaner {
public:
    LoopCleaner(OutlineLoop& loop, double shortEdge) : loop_(loop), shortEdge_(shortEdge) {}

    void clean() {
        hideCracks();
        while (size() > 3 && (mergeAlike() || dropShort() || dropSpike())) {
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

    // A crack in a straight side is too narrow to be told from the wall: it is shown as the wall is.
    void hideCracks() {
        for (size_t i = 0; i < size(); ++i) {
            if (info(i).height > 0 || info(i).gap || glm::length(edge(i)) > kNarrowCrack) continue;
            for (const size_t beside : {i + size() - 1, i + 1})
                if (info(beside).height > info(i).height &&
                    std::abs(cross(edge(beside), edge(i))) <
                        1e-3 * glm::length(edge(beside)) * glm::length(edge(i)))
                    info(i) = info(beside);
        }
    }

    bool mergeAlike() {
        for (size_t i = 0; i < size(); ++i) {
            const size_t before = i + size() - 1;
            if (info(before).height != info(i).height || info(before).gap != info(i).gap) continue;
            const glm::dvec2 whole = point(i + 1) - point(before);
            const double length = glm::length(whole);
            if (length == 0 || glm::dot(edge(before), edge(i)) <= 0) continue;
            if (std::abs(cross(whole, edge(before))) > kOnLine * length) continue;
            if (glm::length(edge(i)) > glm::length(edge(before))) info(before) = info(i);
            erase(i);
            return true;
        }
        return false;
    }

    bool dropShort() {
        size_t shortest = size();
        double least = shortEdge_;
        for (size_t i = 0; i < size(); ++i)
            if (const double length = glm::length(edge(i)); length < least) {
                least = length;
                shortest = i;
            }
        if (shortest == size()) return false;
        const glm::dvec2 corner = replacement(shortest);
        loop_.points[(shortest + 1) % size()] = corner;
        erase(shortest);
        return true;
    }

    // Where the edges on either side of a short one meet, if that is near; else its middle.
    glm::dvec2 replacement(size_t i) const {
        const glm::dvec2 before = edge(i + size() - 1), after = edge(i + 1),
                         middle = 0.5 * (point(i) + point(i + 1));
        const double sine = cross(before, after);
        if (std::abs(sine) > 0.1 * glm::length(before) * glm::length(after)) {
            const glm::dvec2 meet = point(i) + before * (cross(point(i + 1) - point(i), after) / sine);
            if (glm::length(meet - middle) < 2 * shortEdge_) return meet;
        }
        return middle;
    }

    // Out and back again.
    bool dropSpike() {
        for (size_t i = 0; i < size(); ++i) {
            const glm::dvec2 in = edge(i + size() - 1), out = edge(i);
            if (glm::dot(in, out) < 0 &&
                std::abs(cross(in, out)) < 1e-3 * glm::length(in) * std::max(glm::length(out), kShortEdge)) {
                erase(i);
                return true;
            }
        }
        return false;
    }

    OutlineLoop& loop_;
    double shortEdge_;
};

double loopArea(const OutlineLoop& loop) {
    double sum = 0;
    for (size_t i = 0; i < loop.points.size(); ++i)
        sum += 0.5 * cross(loop.points[i], loop.points[(i + 1) % loop.points.size()]);
    return sum;
}

// Whether the corner lies within an edge: there a straight run of the outline passes the corner by.
bool onAnEdge(const std::vector<OutlineLoop>& loops, glm::dvec2 p) {
    for (const OutlineLoop& loop : loops)
        for (size_t i = 0, n = loop.points.size(); i < n; ++i) {
            const glm::dvec2 a = loop.points[i], b = loop.points[(i + 1) % n];
            const auto beyond = [&](int c) {
                return p[c] < std::min(a[c], b[c]) - kTouches || p[c] > std::max(a[c], b[c]) + kTouches;
            };
            if (beyond(0) || beyond(1)) continue;
            const glm::dvec2 d = glm::normalize(b - a);
            const double t = glm::dot(p - a, d);
            if (t > kTouches && t < glm::length(b - a) - kTouches && std::abs(cross(d, p - a)) < kTouches)
                return true;
        }
    return false;
}

// Corners that coincide, or lie on another edge, are drawn a hair into their own side's air.
void separatePinches(std::vector<RoomPlan>& rooms) {
    std::map<std::pair<long long, long long>, int> count;
    const auto key = [](glm::dvec2 p) { return std::pair(std::llround(p.x * 1e5), std::llround(p.y * 1e5)); };
    for (const RoomPlan& room : rooms)
        for (const OutlineLoop& loop : room.loops)
            for (const glm::dvec2 p : loop.points) ++count[key(p)];
    for (RoomPlan& room : rooms) {
        const std::vector<OutlineLoop> before = room.loops;
        for (OutlineLoop& loop : room.loops) {
            const std::vector<glm::dvec2> old = loop.points;
            for (size_t i = 0; i < old.size(); ++i) {
                if (count[key(old[i])] < 2 && !onAnEdge(before, old[i])) continue;
                const glm::dvec2 in = glm::normalize(old[i] - old[(i + old.size() - 1) % old.size()]);
                const glm::dvec2 out = glm::normalize(old[(i + 1) % old.size()] - old[i]);
                glm::dvec2 inward = glm::dvec2(-in.y - out.y, in.x + out.x);
                if (glm::length(inward) < 1e-6) inward = in;
                loop.points[i] = old[i] + kPinchGap * glm::normalize(inward);
            }
        }
    }
}

// True when two edges of the room's outlines cross or touch where they do not follow one another.
bool crosses(const RoomPlan& room) {
    struct Segment {
        glm::dvec2 a, b;
        size_t loop, index;
    };
    std::vector<Segment> segments;
    for (size_t l = 0; l < room.loops.size(); ++l)
        for (size_t i = 0, n = room.loops[l].points.size(); i < n; ++i)
            segments.push_back({room.loops[l].points[i], room.loops[l].points[(i + 1) % n], l, i});
    const auto left = [](const Segment& s) { return std::min(s.a.x, s.b.x); };
    std::ranges::sort(segments, {}, left);
    const auto turn = [](glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) { return cross(b - a, c - a); };
    for (size_t i = 0; i < segments.size(); ++i)
        for (size_t k = i + 1;
             k < segments.size() && left(segments[k]) <= std::max(segments[i].a.x, segments[i].b.x); ++k) {
            const Segment &s = segments[i], &t = segments[k];
            const size_t n = room.loops[s.loop].points.size();
            if (s.loop == t.loop && ((s.index + 1) % n == t.index || (t.index + 1) % n == s.index)) continue;
            if (std::max(s.a.y, s.b.y) < std::min(t.a.y, t.b.y) ||
                std::max(t.a.y, t.b.y) < std::min(s.a.y, s.b.y))
                continue;
            if (turn(s.a, s.b, t.a) * turn(s.a, s.b, t.b) <= 0 &&
                turn(t.a, t.b, s.a) * turn(t.a, t.b, s.b) <= 0)
                return true;
        }
    return false;
}

std::vector<OutlineLoop> cleaned(std::vector<OutlineLoop> loops, double shortEdge) {
    for (OutlineLoop& loop : loops) LoopCleaner(loop, shortEdge).clean();
    std::erase_if(loops, [](const OutlineLoop& loop) {
        return loop.points.size() < 3 || std::abs(loopArea(loop)) < 0.05;
    });
    return loops;
}

} // namespace

void cleanOutlines(PlanRooms& plan) {
    const std::vector<RoomPlan> traced = plan.rooms;
    // Where straightening makes outlines cross, less of it will do.
    std::vector<double> shortEdge(plan.rooms.size(), kShortEdge);
    for (int round = 0; round < 3; ++round) {
        plan.rooms = traced;
        for (size_t r = 0; r < plan.rooms.size(); ++r)
            plan.rooms[r].loops = cleaned(traced[r].loops, shortEdge[r]);
        separatePinches(plan.rooms);
        bool good = true;
        for (size_t r = 0; r < plan.rooms.size(); ++r)
            if (crosses(plan.rooms[r])) {
                shortEdge[r] /= 12;
                good = false;
            }
        if (good) break;
    }
    std::erase_if(plan.rooms, [](const RoomPlan& room) { return room.loops.empty(); });
    for (RoomPlan& room : plan.rooms) {
        room.area = 0;
        for (const OutlineLoop& loop : room.loops) room.area += loopArea(loop);
    }
}

} // namespace heliodon::geometry
