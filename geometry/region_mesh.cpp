#include "geometry/region_mesh.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include "geometry/perpendicular.h"
#include "geometry/segment_distance.h"

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

// The lines as edges between nodes that meet at nodes only.
class LineNet {
public:
    explicit LineNet(const Region& region)
        : points(region.border), onLine_(points.size()), cellSize_(0.5 * region.spacing),
          cells_(2 * region.lines.size() + 1, kNone), next_(points.size(), kNone) {
        borderCount_ = static_cast<uint32_t>(points.size());
        for (const RegionLine& line : region.lines) {
            const uint32_t a = node(line, 0), b = node(line, 1);
            if (a != b) lines_.emplace_back(a, b);
        }
        crossLines();
        split();
        simplify();
        divide(region.spacing);
    }

    std::vector<glm::dvec2> points; // the border's, then nodes
    std::vector<std::pair<uint32_t, uint32_t>> edges;

private:
    struct Split { // of a line, at a + t (b - a)
        size_t line;
        double t;
        uint32_t node;
    };

    uint32_t node(const RegionLine& line, size_t end) {
        if (line.border[end] < 0) return nodeAt(line.point[end]);
        const auto v = static_cast<uint32_t>(line.border[end]);
        if (!onLine_[v]) use(v);
        return v;
    }

    // The first that is there already, in cells of a grid.
    uint32_t nodeAt(glm::dvec2 p) {
        uint32_t same = kNone;
        for (const double dx : {-kSameInRegion, kSameInRegion})
            for (const double dy : {-kSameInRegion, kSameInRegion})
                for (uint32_t v = cells_[cellOf(p + glm::dvec2(dx, dy))]; v != kNone; v = next_[v])
                    if (std::abs(points[v].x - p.x) <= kSameInRegion &&
                        std::abs(points[v].y - p.y) <= kSameInRegion)
                        same = std::min(same, v);
        if (same != kNone) return same;
        points.push_back(p);
        use(static_cast<uint32_t>(points.size() - 1));
        return used_.back();
    }

    void use(uint32_t v) {
        used_.push_back(v);
        onLine_.resize(points.size());
        next_.resize(points.size(), kNone);
        onLine_[v] = true;
        uint32_t& cell = cells_[cellOf(points[v])];
        next_[v] = std::exchange(cell, v);
    }

    size_t cellOf(glm::dvec2 p) const {
        const auto column = static_cast<int64_t>(std::floor(p.x / cellSize_)),
                   row = static_cast<int64_t>(std::floor(p.y / cellSize_));
        return static_cast<size_t>(column * 73856093 ^ row * 19349663) % cells_.size();
    }

    void crossLines() {
        std::vector<FlatBox> boxes;
        for (const auto& [a, b] : lines_) boxes.push_back(boxOf(std::array{points[a], points[b]}));
        for (size_t i = 0; i < lines_.size(); ++i)
            for (size_t j = i + 1; j < lines_.size(); ++j) {
                if (!boxes[i].touches(boxes[j])) continue;
                const auto [ma, mb] = lines_[i];
                const auto [na, nb] = lines_[j];
                const glm::dvec2 p = points[ma], d = points[mb] - p, q = points[na], e = points[nb] - q;
                const double sa = cross(d, q - p), sb = cross(d, q + e - p);
                if ((sa > 0) == (sb > 0)) continue;
                const double ta = cross(e, p - q), tb = cross(e, p + d - q);
                if ((ta > 0) == (tb > 0)) continue;
                const double t = ta / (ta - tb), u = sa / (sa - sb);
                const uint32_t v = nodeAt(p + t * d);
                if (v != ma && v != mb) splits_.push_back({i, t, v});
                if (v != na && v != nb) splits_.push_back({j, u, v});
            }
    }

