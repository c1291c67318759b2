#include "geometry/region_mesh.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include "geometry/perpendicular.h"

namespace heliodon::geometry {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
// Vertices that crossings of constraints create start with none.
struct Number {
    uint32_t value = 0xffffffffu;
    bool known() const { return value != 0xffffffffu; }
};
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<Number, Kernel>;
using FaceBase =
    CGAL::Triangulation_face_base_with_info_2<int, Kernel,
                                              CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::Exact_predicates_tag>;

constexpr double kStraight = 1.5e-4; // metres: how far lines move to get rid of their corners
constexpr double kMakesWay = 0.25;   // of its spacing: a seed nearer to a line

double distanceTo(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
    const glm::dvec2 d = b - a;
    const double square = glm::dot(d, d),
                 t = square > 0 ? std::clamp(glm::dot(p - a, d) / square, 0.0, 1.0) : 0;
    return glm::length(p - a - t * d);
}

// Inside, and not on the border.
bool wellInside(glm::dvec2 p, std::span<const Segment> border) {
    bool in = false;
    for (const auto& [a, b] : border) {
        if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x) in = !in;
        if (std::min(a.y, b.y) > p.y + kSameInRegion || std::max(a.y, b.y) < p.y - kSameInRegion) continue;
        if (distanceTo(p, a, b) <= kSameInRegion) return false;
    }
    return in;
}

// Cuts one segment where it meets the border.
class SegmentClipper {
public:
    SegmentClipper(std::span<const Segment> border, std::vector<Cut>& out) : border_(border), out_(out) {}

    void clip(const Segment& segment) {
        a_ = segment[0];
        length_ = glm::length(segment[1] - segment[0]);
        if (!(length_ > kSameInRegion)) return;
        along_ = (segment[1] - segment[0]) / length_;
        low_ = glm::min(segment[0], segment[1]) - kSameInRegion;
        high_ = glm::max(segment[0], segment[1]) + kSameInRegion;
        stops_.clear();
        for (size_t i = 0; i < border_.size(); ++i) meet(static_cast<int>(i));
        join();
        for (size_t k = 0; k + 1 < stops_.size(); ++k) {
            const double from = stops_[k].at, to = stops_[k + 1].at;
            if (to - from > kSameInRegion && wellInside(place(0.5 * (from + to)), border_))
                out_.push_back({endAt(stops_[k]), endAt(stops_[k + 1])});
        }
    }

private:
    struct Stop {
        double at = 0; // metres along the segment
        int edge = -1;
        double t = 0;
        bool corner() const { return edge >= 0 && (t == 0 || t == 1); }
    };

    glm::dvec2 place(double at) const { return a_ + at * along_; }

    CutEnd endAt(const Stop& stop) const {
        if (stop.edge < 0) return {place(stop.at), -1, 0};
        const auto& [p, q] = border_[static_cast<size_t>(stop.edge)];
        return {p + stop.t * (q - p), stop.edge, stop.t};
    }

    void stop(double at, int edge, double t, double edgeLength) {
        if (at < -kSameInRegion || at > length_ + kSameInRegion) return;
        if (t * edgeLength <= kSameInRegion) t = 0;
        if ((1 - t) * edgeLength <= kSameInRegion) t = 1;
        stops_.push_back({std::clamp(at, 0.0, length_), edge, t});
    }

    void meet(int i) {
        const auto& [p, q] = border_[static_cast<size_t>(i)];
        if (std::max(p.x, q.x) < low_.x || std::max(p.y, q.y) < low_.y || std::min(p.x, q.x) > high_.x ||
            std::min(p.y, q.y) > high_.y)
            return;
        const glm::dvec2 e = q - p;
        const double size = glm::length(e), sp = cross(along_, p - a_), sq = cross(along_, q - a_);
        if (std::abs(sp) <= kSameInRegion) stop(glm::dot(p - a_, along_), i, 0, size);
        if (std::abs(sq) <= kSameInRegion) stop(glm::dot(q - a_, along_), i, 1, size);
        if (sp * sq < 0) {
            const double t = sp / (sp - sq);
            stop(glm::dot(p + t * e - a_, along_), i, t, size);
        }
        for (const double at : {0.0, length_}) { // ends that touch at a small angle
            const double t = std::clamp(glm::dot(place(at) - p, e) / (size * size), 0.0, 1.0);
            if (glm::length(place(at) - p - t * e) <= kSameInRegion) stop(at, i, t, size);
        }
    }

