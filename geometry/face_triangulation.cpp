#include <cmath>
#include <map>

#include <glm/geometric.hpp>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#pragma GCC diagnostic pop

#include "geometry/face_soup.h"

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

// Two axes of the face's plane, the third pointing away from the viewer's air side being dropped.
std::pair<int, int> axesOf(glm::dvec3 normal) {
    const glm::dvec3 size = glm::abs(normal);
    if (size.x >= size.y && size.x >= size.z) return normal.x > 0 ? std::pair(1, 2) : std::pair(2, 1);
    if (size.y >= size.z) return normal.y > 0 ? std::pair(2, 0) : std::pair(0, 2);
    return normal.z > 0 ? std::pair(0, 1) : std::pair(1, 0);
}

// Faces outside the outline and in holes get an odd or even number of constraints to cross from infinity.
void markDepth(Triangulation& t) {
    for (auto f = t.all_faces_begin(); f != t.all_faces_end(); ++f) f->info() = -1;
    std::vector<Triangulation::Face_handle> front{t.infinite_face()};
    front[0]->info() = 0;
    for (size_t i = 0; i < front.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            const auto other = front[i]->neighbor(k);
            if (other->info() >= 0) continue;
            if (front[i]->is_constrained(k)) continue;
            other->info() = front[i]->info();
            front.push_back(other);
        }
}

// All faces by how many constraints lie between them and infinity.
void markAllDepths(Triangulation& t) {
    markDepth(t);
    for (int depth = 1; true; ++depth) {
        std::vector<Triangulation::Face_handle> front;
        for (auto f = t.all_faces_begin(); f != t.all_faces_end(); ++f) {
            if (f->info() >= 0) continue;
            for (int k = 0; k < 3; ++k)
                if (f->is_constrained(k) && f->neighbor(k)->info() == depth - 1) {
                    f->info() = depth;
                    front.push_back(f);
                    break;
                }
        }
        if (front.empty()) return;
        for (size_t i = 0; i < front.size(); ++i)
            for (int k = 0; k < 3; ++k) {
                const auto other = front[i]->neighbor(k);
                if (other->info() >= 0 || front[i]->is_constrained(k)) continue;
                other->info() = depth;
                front.push_back(other);
            }
    }
}

} // namespace

std::vector<std::array<uint32_t, 3>> triangulateFace(const Building& building, const Face& face) {
    glm::dvec3 normal{0};
    for (const auto& loop : face.loops)
        for (size_t i = 0; i < loop.size(); ++i)
            normal += glm::cross(building.vertices[loop[i]] - building.vertices[loop[0]],
                                 building.vertices[loop[(i + 1) % loop.size()]] - building.vertices[loop[0]]);
    const auto [u, v] = axesOf(normal);

    std::vector<std::array<uint32_t, 3>> out;
    Triangulation t;
    std::map<uint32_t, Triangulation::Vertex_handle> handles;
    try {
        for (const auto& loop : face.loops)
            for (const uint32_t index : loop) {
                const glm::dvec3 p = building.vertices[index];
                const auto handle = t.insert(Kernel::Point_2(p[u], p[v]));
                if (const auto known = handles.find(index); known == handles.end()) {
                    for (const auto& [other, at] : handles)
                        if (at == handle) return {}; // two corners in one place
                }
                handle->info() = index;
                handles[index] = handle;
            }
        for (const auto& loop : face.loops)
            for (size_t i = 0; i < loop.size(); ++i)
                t.insert_constraint(handles.at(loop[i]), handles.at(loop[(i + 1) % loop.size()]));
    } catch (const Triangulation::Intersection_of_constraints_exception&) {
        return {};
    }
    markAllDepths(t);
    for (auto f = t.finite_faces_begin(); f != t.finite_faces_end(); ++f)
        if (f->info() % 2 == 1)
            out.push_back({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
    return out;
}

} // namespace heliodon::geometry
