#include "geometry/plan_curves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"
#include "geometry/segment_distance.h"

namespace heliodon::geometry {

namespace {

constexpr double kAlike = 0.97;    // of the longest facet's length: the shortest one of a run that is even
constexpr double kOffCircle = 0.1; // inches: corners farther from the face's circle are none of its facets
constexpr double kKeepsOff = 0.02; // inches: of other outlines
constexpr double kRounding = 1e-9; // of a facet

// Edges of one curved wall's long face, from point `first` on; its corners between facets are those between.
struct Run {
    size_t first = 0, count = 0;
    glm::dvec2 center{};
    double radius = 0, step = 0, widest = 0; // of the face; angles of a facet
};

class FacetEvener {
public:
    FacetEvener(const PlanWalls& plan, std::vector<OutlineLoop>& loops, size_t own)
        : plan_(plan), loops_(loops), own_(own) {}

    void even() {
        const size_t n = loop().points.size();
        if (std::ranges::none_of(loop().edges, [&](const OutlineEdge& edge) {
                return edge.piece >= 0 && plan_.pieces[static_cast<size_t>(edge.piece)].curved;
            }))
            return;
        size_t start = 0; // where another wall begins
        while (start < n && loop().edges[start].piece == loop().edges[(start + n - 1) % n].piece) ++start;
        if (start == n) return;
        std::ranges::rotate(loop().points, loop().points.begin() + static_cast<std::ptrdiff_t>(start));
        std::ranges::rotate(loop().edges, loop().edges.begin() + static_cast<std::ptrdiff_t>(start));
        for (size_t first = 0; first < loop().points.size();) {
            Run run{first};
            while (first + run.count < loop().points.size() &&
                   loop().edges[first + run.count].piece == loop().edges[first].piece)
                ++run.count;
            first += isFace(run) ? replace(run) : run.count;
        }
    }

private:
    OutlineLoop& loop() { return loops_[own_]; }
    glm::dvec2 point(size_t i) { return loop().points[i % loop().points.size()]; }

    // Whether its facets differ.
    bool isFace(Run& run) {
        const OutlineEdge& edge = loop().edges[run.first];
        if (run.count < 2 || edge.piece < 0 || edge.gap) return false;
        const WallPiece& piece = plan_.pieces[static_cast<size_t>(edge.piece)];
        if (!piece.curved) return false;
        run.center = piece.center;
        run.step = (piece.a1 - piece.a0) / piece.facets;
        run.widest = piece.widestFacet;
        const double off = glm::length(point(run.first + 1) - run.center) - piece.radius;
        run.radius = piece.radius + std::copysign(piece.thickness / 2, off);
        double shortest = 1e300, longest = 0;
        for (size_t k = 0; k < run.count; ++k) {
            const double length = glm::length(point(run.first + k + 1) - point(run.first + k));
            shortest = std::min(shortest, length);
            longest = std::max(longest, length);
        }
        for (size_t k = 0; k <= run.count; ++k)
            if (std::abs(glm::length(point(run.first + k) - run.center) - run.radius) > kOffCircle)
                return false;
        return shortest < kAlike * longest;
    }

