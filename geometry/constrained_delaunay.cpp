#include "geometry/constrained_delaunay.h"

#include <algorithm>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

namespace heliodon::geometry {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<uint32_t, Kernel>;
using FaceBase =
    CGAL::Triangulation_face_base_with_info_2<int, Kernel,
                                              CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::No_constraint_intersection_tag>;

using Edges = std::span<const std::pair<uint32_t, uint32_t>>;

// Whether the edge opposite corner k bounds the polygons; `dividers`: ascending, those within them.
bool isBorder(Triangulation::Face_handle f, int k, Edges dividers) {
    if (!f->is_constrained(k)) return false;
    const auto [a, b] = std::minmax(f->vertex((k + 1) % 3)->info(), f->vertex((k + 2) % 3)->info());
    return dividers.empty() || !std::ranges::binary_search(dividers, std::pair<uint32_t, uint32_t>(a, b));
}

// Each face's info: how many edges of the polygons lie between it and infinity.
void markDepths(Triangulation& t, Edges dividers) {
    for (auto f = t.all_faces_begin(); f != t.all_faces_end(); ++f) f->info() = -1;
    std::vector<Triangulation::Face_handle> front{t.infinite_face()}, behind;
    front[0]->info() = 0;
    for (int depth = 0; !front.empty(); ++depth) {
        behind.clear();
        for (size_t i = 0; i < front.size(); ++i)
            for (int k = 0; k < 3; ++k) {
                const auto other = front[i]->neighbor(k);
                if (other->info() >= 0) continue;
                if (isBorder(front[i], k, dividers)) {
                    behind.push_back(other);
                } else {
                    other->info() = depth;
                    front.push_back(other);
                }
            }
        front.clear();
        for (const auto& f : behind)
            if (f->info() < 0) {
                f->info() = depth + 1;
                front.push_back(f);
            }
    }
}

TriangleNet insideOf(Triangulation& t, Edges dividers) {
    markDepths(t, dividers);
    std::vector<Triangulation::Face_handle> inside;
    for (auto f = t.all_faces_begin(); f != t.all_faces_end(); ++f) {
        const bool in = !t.is_infinite(f) && f->info() % 2 == 1;
        f->info() = in ? static_cast<int>(inside.size()) : -1;
        if (in) inside.push_back(f);
    }
    TriangleNet net;
    for (const auto& f : inside) {
        std::array<uint32_t, 3> corner{}, neighbour{};
        std::array<bool, 3> fixed{};
        for (int k = 0; k < 3; ++k) {
            const auto at = static_cast<size_t>(k);
            const int other = f->neighbor(k)->info();
            corner[at] = f->vertex(k)->info();
            neighbour[at] = other >= 0 ? static_cast<uint32_t>(other) : kNoTriangle;
            fixed[at] = f->is_constrained(k);
        }
        net.corner.push_back(corner);
        net.neighbour.push_back(neighbour);
        net.fixed.push_back(fixed);
    }
    return net;
}

} // namespace

std::optional<TriangleNet> constrainedDelaunay(std::span<const glm::dvec2> points,
                                               std::span<const std::pair<uint32_t, uint32_t>> edges,
                                               std::span<const std::pair<uint32_t, uint32_t>> dividers) {
    Triangulation t;
    std::vector<std::pair<Kernel::Point_2, uint32_t>> numbered;
    numbered.reserve(points.size());
    for (uint32_t i = 0; i < points.size(); ++i)
        numbered.emplace_back(Kernel::Point_2(points[i].x, points[i].y), i);
    t.insert(numbered.begin(), numbered.end());
    if (t.number_of_vertices() != points.size()) return {};
    std::vector<Triangulation::Vertex_handle> handles(points.size());
    for (auto v = t.finite_vertices_begin(); v != t.finite_vertices_end(); ++v) handles[v->info()] = v;
    try {
        for (const Edges of : {edges, dividers})
            for (const auto& [a, b] : of) t.insert_constraint(handles[a], handles[b]);
    } catch (const Triangulation::Intersection_of_constraints_exception&) {
        return {};
    }
    std::vector<std::pair<uint32_t, uint32_t>> inner;
    for (const auto& edge : dividers) inner.emplace_back(std::minmax(edge.first, edge.second));
    std::ranges::sort(inner);
    return insideOf(t, inner);
}

} // namespace heliodon::geometry
