#include "geometry/plan_curves.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"
#include "geometry/segment_distance.h"

namespace heliodon::geometry {

namespace {

constexpr double kAlike = 0.97;      // of the longest facet's length: the shortest one of a run that is even
constexpr double kOffCircle = 0.1;   // inches: corners farther from the face's circle are none of its facets
constexpr double kKeepsOff = 0.02;   // inches: of other outlines
constexpr double kRounding = 1e-9;   // of a facet
constexpr double kBesideFold = 0.35; // of a facet: folds so near to a partition's side go to it
constexpr double kTurn = 2 * std::numbers::pi;

struct Circle {
    glm::dvec2 center{};
    double radius = 0;
};

double angleOn(const WallPiece& arc, glm::dvec2 p) {
    const double middle = (arc.a0 + arc.a1) / 2;
    return middle + std::remainder(std::atan2(p.y - arc.center.y, p.x - arc.center.x) - middle, kTurn);
}

bool isOn(const WallPiece& arc, double angle) {
    return angle > arc.a0 && angle < arc.a1;
}

// Where circles are crossed by straight lines and by the sides of walls.
class Crossings {
public:
    explicit Crossings(const Circle& circle) : circle_(circle) {}

    std::vector<glm::dvec2> at;

    void add(glm::dvec2 a, glm::dvec2 b) {
        const glm::dvec2 d = b - a, off = a - circle_.center;
        const double dd = glm::dot(d, d), half = glm::dot(off, d),
                     root = half * half - dd * (glm::dot(off, off) - circle_.radius * circle_.radius);
        if (dd == 0 || root <= 0) return;
        for (const double sign : {-1.0, 1.0})
            if (const double t = (-half + sign * std::sqrt(root)) / dd; t > 0 && t < 1)
                at.push_back(a + t * d);
    }

    void add(const std::vector<glm::dvec2>& loop) {
        for (size_t i = 0; i < loop.size(); ++i) add(loop[i], loop[(i + 1) % loop.size()]);
    }

    void add(const WallPiece& piece) {
        if (!piece.curved) return add(footprint(piece).outline);
        for (const double half : {-0.5, 0.5}) addArc(piece, piece.radius + half * piece.thickness);
        for (const bool atB : {false, true}) {
            const WallEnd end = wallEnd(piece, 0, atB);
            add(end.right, end.left);
        }
    }

private:
    void addArc(const WallPiece& arc, double radius) {
        const glm::dvec2 d = arc.center - circle_.center;
        const double apart = glm::length(d);
        if (apart < kOffCircle) return;
        const double own = circle_.radius,
                     along = (apart * apart + own * own - radius * radius) / (2 * apart),
                     square = own * own - along * along;
        if (square <= 0) return;
        const glm::dvec2 u = d / apart, v(-u.y, u.x);
        for (const double side : {-std::sqrt(square), std::sqrt(square)})
            if (const glm::dvec2 p = circle_.center + along * u + side * v; isOn(arc, angleOn(arc, p)))
                at.push_back(p);
    }

    Circle circle_;
};

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
        if (start == n) return evenRing();
        rotate(start);
        for (size_t first = 0; first < loop().points.size();) {
            Run run{first};
            while (first + run.count < loop().points.size() &&
                   loop().edges[first + run.count].piece == loop().edges[first].piece)
                ++run.count;
            if (isFace(run)) replace(run);
            first += run.count;
        }
    }

private:
    OutlineLoop& loop() { return loops_[own_]; }
    glm::dvec2 point(size_t i) { return loop().points[i % loop().points.size()]; }

    void rotate(size_t start) {
        std::ranges::rotate(loop().points, loop().points.begin() + static_cast<std::ptrdiff_t>(start));
        std::ranges::rotate(loop().edges, loop().edges.begin() + static_cast<std::ptrdiff_t>(start));
    }