    // Returns how many edges there are now.
    size_t replace(const Run& run) {
        const glm::dvec2 a = point(run.first) - run.center, b = point(run.first + run.count) - run.center;
        double sweep = 0;
        for (size_t k = 0; k < run.count; ++k) {
            const glm::dvec2 p = point(run.first + k) - run.center, q = point(run.first + k + 1) - run.center;
            sweep += std::atan2(cross(p, q), glm::dot(p, q));
        }
        const double turn = std::abs(sweep), count = std::max({1.0, std::round(turn / run.step),
                                                               std::ceil(turn / run.widest - kRounding)});
        // (count - 2) sine x^2 + (a + b) sine x = turn, in radii: see cornerReach() of the walls.
        const double sine = std::sin(turn / count),
                     ends = (glm::length(a) + glm::length(b)) / run.radius * sine, inner = (count - 2) * sine;
        const double reach = 2 * turn / (ends + std::sqrt(ends * ends + 4 * inner * turn));
        std::vector<glm::dvec2> corners;
        const double from = std::atan2(a.y, a.x);
        for (double k = 1; k < count; ++k) {
            const double angle = from + sweep * k / count;
            corners.push_back(run.center + reach * run.radius * glm::dvec2(std::cos(angle), std::sin(angle)));
        }
        if (!staysApart(run, corners)) return run.count;
        auto& points = loop().points;
        auto& edges = loop().edges;
        const auto at = static_cast<std::ptrdiff_t>(run.first);
        const OutlineEdge edge = edges[run.first];
        points.erase(points.begin() + at + 1, points.begin() + at + static_cast<std::ptrdiff_t>(run.count));
        points.insert(points.begin() + at + 1, corners.begin(), corners.end());
        edges.erase(edges.begin() + at, edges.begin() + at + static_cast<std::ptrdiff_t>(run.count));
        edges.insert(edges.begin() + at, corners.size() + 1, edge);
        return corners.size() + 1;
    }

    // The new corners from all edges that remain, and what remains from the new edges.
    bool staysApart(const Run& run, const std::vector<glm::dvec2>& corners) {
        std::vector<glm::dvec2> line{point(run.first)};
        line.insert(line.end(), corners.begin(), corners.end());
        line.push_back(point(run.first + run.count));
        for (const OutlineLoop& other : loops_)
            for (size_t i = 0, n = other.points.size(); i < n; ++i) {
                if (&other == &loop() && i >= run.first && i < run.first + run.count) continue;
                const glm::dvec2 p = other.points[i], q = other.points[(i + 1) % n];
                for (const glm::dvec2 corner : corners)
                    if (distanceToSegment(corner, p, q) < kKeepsOff) return false;
                for (size_t k = 0; k + 1 < line.size(); ++k) {
                    const glm::dvec2 c = line[k], d = line[k + 1];
                    if (p != line.front() && p != line.back() && distanceToSegment(p, c, d) < kKeepsOff)
                        return false;
                    if (cross(q - p, c - p) * cross(q - p, d - p) < 0 &&
                        cross(d - c, p - c) * cross(d - c, q - c) < 0)
                        return false;
                }
            }
        return true;
    }

    const PlanWalls& plan_;
    std::vector<OutlineLoop>& loops_;
    size_t own_;
};

constexpr double kTurn = 2 * std::numbers::pi;

// One long face of a curved partition, cut by what stands across it.
class PartitionFace {
public:
    PartitionFace(const WallPiece& piece, bool outer)
        : piece_(piece), radius_(piece.radius + (outer ? 0.5 : -0.5) * piece.thickness),
          planned_(faceCorners(piece, outer)) {}

    void cutBy(glm::dvec2 a, glm::dvec2 b) {
        const glm::dvec2 d = b - a, off = a - piece_.center;
        const double dd = glm::dot(d, d), half = glm::dot(off, d),
                     root = half * half - dd * (glm::dot(off, off) - radius_ * radius_);
        if (dd == 0 || root <= 0) return;
        for (const double sign : {-1.0, 1.0})
            if (const double t = (-half + sign * std::sqrt(root)) / dd; t > 0 && t < 1) cutAt(a + t * d);
    }

    void cutBy(const WallPiece& arc, double radius) {
        const glm::dvec2 d = arc.center - piece_.center;
        const double apart = glm::length(d);
        if (apart < kOffCircle) return;
        const double along = (apart * apart + radius_ * radius_ - radius * radius) / (2 * apart),
                     square = radius_ * radius_ - along * along;
        if (square <= 0) return;
        const glm::dvec2 u = d / apart, v(-u.y, u.x);
        for (const double side : {-std::sqrt(square), std::sqrt(square)}) {
            const glm::dvec2 p = piece_.center + along * u + side * v;
            if (onArc(arc, angleFrom(arc, p))) cutAt(p);
        }
    }

