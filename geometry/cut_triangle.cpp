#include "geometry/cut_triangle.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

namespace heliodon::geometry {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
// Vertices that crossings of constraints create start at 0.
struct Number {
    int value = 0;
};
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<Number, Kernel>;
using FaceBase =
    CGAL::Triangulation_face_base_with_info_2<int, Kernel,
                                              CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::Exact_predicates_tag>;

constexpr double kSamePoint = 1e-8; // metres

bool same(glm::dvec2 p, glm::dvec2 q) {
    return std::abs(p.x - q.x) < kSamePoint && std::abs(p.y - q.y) < kSamePoint;
}

// Points on an edge may lie a rounding error inside it; what is left between them and the hull is outside the
// border.
void markOutside(Triangulation& t, int borderCount) {
    for (auto f = t.all_faces_begin(); f != t.all_faces_end(); ++f) f->info() = 0;
    std::vector<Triangulation::Face_handle> front{t.infinite_face()};
    front[0]->info() = 1;
    for (size_t i = 0; i < front.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            const auto other = front[i]->neighbor(k);
            if (other->info() != 0) continue;
            const int a = front[i]->vertex(Triangulation::ccw(k))->info().value,
                      b = front[i]->vertex(Triangulation::cw(k))->info().value;
            const bool finite = !t.is_infinite(front[i]->vertex(Triangulation::ccw(k))) &&
                                !t.is_infinite(front[i]->vertex(Triangulation::cw(k)));
            const bool border = finite && a <= borderCount && b <= borderCount &&
                                (a % borderCount + 1 == b || b % borderCount + 1 == a);
            if (border) continue;
            other->info() = 1;
            front.push_back(other);
        }
}

// Where all segments run from border to border: convex cells, divided by one segment after the other.
class ChordCutter {
public:
    explicit ChordCutter(const std::vector<glm::dvec2>& border) {
        out_.points = border;
        cells_.emplace_back(border.size());
        for (uint32_t i = 0; i < border.size(); ++i) cells_[0][i] = i;
    }

    void cut(int from, int to) {
        const glm::dvec2 a = out_.points[static_cast<size_t>(from)],
                         d = out_.points[static_cast<size_t>(to)] - a;
        crossings_.clear();
        for (size_t c = 0, n = cells_.size(); c < n; ++c) divide(c, a, d / glm::length(d));
    }

    // Ears of the largest smallest angle first: points on one side of the border make flat ones.
    CutResult triangles() {
        for (std::vector<uint32_t>& cell : cells_)
            while (cell.size() >= 3) {
                const size_t n = cell.size();
                size_t best = n;
                double most = kFlat;
                for (size_t i = 0; i < n; ++i) {
                    const double sine =
                        smallestSine(corner(cell, i + n - 1), corner(cell, i), corner(cell, i + 1));
                    if (sine <= most || (n > 3 && flatWithout(cell, i))) continue;
                    most = sine;
                    best = i;
                }
                if (best == n) break; // nothing but a line is left
                out_.triangles.push_back({cell[(best + n - 1) % n], cell[best], cell[(best + 1) % n]});
                cell.erase(cell.begin() + static_cast<std::ptrdiff_t>(best));
            }
        return std::move(out_);
    }

private:
    static constexpr double kFlat = 1e-9;
    static constexpr double kOnLine = 1e-8; // metres

    static double cross(glm::dvec2 u, glm::dvec2 v) { return u.x * v.y - u.y * v.x; }
    glm::dvec2 corner(const std::vector<uint32_t>& cell, size_t i) const {
        return out_.points[cell[i % cell.size()]];
    }

    // All corners but i lie on a line: what is left would have no area, and its points no triangle.
    bool flatWithout(const std::vector<uint32_t>& cell, size_t i) const {
        const size_t n = cell.size();
        const glm::dvec2 a = corner(cell, i + 1), d = corner(cell, i + n - 1) - a;
        for (size_t k = 2; k + 1 < n; ++k)
            if (std::abs(cross(d, corner(cell, i + k) - a)) > kFlat * glm::dot(d, d)) return false;
        return true;
    }

    static double smallestSine(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
        const double u = glm::length(b - a), v = glm::length(c - b), w = glm::length(a - c);
        return cross(b - a, c - a) / std::max({u * v, v * w, w * u});
    }

