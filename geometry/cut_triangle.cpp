#include "geometry/cut_triangle.h"

#include <cmath>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#pragma GCC diagnostic pop

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

} // namespace

CutResult cutTriangle(const std::vector<glm::dvec2>& border, const std::vector<CutSegment>& segments) {
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
