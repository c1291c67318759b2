#include "geometry/occluder_solids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"
#include "geometry/segment_distance.h"

namespace heliodon::geometry {

namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kSameAngle = 1e-7; // radians
constexpr double kOffCircle = 0.1;  // inches: an outline farther from the face's circle is not of the face
constexpr double kStraight = 1e-4;  // inches
constexpr double kMostInAir = 1;    // inches of a wall that outlines were drawn without

// One long face of a curved wall as a line of corners: as rooms see it where they do, else as it was planned.
class CurvedFace {
public:
    CurvedFace(const WallPiece& piece, int index, bool outer, const std::vector<RoomPlan>& rooms)
        : piece_(piece), radius_(piece.radius + (outer ? 0.5 : -0.5) * piece.thickness) {
        for (const RoomPlan& room : rooms)
            for (const OutlineLoop& loop : room.loops)
                for (size_t i = 0; i < loop.points.size(); ++i)
                    if (loop.edges[i].piece == index && !loop.edges[i].gap)
                        see(loop.points[i], loop.points[(i + 1) % loop.points.size()]);
        const std::vector<glm::dvec2> corners = faceCorners(piece, outer);
        for (size_t k = 0; k < corners.size(); ++k)
            plan(k == 0                    ? piece.a0
                 : k + 1 == corners.size() ? piece.a1
                 : !piece.corners[0].empty()
                     ? angleOf(corners[k])
                     : glm::mix(piece.a0, piece.a1,
                                static_cast<double>(k) / static_cast<double>(corners.size() - 1)),
                 corners[k]);
        std::ranges::sort(corners_, {}, &Corner::angle);
        for (size_t i = 1; i + 1 < corners_.size();)
            if (corners_[i + 1].angle - corners_[i].angle < kSameAngle ||
                distanceToSegment(corners_[i].at, corners_[i - 1].at, corners_[i + 1].at) < kStraight)
                corners_.erase(corners_.begin() + static_cast<std::ptrdiff_t>(i));
            else
                ++i;
    }

    double radius() const { return radius_; }
    bool isSeen() const { return !seen_.empty(); }

    void addAngles(std::vector<double>& angles) const {
        for (const Corner& c : corners_)
            if (c.angle > piece_.a0 + kSameAngle && c.angle < piece_.a1 - kSameAngle)
                angles.push_back(c.angle);
    }

    // Where the line from the centre at this angle meets it.
    glm::dvec2 at(double angle) const {
        const auto next = std::ranges::lower_bound(corners_, angle - kSameAngle, {}, &Corner::angle);
        if (next == corners_.end()) return corners_.back().at;
        if (next == corners_.begin() || next->angle < angle + kSameAngle) return next->at;
        const glm::dvec2 p = std::prev(next)->at, d = next->at - p, u(std::cos(angle), std::sin(angle));
        return piece_.center + cross(p - piece_.center, d) / cross(u, d) * u;
    }

private:
    struct Corner {
        double angle;
        glm::dvec2 at;
    };

    double angleOf(glm::dvec2 p) const {
        const double middle = (piece_.a0 + piece_.a1) / 2;
        return middle +
               std::remainder(std::atan2(p.y - piece_.center.y, p.x - piece_.center.x) - middle, kTurn);
    }

    void see(glm::dvec2 p, glm::dvec2 q) {
        for (const glm::dvec2 end : {p, q})
            if (std::abs(glm::length(end - piece_.center) - radius_) > kOffCircle) return;
        double from = angleOf(p), to = angleOf(q);
        if (from > to) {
            std::swap(from, to);
            std::swap(p, q);
        }
        const bool overSeam = to - from > kTurn / 2, full = piece_.a1 - piece_.a0 > kTurn - 1e-9;
        if (!overSeam) return add({from, p}, {to, q});
        if (!full) return;
        add({to - kTurn, q}, {from, p});
        add({to, q}, {from + kTurn, p});
    }

    void add(const Corner& from, const Corner& to) {
        corners_.insert(corners_.end(), {from, to});
        seen_.emplace_back(from.angle, to.angle);
    }

    void plan(double angle, glm::dvec2 corner) {
        const bool seen = std::ranges::any_of(seen_, [&](const auto& s) {
            return angle > s.first - kSameAngle && angle < s.second + kSameAngle;
        });
        if (!seen) corners_.push_back({angle, corner});
    }