    // All one wall: from the fold that is nearest to a partition's side on.
    void evenRing() {
        Run run{0, loop().points.size()};
        if (!isFace(run)) return;
        const Facets facets = facetsOf(run);
        const auto off = [&](double cut) { return std::abs(std::remainder(cut * facets.count, 1)); };
        const auto cut = std::ranges::min_element(facets.cuts, {}, off);
        if (!isEven(run) || facets.count != static_cast<double>(run.count) || cut == facets.cuts.end() ||
            off(*cut) > kBesideFold)
            return;
        rotate(static_cast<size_t>(std::round(*cut * facets.count)) % run.count);
        const glm::dvec2 before = std::exchange(loop().points[0], facets.at(*cut));
        if (!replace(run)) loop().points[0] = before;
    }

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
        for (size_t k = 0; k <= run.count; ++k)
            if (std::abs(glm::length(point(run.first + k) - run.center) - run.radius) > kOffCircle)
                return false;
        return true;
    }

    bool isEven(const Run& run) {
        double shortest = 1e300, longest = 0;
        for (size_t k = 0; k < run.count; ++k) {
            const double length = glm::length(point(run.first + k + 1) - point(run.first + k));
            shortest = std::min(shortest, length);
            longest = std::max(longest, length);
        }
        return shortest >= kAlike * longest;
    }

    // Of a run, from its first point to its last.
    struct Facets {
        glm::dvec2 center{};
        double from = 0, sweep = 0;  // angles
        double count = 1, reach = 0; // the latter: of the corners between, from the centre
        std::vector<double> cuts;    // where sides of partitions are, of the sweep

        glm::dvec2 at(double place) const {
            const double angle = from + sweep * place;
            return center + reach * glm::dvec2(std::cos(angle), std::sin(angle));
        }
    };

    Facets facetsOf(const Run& run) {
        const glm::dvec2 a = point(run.first) - run.center;
        Facets facets{run.center, std::atan2(a.y, a.x)};
        for (size_t k = 0; k < run.count; ++k) {
            const glm::dvec2 p = point(run.first + k) - run.center, q = point(run.first + k + 1) - run.center;
            facets.sweep += std::atan2(cross(p, q), glm::dot(p, q));
        }
        const double turn = std::abs(facets.sweep);
        facets.count = std::max({1.0, std::round(turn / run.step), std::ceil(turn / run.widest - kRounding)});
        std::vector<double> even;
        for (double k = 0; k <= facets.count; ++k) even.push_back(k / facets.count);
        facets.reach = reachOf(run, even, turn);
        findCuts(run, facets);
        return facets;
    }

    void findCuts(const Run& run, Facets& facets) {
        const glm::dvec2 a = point(run.first) - run.center;
        Crossings crossings({run.center, facets.reach});
        for (const WallPiece& partition : plan_.partitions) crossings.add(partition);
        facets.cuts.clear();
        for (const glm::dvec2 p : crossings.at) {
            const double off = std::atan2(cross(a, p - run.center), glm::dot(a, p - run.center)),
                         place = std::fmod(std::copysign(1.0, facets.sweep) * off + kTurn, kTurn) /
                                 std::abs(facets.sweep);
            if (place > 0 && place < 1) facets.cuts.push_back(place);
        }
        std::ranges::sort(facets.cuts);
    }

    // So that facets between these places, of the sweep, enclose what the arc does:
    // (sum of sines between) x^2 + (a sine + b sine) x = turn, in radii; see cornerReach() of the walls.
    double reachOf(const Run& run, const std::vector<double>& places, double turn) {
        const auto sine = [&](size_t k) { return std::sin((places[k + 1] - places[k]) * turn); };
        const size_t last = places.size() - 2;
        const auto radii = [&](size_t i) { return glm::length(point(i) - run.center) / run.radius; };
        double inner = 0;
        for (size_t k = 1; k < last; ++k) inner += sine(k);
        const double ends =
            last == 0 ? 2 : radii(run.first) * sine(0) + radii(run.first + run.count) * sine(last);
        return 2 * turn / (ends + std::sqrt(ends * ends + 4 * inner * turn)) * run.radius;
    }

    // Even ones, but that folds beside a side of a partition go to it.
    static std::vector<double> placesOf(const Run& run, const Facets& facets) {
        std::vector<double> pins(static_cast<size_t>(facets.count) + 1, -1);
        pins.front() = 0;
        pins.back() = 1;
        for (const double cut : facets.cuts) {
            const auto fold = static_cast<size_t>(std::round(cut * facets.count));
            const auto off = [&](double place) {
                return std::abs(place * facets.count - static_cast<double>(fold));
            };
            if (fold > 0 && fold + 1 < pins.size() && off(cut) < kBesideFold &&
                (pins[fold] < 0 || off(cut) < off(pins[fold])))
                pins[fold] = cut;
        }
        std::vector<double> places{0};
        for (size_t k = 1, last = 0; k < pins.size(); ++k) {
            if (pins[k] < 0) continue;
            const double from = pins[last], width = pins[k] - from,
                         count = std::max(static_cast<double>(k - last),
                                          std::ceil(width * std::abs(facets.sweep) / run.widest - kRounding));
            for (double i = 1; i <= count; ++i) places.push_back(from + width * i / count);
            last = k;
        }
        return places;
    }

    static bool isEven(const std::vector<double>& places) {
        const double step = 1 / static_cast<double>(places.size() - 1);
        for (size_t k = 0; k < places.size(); ++k)
            if (std::abs(places[k] - static_cast<double>(k) * step) > kRounding) return false;
        return true;
    }

    // Unless they are even already; false when other outlines are in the way.
    bool replace(Run& run) {
        constexpr int kRounds = 4; // folds move the circle that they lie on, and so where it is cut
        Facets facets = facetsOf(run);
        std::vector<double> places = placesOf(run, facets);
        if (isEven(run) && isEven(places)) return true;
        for (int round = 0; round < kRounds; ++round) {
            facets.reach = reachOf(run, places, std::abs(facets.sweep));
            findCuts(run, facets);
            places = placesOf(run, facets);
        }
        std::vector<glm::dvec2> corners;
        for (size_t k = 1; k + 1 < places.size(); ++k) corners.push_back(facets.at(places[k]));
        if (!staysApart(run, corners)) return false;
        auto& points = loop().points;
        auto& edges = loop().edges;
        const auto at = static_cast<std::ptrdiff_t>(run.first);
        const OutlineEdge edge = edges[run.first];
        points.erase(points.begin() + at + 1, points.begin() + at + static_cast<std::ptrdiff_t>(run.count));
        points.insert(points.begin() + at + 1, corners.begin(), corners.end());
        edges.erase(edges.begin() + at, edges.begin() + at + static_cast<std::ptrdiff_t>(run.count));
        edges.insert(edges.begin() + at, corners.size() + 1, edge);
        run.count = corners.size() + 1;
        return true;
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

// One long face of a curved partition, cut by what stands across it.
class PartitionFace {
public:
    PartitionFace(const WallPiece& piece, bool outer)
        : piece_(piece), radius_(piece.radius + (outer ? 0.5 : -0.5) * piece.thickness),
          planned_(faceCorners(piece, outer)) {}

    Circle circle() const { return {piece_.center, radius_}; }

    void cutAt(glm::dvec2 p) {
        if (const double angle = angleOn(piece_, p); isOn(piece_, angle)) cuts_.push_back({angle, p});
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

    const WallPiece& piece_;
    double radius_;
    std::vector<glm::dvec2> planned_;
    std::vector<Cut> cuts_;
};

std::vector<glm::dvec2> evenFace(const PlanWalls& plan, size_t own, bool outer,
                                 const std::vector<RoomPlan>& rooms) {
    PartitionFace face(plan.partitions[own], outer);
    Crossings crossings(face.circle());
    for (const RoomPlan& room : rooms)
        for (const OutlineLoop& loop : room.loops) crossings.add(loop.points);
    for (size_t i = 0; i < plan.partitions.size(); ++i)
        if (i != own) crossings.add(plan.partitions[i]);
    for (const glm::dvec2 p : crossings.at) face.cutAt(p);
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