    void divide(size_t c, glm::dvec2 a, glm::dvec2 direction) {
        const std::vector<uint32_t> cell = cells_[c];
        side_.clear();
        bool left = false, right = false;
        for (const uint32_t i : cell) {
            const double s = cross(direction, out_.points[i] - a);
            side_.push_back(std::abs(s) < kOnLine ? 0 : s);
            left = left || side_.back() > 0;
            right = right || side_.back() < 0;
        }
        if (!left || !right) return;
        std::vector<uint32_t> more, less;
        for (size_t i = 0, n = cell.size(); i < n; ++i) {
            const size_t j = (i + 1) % n;
            if (side_[i] >= 0) more.push_back(cell[i]);
            if (side_[i] <= 0) less.push_back(cell[i]);
            if (side_[i] * side_[j] < 0) {
                const uint32_t x = crossing(cell[i], cell[j], side_[i] / (side_[i] - side_[j]));
                more.push_back(x);
                less.push_back(x);
            }
        }
        cells_[c] = std::move(more);
        cells_.push_back(std::move(less));
    }

    // Shared by the two cells on either side.
    uint32_t crossing(uint32_t i, uint32_t j, double t) {
        const std::pair<uint32_t, uint32_t> key = std::minmax(i, j);
        for (const auto& [edge, point] : crossings_)
            if (edge == key) return point;
        crossings_.emplace_back(key, static_cast<uint32_t>(out_.points.size()));
        out_.points.push_back(out_.points[i] + t * (out_.points[j] - out_.points[i]));
        return crossings_.back().second;
    }

    CutResult out_;
    std::vector<std::vector<uint32_t>> cells_;
    std::vector<std::pair<std::pair<uint32_t, uint32_t>, uint32_t>> crossings_;
    std::vector<double> side_;
};

} // namespace

CutResult cutTriangle(const std::vector<glm::dvec2>& border, const std::vector<CutSegment>& segments) {
    const bool chords = std::ranges::all_of(
        segments, [](const CutSegment& s) { return s.border[0] >= 0 && s.border[1] >= 0; });
    if (chords) {
        ChordCutter cutter(border);
        for (const CutSegment& s : segments)
            if (s.border[0] != s.border[1]) cutter.cut(s.border[0], s.border[1]);
        return cutter.triangles();
    }
    Triangulation t;
    std::vector<Triangulation::Vertex_handle> handles;
    for (const glm::dvec2 p : border) {
        handles.push_back(t.insert(Kernel::Point_2(p.x, p.y)));
        handles.back()->info().value =
            static_cast<int>(handles.size()); // 1-based: 0 is what a new vertex has
    }
    for (size_t i = 0; i < handles.size(); ++i)
        t.insert_constraint(handles[i], handles[(i + 1) % handles.size()]);
    // Ends that several cuts share were computed apart.
    std::vector<std::pair<glm::dvec2, Triangulation::Vertex_handle>> ends;
    const auto handleAt = [&](glm::dvec2 p) {
        for (const auto& [known, handle] : ends)
            if (same(known, p)) return handle;
        ends.emplace_back(p, t.insert(Kernel::Point_2(p.x, p.y)));
        return ends.back().second;
    };
    for (size_t i = 0; i < border.size(); ++i) ends.emplace_back(border[i], handles[i]);
    for (const CutSegment& s : segments) {
        std::array<Triangulation::Vertex_handle, 2> end;
        for (size_t k = 0; k < 2; ++k)
            end[k] = s.border[k] >= 0 ? handles[static_cast<size_t>(s.border[k])] : handleAt(s.point[k]);
        if (end[0] != end[1]) t.insert_constraint(end[0], end[1]);
    }
    CutResult out;
    out.points = border;
    for (auto v = t.finite_vertices_begin(); v != t.finite_vertices_end(); ++v)
        if (v->info().value <= 0 || static_cast<size_t>(v->info().value) > border.size()) {
            out.points.emplace_back(v->point().x(), v->point().y());
            v->info().value = static_cast<int>(out.points.size());
        }
    std::vector<uint32_t> merged(out.points.size());
    for (uint32_t i = 0; i < merged.size(); ++i) {
        merged[i] = i;
        for (uint32_t k = 0; i >= border.size() && k < i && merged[i] == i; ++k)
            if (same(out.points[k], out.points[i])) merged[i] = merged[k];
    }
    markOutside(t, static_cast<int>(border.size()));
    for (auto f = t.finite_faces_begin(); f != t.finite_faces_end(); ++f) {
        if (f->info() != 0) continue;
        std::array<uint32_t, 3> corner{};
        for (int k = 0; k < 3; ++k)
            corner[static_cast<size_t>(k)] = static_cast<uint32_t>(f->vertex(k)->info().value - 1);
        out.triangles.push_back(corner);
    }
    return out;
}

} // namespace heliodon::geometry