    const WallPiece& piece_;
    double radius_;
    std::vector<Corner> corners_;
    std::vector<std::pair<double, double>> seen_; // edges of rooms, by angle
};

// Inches from the end of a line along a wall to where a room's outline crosses it, if the end stands in the
// room's air: outlines end at corners that a wall runs on past by little.
double inAir(glm::dvec2 end, glm::dvec2 other, const std::vector<RoomPlan>& rooms) {
    const glm::dvec2 back = glm::normalize(other - end);
    double least = kMostInAir;
    for (const RoomPlan& room : rooms) {
        if (!contains(room, end + kStraight * back)) continue;
        for (const OutlineLoop& loop : room.loops)
            for (size_t i = 0, n = loop.points.size(); i < n; ++i) {
                const glm::dvec2 a = loop.points[i] - end, b = loop.points[(i + 1) % n] - end;
                const double sideA = cross(back, a), sideB = cross(back, b);
                if ((sideA < 0) == (sideB < 0)) continue;
                const double at = glm::dot(back, glm::mix(a, b, sideA / (sideA - sideB)));
                if (at > 0) least = std::min(least, at);
            }
    }
    return least < kMostInAir ? least : 0;
}

// The corners of a straight wall, in footprint()'s order, as far as its rooms' outlines have it. What of its
// ends stands in the air is told on two lines within it, as its sides lie on outlines.
std::array<glm::dvec2, 4> seenFootprint(const WallPiece& piece, const std::vector<RoomPlan>& rooms) {
    constexpr double kWithin = 0.9; // of half the thickness
    const glm::dvec2 d = glm::normalize(piece.b - piece.a), n = piece.thickness / 2 * leftOf(d);
    const auto cut = [&](glm::dvec2 end, glm::dvec2 other, double side) {
        const double own = inAir(end + kWithin * side * n, other + kWithin * side * n, rooms);
        const double opposite = inAir(end - kWithin * side * n, other - kWithin * side * n, rooms);
        return std::max(0.0, (own + opposite) / 2 + (own - opposite) / 2 / kWithin);
    };
    std::array<glm::dvec2, 4> out{};
    for (const double side : {-1.0, 1.0}) {
        const double atA = cut(piece.a, piece.b, side), atB = cut(piece.b, piece.a, side);
        const bool all = atA + atB >= glm::length(piece.b - piece.a);
        out[side < 0 ? 0 : 3] = piece.a + side * n + (all ? 0 : atA) * d;
        out[side < 0 ? 1 : 2] = piece.b + side * n - (all ? 0 : atB) * d;
    }
    return out;
}

class SolidBuilder {
public:
    void add(const WallPiece& piece) {
        const std::vector<glm::dvec2> p = footprint(piece).outline;
        const size_t n = p.size(); // a strip: corner k of one long side faces corner n - 1 - k of the other
        for (size_t k = 0; k + 1 < n / 2; ++k)
            addPrism({p[k], p[k + 1], p[n - 2 - k], p[n - 1 - k]}, piece.height);
    }

    void addSeen(const WallPiece& piece, int index, const std::vector<RoomPlan>& rooms) {
        const CurvedFace outer(piece, index, true, rooms), inner(piece, index, false, rooms);
        if (!outer.isSeen() && !inner.isSeen()) return add(piece);
        std::vector<const CurvedFace*> seen;
        for (const CurvedFace* face : {&outer, &inner})
            if (face->isSeen()) seen.push_back(face);
        const std::vector<double> angles = cornerAngles(piece, seen);
        // A side that nobody sees is parallel to the other one.
        const auto at = [&](const CurvedFace& face, const CurvedFace& other, double angle) {
            return face.isSeen() ? face.at(angle)
                                 : glm::mix(piece.center, other.at(angle), face.radius() / other.radius());
        };
        for (size_t k = 0; k + 1 < angles.size(); ++k)
            addPrism({at(outer, inner, angles[k]), at(outer, inner, angles[k + 1]),
                      at(inner, outer, angles[k + 1]), at(inner, outer, angles[k])},
                     piece.height);
    }

    // A partition whose two faces have corners at angles of their own.
    void addUneven(const WallPiece& piece) {
        const CurvedFace outer(piece, -1, true, {}), inner(piece, -1, false, {});
        const std::vector<double> angles = cornerAngles(piece, {&outer, &inner});
        for (size_t k = 0; k + 1 < angles.size(); ++k)
            addPrism(
                {outer.at(angles[k]), outer.at(angles[k + 1]), inner.at(angles[k + 1]), inner.at(angles[k])},
                piece.height);
    }

    void addPrism(const std::array<glm::dvec2, 4>& base, double height) {
        const auto first = static_cast<uint32_t>(out_.vertices.size());
        for (const double y : {0.0, height})
            for (const glm::dvec2 p : base)
                out_.vertices.push_back(kMetresPerInch * glm::dvec3(p.x, y, -p.y));
        for (uint32_t k = 0; k < 4; ++k) {
            const uint32_t next = (k + 1) % 4;
            quad(first + k, first + next, first + 4 + next, first + 4 + k);
        }
        quad(first + 4, first + 5, first + 6, first + 7);
        quad(first, first + 3, first + 2, first + 1);
    }

    Occluders take() { return std::move(out_); }

private:
    static std::vector<double> cornerAngles(const WallPiece& piece,
                                            const std::vector<const CurvedFace*>& faces) {
        std::vector<double> angles{piece.a0, piece.a1};
        for (const CurvedFace* face : faces) face->addAngles(angles);
        std::ranges::sort(angles);
        const auto repeated =
            std::ranges::unique(angles, [](double a, double b) { return b - a < kSameAngle; });
        angles.erase(repeated.begin(), repeated.end());
        return angles;
    }

    void quad(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
        for (const uint32_t v : {a, b, c, a, c, d}) out_.triangles.push_back(v);
    }

    Occluders out_;
};

} // namespace

Occluders occluderSolids(const PlanWalls& plan, const std::vector<RoomPlan>& rooms) {
    SolidBuilder builder;
    for (size_t i = 0; i < plan.pieces.size(); ++i)
        if (plan.pieces[i].curved)
            builder.addSeen(plan.pieces[i], static_cast<int>(i), rooms);
        else
            builder.addPrism(seenFootprint(plan.pieces[i], rooms), plan.pieces[i].height);
    for (const WallPiece& piece : plan.partitions)
        if (piece.corners[0].empty())
            builder.add(piece);
        else
            builder.addUneven(piece);
    return builder.take();
}

} // namespace heliodon::geometry