    // Even facets from cut to cut; the ends stay.
    std::vector<glm::dvec2> corners() {
        std::ranges::sort(cuts_, {}, &Cut::angle);
        std::vector<Cut> ends{{piece_.a0, planned_.front()}};
        for (const Cut& cut : cuts_)
            if ((cut.angle - ends.back().angle) * radius_ > kKeepsOff &&
                (piece_.a1 - cut.angle) * radius_ > kKeepsOff)
                ends.push_back(cut);
        ends.push_back({piece_.a1, planned_.back()});
        if (ends.size() == 2) return planned_;
        std::vector<glm::dvec2> out{ends.front().at};
        const double step = (piece_.a1 - piece_.a0) / piece_.facets;
        for (size_t k = 0; k + 1 < ends.size(); ++k) {
            const double from = ends[k].angle, turn = ends[k + 1].angle - from;
            const double count =
                std::max({1.0, std::round(turn / step), std::ceil(turn / piece_.widestFacet - kRounding)});
            const double reach = count > 1 ? cornerReach(turn, static_cast<int>(count), false) : 1;
            for (double i = 1; i < count; ++i) {
                const double angle = from + turn * i / count;
                out.push_back(piece_.center + reach * radius_ * glm::dvec2(std::cos(angle), std::sin(angle)));
            }
            out.push_back(ends[k + 1].at);
        }
        return out;
    }

private:
    struct Cut {
        double angle;
        glm::dvec2 at;
    };

    static double angleFrom(const WallPiece& arc, glm::dvec2 p) {
        const double middle = (arc.a0 + arc.a1) / 2;
        return middle + std::remainder(std::atan2(p.y - arc.center.y, p.x - arc.center.x) - middle, kTurn);
    }
    static bool onArc(const WallPiece& arc, double angle) { return angle > arc.a0 && angle < arc.a1; }

    void cutAt(glm::dvec2 p) {
        if (const double angle = angleFrom(piece_, p); onArc(piece_, angle)) cuts_.push_back({angle, p});
    }

    const WallPiece& piece_;
    double radius_;
    std::vector<glm::dvec2> planned_;
    std::vector<Cut> cuts_;
};

std::vector<glm::dvec2> evenFace(const PlanWalls& plan, size_t own, bool outer,
                                 const std::vector<RoomPlan>& rooms) {
    PartitionFace face(plan.partitions[own], outer);
    const auto cutByLoop = [&](const std::vector<glm::dvec2>& points) {
        for (size_t i = 0; i < points.size(); ++i) face.cutBy(points[i], points[(i + 1) % points.size()]);
    };
    for (const RoomPlan& room : rooms)
        for (const OutlineLoop& loop : room.loops) cutByLoop(loop.points);
    for (size_t i = 0; i < plan.partitions.size(); ++i) {
        const WallPiece& other = plan.partitions[i];
        if (i == own) continue;
        if (!other.curved) {
            cutByLoop(footprint(other).outline);
            continue;
        }
        for (const double half : {-0.5, 0.5}) face.cutBy(other, other.radius + half * other.thickness);
        for (const bool atB : {false, true}) {
            const WallEnd end = wallEnd(other, static_cast<int>(i), atB);
            face.cutBy(end.right, end.left);
        }
    }
    return face.corners();
}

} // namespace

void evenPartitions(PlanWalls& plan, const std::vector<RoomPlan>& rooms) {
    for (size_t i = 0; i < plan.partitions.size(); ++i) {
        WallPiece& piece = plan.partitions[i];
        if (!piece.curved || piece.a1 - piece.a0 > kTurn - kRounding) continue;
        piece.corners = {evenFace(plan, i, true, rooms), evenFace(plan, i, false, rooms)};
    }
}

void evenFacets(const PlanWalls& plan, std::vector<OutlineLoop>& loops) {
    for (size_t l = 0; l < loops.size(); ++l) FacetEvener(plan, loops, l).even();
}

} // namespace heliodon::geometry