    void split() {
        for (size_t i = 0; i < lines_.size(); ++i) {
            const auto [from, to] = lines_[i];
            const glm::dvec2 a = points[from], d = points[to] - a;
            const double square = glm::dot(d, d), size = std::sqrt(square);
            const glm::dvec2 low = glm::min(a, a + d) - kSameInRegion,
                             high = glm::max(a, a + d) + kSameInRegion;
            for (const uint32_t v : used_) {
                const glm::dvec2 p = points[v];
                if (p.x < low.x || p.y < low.y || p.x > high.x || p.y > high.y || v == from || v == to)
                    continue;
                const double t = glm::dot(p - a, d) / square;
                if (t > 0 && t < 1 && std::abs(cross(d, p - a)) <= kSameInRegion * size)
                    splits_.push_back({i, t, v});
            }
            splits_.push_back({i, 1.0, to});
        }
        std::ranges::sort(splits_, {}, [](const Split& s) { return std::tuple(s.line, s.t, s.node); });
        size_t line = lines_.size();
        for (uint32_t last = 0; const Split& s : splits_) {
            if (s.line != line) last = lines_[line = s.line].first;
            if (s.node != last) edges.emplace_back(std::minmax(s.node, last));
            last = s.node;
        }
        std::ranges::sort(edges);
        const auto repeated = std::ranges::unique(edges);
        edges.erase(repeated.begin(), repeated.end());
    }

    // Corners between two edges that run nearly straight on.
    void simplify() {
        std::vector<uint32_t> first(points.size() + 1, 0), count(points.size(), 0);
        for (const auto& [a, b] : edges) ++first[a + 1], ++first[b + 1];
        for (size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
        std::vector<uint32_t> ends(first.back());
        for (uint32_t e = 0; e < edges.size(); ++e)
            for (const uint32_t v : {edges[e].first, edges[e].second}) ends[first[v] + count[v]++] = e;
        const auto around = [&](uint32_t v) { return std::span(ends).subspan(first[v], count[v]); };
        std::vector<double> moved(edges.size(), 0);
        std::vector<bool> gone(edges.size(), false);
        const auto otherEnd = [&](uint32_t e, uint32_t v) {
            return edges[e].first == v ? edges[e].second : edges[e].first;
        };
        for (const uint32_t v : used_) {
            if (v < borderCount_ || count[v] != 2) continue;
            const uint32_t e = around(v)[0], f = around(v)[1], a = otherEnd(e, v), b = otherEnd(f, v);
            const double off =
                distanceToSegment(points[v], points[a], points[b]) + std::max(moved[e], moved[f]);
            if (off > kStraight || a == b) continue;
            const bool joined =
                std::ranges::any_of(around(a), [&](uint32_t g) { return otherEnd(g, a) == b; });
            if (joined) continue;
            edges[e] = {a, b};
            moved[e] = off;
            gone[f] = true;
            *std::ranges::find(around(b), f) = e;
            count[v] = 0;
        }
        size_t kept = 0;
        for (size_t e = 0; e < edges.size(); ++e)
            if (!gone[e]) edges[kept++] = edges[e];
        edges.resize(kept);
        dropUnused(count);
    }

    void dropUnused(const std::vector<uint32_t>& edgesAt) {
        std::vector<uint32_t> place(points.size());
        uint32_t count = 0;
        for (uint32_t v = 0; v < points.size(); ++v)
            if (v < borderCount_ || edgesAt[v] > 0) {
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

    static constexpr uint32_t kNone = 0xffffffffu;

    uint32_t borderCount_ = 0;
    std::vector<uint32_t> used_; // nodes at which lines end or cross
    std::vector<bool> onLine_;   // per node: whether it is one of them
    double cellSize_;
    std::vector<uint32_t> cells_, next_; // the last node used in each cell of a hashed grid; those before it
    std::vector<std::pair<uint32_t, uint32_t>> lines_;
    std::vector<Split> splits_;
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
            if (distanceToSegment(region.seeds[s], p, q) < kMakesWay * region.seedSpacing[s])
                stays[s] = false;
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
