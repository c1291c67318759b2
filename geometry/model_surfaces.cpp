#include "geometry/model_surfaces.h"

#include <cmath>
#include <map>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "geometry/disjoint_sets.h"
#include "geometry/mesh_domains.h"
#include "geometry/outline_area.h"
#include "geometry/shell_faces.h"

namespace heliodon::geometry {

namespace {

constexpr double kMostTurn = 50; // degrees: an octagon's corners may be a column's, a room's may not
constexpr double kSame = 0.1;    // of what the faces turn by: the file's normals differ by less

// Of the face's corner nearest to the place, of length one; 0 where the file gives none.
glm::dvec3 normalAt(const RawModel& model, uint32_t face, glm::dvec3 p) {
    if (model.cornerNormals.empty()) return glm::dvec3(0);
    const auto corners = model.face(face);
    size_t best = 0;
    double nearest = 1e300;
    for (size_t k = 0; k < corners.size(); ++k) {
        const double off = glm::length(model.vertices[corners[k]] - p);
        if (off < nearest) nearest = off, best = k;
    }
    const glm::dvec3 n(model.cornerNormals[model.firstCorner[face] + best]);
    const double size = glm::length(n);
    return size > 0 && std::isfinite(size) ? n / size : glm::dvec3(0);
}

// What is known of two faces at the edge between them.
struct Fold {
    glm::dvec3 normal[2], ends[2];
    uint32_t source[2];

    bool smooth(const RawModel& model) const {
        if (glm::dot(normal[0], normal[1]) < std::cos(glm::radians(kMostTurn))) return false;
        if (source[0] == source[1]) return true;
        bool anyNormal = false;
        for (const glm::dvec3 p : ends) {
            const glm::dvec3 m = normalAt(model, source[0], p), n = normalAt(model, source[1], p);
            anyNormal = anyNormal || m != glm::dvec3(0) || n != glm::dvec3(0);
            // One end is enough: at the tip of a cone each facet may have a normal of its own.
            if (m != glm::dvec3(0) && n != glm::dvec3(0) &&
                glm::length(m - n) <= kSame * glm::length(normal[0] - normal[1]))
                return true;
        }
        return !anyNormal && !model.smoothing.empty() && model.smoothing[source[0]] != 0 &&
               model.smoothing[source[0]] == model.smoothing[source[1]];
    }
};

} // namespace

void findSurfaces(Building& building, const RawModel& model, std::span<const uint32_t> source) {
    DisjointSets surfaces(building.faces.size());
    std::vector<glm::dvec3> normals;
    for (const Face& face : building.faces) normals.push_back(faceNormal(building, face));
    for (const auto& [edge, faces] : facesOfEdges(building)) {
        if (faces.size() < 2) continue;
        const Face &a = building.faces[faces[0]], &b = building.faces[faces[1]];
        if (a.material != b.material) continue;
        const auto [p, q] = edge;
        const Fold fold{{normals[faces[0]], normals[faces[1]]},
                        {building.vertices[p], building.vertices[q]},
                        {source[faces[0]], source[faces[1]]}};
        // Panes stay flat: each is a window.
        const bool pane = model.materials[a.material].isOpening();
        if (inOnePlane(fold.normal[0], fold.normal[1]) || (!pane && fold.smooth(model)))
            surfaces.join(faces[0], faces[1]);
    }
    std::map<uint32_t, uint32_t> ids;
    for (uint32_t f = 0; f < building.faces.size(); ++f)
        building.faces[f].surface =
            ids.try_emplace(surfaces.root(f), static_cast<uint32_t>(ids.size())).first->second;
}

} // namespace heliodon::geometry
