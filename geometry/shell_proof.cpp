// What is true of a Building, proven on its stored coordinates: closed, one fan per vertex, no
// self-intersection.
#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include <glm/geometric.hpp>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#pragma GCC diagnostic pop

#include "geometry/face_soup.h"

namespace heliodon::geometry {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Edge = std::pair<uint32_t, uint32_t>;

class ShellProver {
public:
    ShellProver(const Building& building, uint32_t room) : building_(building) {
        for (uint32_t f = 0; f < building.faces.size(); ++f)
            if (building.faces[f].room == room) faces_.push_back(f);
    }

    ShellProof prove() {
        countEdges();
        proof_.closed = edgesPair() && oneFanEach();
        triangulate();
        proof_.euler = euler();
        std::ranges::sort(proof_.badFaces);
        proof_.badFaces.erase(std::unique(proof_.badFaces.begin(), proof_.badFaces.end()),
                              proof_.badFaces.end());
        return proof_;
    }

private:
    void countEdges() {
        for (const uint32_t f : faces_)
            for (const auto& loop : building_.faces[f].loops)
                for (size_t i = 0; i < loop.size(); ++i) {
                    facesOf_[{loop[i], loop[(i + 1) % loop.size()]}].push_back(f);
                    vertices_.insert(loop[i]);
                }
    }

    bool edgesPair() {
        bool good = !faces_.empty();
        for (const auto& [edge, faces] : facesOf_) {
            const bool paired = faces.size() == 1 && facesOf_.contains({edge.second, edge.first});
            if (!paired) proof_.badFaces.insert(proof_.badFaces.end(), faces.begin(), faces.end());
            good = good && paired;
        }
        return good;
    }

    // Round each vertex the corners must form one ring: from an edge that comes in, through its loop, to the
    // next.
    bool oneFanEach() {
        std::map<Edge, uint32_t> after; // incoming edge -> where the loop goes on
        std::map<uint32_t, std::vector<uint32_t>> incoming;
        for (const uint32_t f : faces_)
            for (const auto& loop : building_.faces[f].loops)
                for (size_t i = 0; i < loop.size(); ++i) {
                    const uint32_t a = loop[i], b = loop[(i + 1) % loop.size()],
                                   c = loop[(i + 2) % loop.size()];
                    after[{a, b}] = c;
                    incoming[b].push_back(a);
                }
        bool good = true;
        for (const auto& [v, from] : incoming) {
            size_t steps = 0;
            uint32_t a = from[0];
            do {
                a = after.at({a, v}); // out along v -> a, back in along its opposite a -> v
                ++steps;
            } while (a != from[0] && steps <= from.size());
            if (steps == from.size()) continue;
            good = false;
            for (const uint32_t u : from)
                for (const uint32_t f : facesOf_[{u, v}]) proof_.badFaces.push_back(f);
        }
        return good;
    }

    void triangulate() {
        Mesh mesh;
        std::map<uint32_t, Mesh::Vertex_index> local;
        for (const uint32_t v : vertices_) {
            const glm::dvec3 p = building_.vertices[v];
            local[v] = mesh.add_vertex(Kernel::Point_3(p.x, p.y, p.z));
        }
        std::vector<uint32_t> owner;
        proof_.leastArea = std::numeric_limits<double>::infinity();
        const glm::dvec3 origin = vertices_.empty() ? glm::dvec3(0) : building_.vertices[*vertices_.begin()];
        for (const uint32_t f : faces_) {
            const auto pieces = triangulateFace(building_, building_.faces[f]);
            if (pieces.empty()) intersecting(f);
            for (const auto& t : pieces) {
                if (proof_.closed &&
                    mesh.add_face(local[t[0]], local[t[1]], local[t[2]]) == Mesh::null_face())
                    intersecting(f);
                else
                    owner.push_back(f);
                const glm::dvec3 a = building_.vertices[t[0]] - origin, b = building_.vertices[t[1]] - origin,
                                 c = building_.vertices[t[2]] - origin;
                proof_.volume -= glm::dot(a, glm::cross(b, c)) / 6;
                proof_.leastArea = std::min(proof_.leastArea, glm::length(glm::cross(b - a, c - a)) / 2);
            }
        }
        if (!proof_.closed) return; // what does not hang together has no inside to intersect
        std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> crossing;
        CGAL::Polygon_mesh_processing::self_intersections(mesh, std::back_inserter(crossing));
        for (const auto& [i, j] : crossing) {
            intersecting(owner[i]);
            intersecting(owner[j]);
        }
    }

    void intersecting(uint32_t face) {
        proof_.selfIntersecting = true;
        proof_.badFaces.push_back(face);
    }

    int euler() const {
        int chi = static_cast<int>(vertices_.size()) - static_cast<int>(facesOf_.size() / 2);
        for (const uint32_t f : faces_) chi += 2 - static_cast<int>(building_.faces[f].loops.size());
        return chi;
    }

    const Building& building_;
    std::vector<uint32_t> faces_;
    std::map<Edge, std::vector<uint32_t>> facesOf_;
    std::set<uint32_t> vertices_;
    ShellProof proof_;
};

} // namespace

std::vector<ShellProof> proveShells(const Building& building) {
    std::vector<ShellProof> proofs;
    for (uint32_t room = 0; room < building.roomCount; ++room)
        proofs.push_back(ShellProver(building, room).prove());
    return proofs;
}

} // namespace heliodon::geometry