    // Stops at one place become one, at a corner if any is; the segment's own ends are stops too.
    void join() {
        std::ranges::sort(stops_, [](const Stop& s, const Stop& o) {
            return std::pair(s.at, s.edge) < std::pair(o.at, o.edge);
        });
        std::vector<Stop> joined;
        if (stops_.empty() || stops_[0].at > kSameInRegion) joined.push_back({0, -1, 0});
        for (const Stop& s : stops_)
            if (!joined.empty() && joined.back().edge >= 0 && s.at - joined.back().at <= kSameInRegion) {
                if (s.corner() && !joined.back().corner()) joined.back() = s;
            } else {
                joined.push_back(s);
            }
        if (joined.back().at < length_ - kSameInRegion) joined.push_back({length_, -1, 0});
        stops_ = std::move(joined);
    }

    std::span<const Segment> border_;
    std::vector<Cut>& out_;
    glm::dvec2 a_{}, along_{}, low_{}, high_{};
    double length_ = 0;
    std::vector<Stop> stops_;
};

// The lines as edges between nodes that meet at nodes only.
class LineNet {
public:
    explicit LineNet(const Region& region) : points(region.border) {
        borderCount_ = static_cast<uint32_t>(points.size());
        for (const RegionLine& line : region.lines) {
            const uint32_t a = node(line, 0), b = node(line, 1);
            if (a != b) lines_.push_back({a, b, {}});
        }
        crossLines();
        split();
        simplify();
        divide(region.spacing);
    }

    std::vector<glm::dvec2> points; // the border's, then nodes
    std::vector<std::pair<uint32_t, uint32_t>> edges;

private:
    struct Line {
        uint32_t a, b;
        std::vector<std::pair<double, uint32_t>> splits;
    };

    uint32_t node(const RegionLine& line, size_t end) {
        if (line.border[end] < 0) return nodeAt(line.point[end]);
        const auto v = static_cast<uint32_t>(line.border[end]);
        if (std::ranges::find(used_, v) == used_.end()) used_.push_back(v);
        return v;
    }

    uint32_t nodeAt(glm::dvec2 p) {
        for (const uint32_t v : used_) {
            const glm::dvec2 d = points[v] - p;
            if (std::abs(d.x) <= kSameInRegion && std::abs(d.y) <= kSameInRegion) return v;
        }
        used_.push_back(static_cast<uint32_t>(points.size()));
        points.push_back(p);
        return used_.back();
    }

    void crossLines() {
        for (size_t i = 0; i < lines_.size(); ++i)
            for (size_t j = i + 1; j < lines_.size(); ++j) {
                Line &m = lines_[i], &n = lines_[j];
                const glm::dvec2 p = points[m.a], d = points[m.b] - p, q = points[n.a], e = points[n.b] - q;
                const double sa = cross(d, q - p), sb = cross(d, q + e - p);
                if ((sa > 0) == (sb > 0)) continue;
                const double ta = cross(e, p - q), tb = cross(e, p + d - q);
                if ((ta > 0) == (tb > 0)) continue;
                const double t = ta / (ta - tb), u = sa / (sa - sb);
                const uint32_t v = nodeAt(p + t * d);
                if (v != m.a && v != m.b) m.splits.emplace_back(t, v);
                if (v != n.a && v != n.b) n.splits.emplace_back(u, v);
            }
    }

    void split() {
        std::set<std::pair<uint32_t, uint32_t>> known;
        for (Line& line : lines_) {
            const glm::dvec2 a = points[line.a], d = points[line.b] - a;
            const double square = glm::dot(d, d), size = std::sqrt(square);
            const glm::dvec2 low = glm::min(a, a + d) - kSameInRegion,
                             high = glm::max(a, a + d) + kSameInRegion;
            for (const uint32_t v : used_) {
                const glm::dvec2 p = points[v];
                if (v == line.a || v == line.b || p.x < low.x || p.y < low.y || p.x > high.x || p.y > high.y)
                    continue;
                const double t = glm::dot(p - a, d) / square;
                if (t > 0 && t < 1 && std::abs(cross(d, p - a)) <= kSameInRegion * size)
                    line.splits.emplace_back(t, v);
            }
            std::ranges::sort(line.splits);
            line.splits.emplace_back(1.0, line.b);
            for (uint32_t last = line.a; const auto& [t, v] : line.splits) {
                if (v != last && known.insert(std::minmax(v, last)).second) edges.emplace_back(last, v);
                last = v;
            }
        }
    }

