#include "geometry/plan_curves.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"
#include "geometry/segment_distance.h"

namespace heliodon::geometry {

namespace {

constexpr double kAlike = 0.75;    // of the longest facet's length: the shortest one of a run that is even
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

} // namespace

void evenFacets(const PlanWalls& plan, std::vector<OutlineLoop>& loops) {
    for (size_t l = 0; l < loops.size(); ++l) FacetEvener(plan, loops, l).even();
}

} // namespace heliodon::geometry
