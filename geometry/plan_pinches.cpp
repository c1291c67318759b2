#include "geometry/plan_pinches.h"

#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"
#include "geometry/segment_distance.h"

namespace heliodon::geometry {

namespace {

constexpr double kTouches = 1e-5; // inches

// Corners of several outlines, by their place.
class Crowd {
public:
    explicit Crowd(const std::vector<RoomPlan>& rooms) {
        for (const RoomPlan& room : rooms)
            for (const OutlineLoop& loop : room.loops)
                for (const glm::dvec2 p : loop.points) ++count_[key(p)];
    }
    bool shares(glm::dvec2 p) const { return count_.at(key(p)) > 1; }

private:
    static std::pair<long long, long long> key(glm::dvec2 p) {
        return {std::llround(p.x / kTouches), std::llround(p.y / kTouches)};
    }
    std::map<std::pair<long long, long long>, int> count_;
};

// From the nearest point of the room's outlines to corner i, but for the edges that meet there.
glm::dvec2 nearestOffset(const std::vector<OutlineLoop>& loops, const OutlineLoop& own, size_t i) {
    const glm::dvec2 p = own.points[i];
    glm::dvec2 best(std::numeric_limits<double>::infinity());
    for (const OutlineLoop& loop : loops)
        for (size_t k = 0, n = loop.points.size(); k < n; ++k) {
            if (&loop == &own && (k == i || (k + 1) % n == i)) continue;
            const glm::dvec2 a = loop.points[k], b = loop.points[(k + 1) % n];
            if (beside(a.x, b.x, p.x - kPinchGap, p.x + kPinchGap) ||
                beside(a.y, b.y, p.y - kPinchGap, p.y + kPinchGap))
                continue;
            const glm::dvec2 d = b - a;
            const double t = std::clamp(glm::dot(p - a, d) / glm::dot(d, d), 0.0, 1.0);
            const glm::dvec2 offset = p - a - t * d;
            if (glm::dot(offset, offset) < glm::dot(best, best)) best = offset;
        }
    return best;
}

glm::dvec2 unit(glm::dvec2 v) {
    const double length = glm::length(v);
    return length > 0 ? v / length : v;
}

glm::dvec2 inwardAt(const OutlineLoop& loop, size_t i) {
    const size_t n = loop.points.size();
    const glm::dvec2 p = loop.points[i], in = unit(p - loop.points[(i + n - 1) % n]),
                     out = unit(loop.points[(i + 1) % n] - p), inward(-in.y - out.y, in.x + out.x);
    return glm::length(inward) < 1e-6 ? in : glm::normalize(inward);
}

// Whether the room's air reaches corner i from direction d.
bool airLies(glm::dvec2 d, const OutlineLoop& loop, size_t i) {
    const size_t n = loop.points.size();
    const glm::dvec2 back = loop.points[(i + n - 1) % n] - loop.points[i],
                     on = loop.points[(i + 1) % n] - loop.points[i];
    return cross(on, back) > 0 ? cross(on, d) > 0 && cross(d, back) > 0
                               : !(cross(back, d) >= 0 && cross(d, on) >= 0);
}

// Whether the room's air passes between corner i and an edge of its own that touches it: a neck without
// width.
bool narrowsNeck(const std::vector<OutlineLoop>& loops, const OutlineLoop& own, size_t i) {
    const glm::dvec2 p = own.points[i];
    for (const OutlineLoop& loop : loops)
        for (size_t k = 0, n = loop.points.size(); k < n; ++k) {
            const glm::dvec2 a = loop.points[k], b = loop.points[(k + 1) % n];
            if ((&loop == &own && (k == i || (k + 1) % n == i)) || distanceToSegment(p, a, b) >= kTouches)
                continue;
            const glm::dvec2 far = glm::length(a - p) > glm::length(b - p) ? a : b;
            if (airLies(far - p, own, i)) return true;
        }
    return false;
}

// True when any corner was moved.
bool separateOnce(std::vector<RoomPlan>& rooms) {
    const Crowd crowd(rooms);
    bool any = false;
    for (RoomPlan& room : rooms) {
        const std::vector<OutlineLoop> before = room.loops;
        for (size_t l = 0; l < before.size(); ++l)
            for (size_t i = 0; i < before[l].points.size(); ++i) {
                const glm::dvec2 offset = nearestOffset(before, before[l], i);
                const double apart = glm::length(offset);
                glm::dvec2 move{0};
                if (apart < kTouches || crowd.shares(before[l].points[i]))
                    move =
                        (narrowsNeck(before, before[l], i) ? -kPinchGap : kPinchGap) * inwardAt(before[l], i);
                else if (apart < 0.9 * kPinchGap)
                    move = (kPinchGap - apart) / apart * offset;
                room.loops[l].points[i] += move;
                any = any || move != glm::dvec2(0);
            }
    }
    return any;
}

} // namespace

void separatePinches(std::vector<RoomPlan>& rooms) {
    for (int round = 0; round < 4 && separateOnce(rooms); ++round) {
    }
}

} // namespace heliodon::geometry