    // Corners between two edges that run nearly straight on.
    void simplify() {
        std::vector<std::vector<uint32_t>> around(points.size());
        for (uint32_t e = 0; e < edges.size(); ++e) {
            around[edges[e].first].push_back(e);
            around[edges[e].second].push_back(e);
        }
        std::vector<double> moved(edges.size(), 0);
        std::vector<bool> gone(edges.size(), false);
        const auto otherEnd = [&](uint32_t e, uint32_t v) {
            return edges[e].first == v ? edges[e].second : edges[e].first;
        };
        for (const uint32_t v : used_) {
            if (v < borderCount_ || around[v].size() != 2) continue;
            const uint32_t e = around[v][0], f = around[v][1], a = otherEnd(e, v), b = otherEnd(f, v);
            const double off = distanceTo(points[v], points[a], points[b]) + std::max(moved[e], moved[f]);
            if (off > kStraight || a == b) continue;
            const bool joined =
                std::ranges::any_of(around[a], [&](uint32_t g) { return otherEnd(g, a) == b; });
            if (joined) continue;
            edges[e] = {a, b};
            moved[e] = off;
            gone[f] = true;
            *std::ranges::find(around[b], f) = e;
            around[v].clear();
        }
        size_t kept = 0;
        for (size_t e = 0; e < edges.size(); ++e)
            if (!gone[e]) edges[kept++] = edges[e];
        edges.resize(kept);
        dropUnused(around);
    }

    void dropUnused(const std::vector<std::vector<uint32_t>>& around) {
        std::vector<uint32_t> place(points.size());
        uint32_t count = 0;
        for (uint32_t v = 0; v < points.size(); ++v)
            if (v < borderCount_ || !around[v].empty()) {
                points[count] = points[v];
                place[v] = count++;
            }
        points.resize(count);
        for (auto& [a, b] : edges) a = place[a], b = place[b];
    }

    void divide(double spacing) {
        std::vector<std::pair<uint32_t, uint32_t>> whole;
        whole.swap(edges);
        for (const auto& [a, b] : whole) {
            const glm::dvec2 p = points[a], d = points[b] - p;
            const double parts = std::max(1.0, std::round(glm::length(d) / spacing));
            uint32_t last = a;
            for (double k = 1; k < parts; ++k) {
                edges.emplace_back(last, static_cast<uint32_t>(points.size()));
                last = edges.back().second;
                points.push_back(p + k / parts * d);
            }
            edges.emplace_back(last, b);
        }
    }

    uint32_t borderCount_ = 0;
    std::vector<uint32_t> used_; // nodes at which lines end or cross
    std::vector<Line> lines_;
};

// Seeds by cells of a grid.
class SeedGrid {
public:
    SeedGrid(const std::vector<glm::dvec2>& seeds, double cell) : seeds_(seeds), cell_(cell) {
        low_ = high_ = seeds[0];
        for (const glm::dvec2 p : seeds) low_ = glm::min(low_, p), high_ = glm::max(high_, p);
        columns_ = static_cast<int>((high_.x - low_.x) / cell_) + 1;
        rows_ = static_cast<int>((high_.y - low_.y) / cell_) + 1;
        first_.assign(static_cast<size_t>(columns_) * static_cast<size_t>(rows_) + 1, 0);
        for (const glm::dvec2 p : seeds) ++first_[cellOf(p) + 1];
        for (size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
        items_.resize(seeds.size());
        std::vector<uint32_t> at(first_.begin(), first_.end() - 1);
        for (uint32_t i = 0; i < seeds.size(); ++i) items_[at[cellOf(seeds[i])]++] = i;
    }

    template<class Visit> void near(glm::dvec2 low, glm::dvec2 high, Visit visit) const {
        for (int r = row(low.y); r <= row(high.y); ++r)
            for (int c = column(low.x); c <= column(high.x); ++c) {
                const auto cell = static_cast<size_t>(r * columns_ + c);
                for (uint32_t k = first_[cell]; k < first_[cell + 1]; ++k) visit(items_[k]);
            }
    }

private:
    int column(double x) const { return std::clamp(static_cast<int>((x - low_.x) / cell_), 0, columns_ - 1); }
    int row(double y) const { return std::clamp(static_cast<int>((y - low_.y) / cell_), 0, rows_ - 1); }
    size_t cellOf(glm::dvec2 p) const { return static_cast<size_t>(row(p.y) * columns_ + column(p.x)); }

    const std::vector<glm::dvec2>& seeds_;
    double cell_;
    glm::dvec2 low_{}, high_{};
    int columns_ = 1, rows_ = 1;
    std::vector<uint32_t> first_, items_;
};

std::vector<bool> seedsThatStay(const Region& region, const LineNet& net) {
    std::vector<bool> stays(region.seeds.size(), true);
    if (region.seeds.empty()) return stays;
    const SeedGrid grid(region.seeds, region.spacing);
    const double widest = kMakesWay * *std::ranges::max_element(region.seedSpacing);
    for (const auto& [a, b] : net.edges) {
        const glm::dvec2 p = net.points[a], q = net.points[b];
        grid.near(glm::min(p, q) - widest, glm::max(p, q) + widest, [&](uint32_t s) {
            if (distanceTo(region.seeds[s], p, q) < kMakesWay * region.seedSpacing[s]) stays[s] = false;
        });
    }
    return stays;
}

// Triangles by the parts that constraints bound. A part is outside when it lies to the right of the border's
// edges or hangs together with infinity: points on an edge may lie a rounding error beside it, and what is
// left between them and the hull is no part of the region.
class InsideFinder {
public:
    InsideFinder(Triangulation& t, const Region& region) : t_(t), border_(region.borderEdges) {
        std::ranges::sort(border_);
    }

    void addTo(RegionMesh& out) {
        for (auto f = t_.all_faces_begin(); f != t_.all_faces_end(); ++f) f->info() = 0;
        for (auto f = t_.all_faces_begin(); f != t_.all_faces_end(); ++f)
            if (f->info() == 0 && partIsInside(f))
                for (const auto& g : part_)
                    out.triangles.push_back(
                        {g->vertex(0)->info().value, g->vertex(1)->info().value, g->vertex(2)->info().value});
    }

private:
    bool partIsInside(Triangulation::Face_handle start) {
        part_.assign(1, start);
        start->info() = 1;
        bool infinite = false;
        int votes = 0;
        for (size_t i = 0; i < part_.size(); ++i) {
            const auto f = part_[i];
            infinite = infinite || t_.is_infinite(f);
            for (int k = 0; k < 3; ++k) {
                const auto other = f->neighbor(k);
                if (f->is_constrained(k)) {
                    const uint32_t a = f->vertex(Triangulation::ccw(k))->info().value,
                                   b = f->vertex(Triangulation::cw(k))->info().value;
                    votes += std::ranges::binary_search(border_, std::pair(a, b)) ? 1 : 0;
                    votes -= std::ranges::binary_search(border_, std::pair(b, a)) ? 1 : 0;
                } else if (other->info() == 0) {
                    other->info() = 1;
                    part_.push_back(other);
                }
            }
        }
        return !infinite && votes >= 0;
    }

    Triangulation& t_;
    std::vector<std::pair<uint32_t, uint32_t>> border_;
    std::vector<Triangulation::Face_handle> part_;
};

} // namespace

std::vector<Cut> clipToRegion(std::span<const Segment> segments, std::span<const Segment> borderEdges) {
    std::vector<Cut> cuts;
    SegmentClipper clipper(borderEdges, cuts);
    for (const Segment& segment : segments) clipper.clip(segment);
    return cuts;
}

RegionMesh meshRegion(const Region& region) {
    const LineNet net(region);
    const std::vector<bool> stays = seedsThatStay(region, net);
    RegionMesh out;
    const auto borderCount = static_cast<uint32_t>(region.border.size());
    out.points = region.border;
    for (uint32_t s = 0; s < region.seeds.size(); ++s)
        if (stays[s]) {
            out.keptSeeds.push_back(s);
            out.points.push_back(region.seeds[s]);
        }
    const auto onLines = static_cast<uint32_t>(out.points.size());
    out.points.insert(out.points.end(), net.points.begin() + borderCount, net.points.end());

    Triangulation t;
    std::vector<std::pair<Kernel::Point_2, Number>> numbered;
    for (uint32_t i = 0; i < out.points.size(); ++i)
        numbered.emplace_back(Kernel::Point_2(out.points[i].x, out.points[i].y), Number{i});
    t.insert(numbered.begin(), numbered.end());
    std::vector<Triangulation::Vertex_handle> handles(out.points.size());
    for (auto v = t.finite_vertices_begin(); v != t.finite_vertices_end(); ++v) handles[v->info().value] = v;
    for (size_t i = 0; i < handles.size(); ++i) // points that coincide to the last bit
        if (handles[i] == Triangulation::Vertex_handle()) handles[i] = t.insert(numbered[i].first);
    for (const auto& [a, b] : region.borderEdges) t.insert_constraint(handles[a], handles[b]);
    const auto place = [&](uint32_t v) { return handles[v < borderCount ? v : v - borderCount + onLines]; };
    for (const auto& [a, b] : net.edges)
        if (place(a) != place(b)) t.insert_constraint(place(a), place(b));
    for (auto v = t.finite_vertices_begin(); v != t.finite_vertices_end(); ++v)
        if (!v->info().known()) {
            v->info().value = static_cast<uint32_t>(out.points.size());
            out.points.emplace_back(v->point().x(), v->point().y());
        }
    InsideFinder(t, region).addTo(out);
    return out;
}

} // namespace heliodon::geometry
