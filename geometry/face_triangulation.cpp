#include <unordered_map>

#include <glm/geometric.hpp>

#include "geometry/constrained_delaunay.h"
#include "geometry/face_soup.h"

namespace heliodon::geometry {

namespace {

// Two axes of the face's plane, the third pointing away from the viewer's air side being dropped.
std::pair<int, int> axesOf(glm::dvec3 normal) {
    const glm::dvec3 size = glm::abs(normal);
    if (size.x >= size.y && size.x >= size.z) return normal.x > 0 ? std::pair(1, 2) : std::pair(2, 1);
    if (size.y >= size.z) return normal.y > 0 ? std::pair(2, 0) : std::pair(0, 2);
    return normal.z > 0 ? std::pair(0, 1) : std::pair(1, 0);
}

} // namespace

std::vector<std::array<uint32_t, 3>> triangulateFace(const Building& building, const Face& face) {
    glm::dvec3 normal{0};
    for (const auto& loop : face.loops)
        for (size_t i = 0; i < loop.size(); ++i)
            normal += glm::cross(building.vertices[loop[i]] - building.vertices[loop[0]],
                                 building.vertices[loop[(i + 1) % loop.size()]] - building.vertices[loop[0]]);
    if (normal == glm::dvec3(0)) return {};
    if (face.loops.size() == 1 && face.loops[0].size() == 3)
        return {{face.loops[0][0], face.loops[0][1], face.loops[0][2]}};
    const auto [u, v] = axesOf(normal);

    std::vector<glm::dvec2> points;
    std::vector<uint32_t> indices; // of the building, per point
    std::vector<std::pair<uint32_t, uint32_t>> edges;
    std::unordered_map<uint32_t, uint32_t> local;
    const auto localOf = [&](uint32_t index) {
        const auto [place, isNew] = local.try_emplace(index, static_cast<uint32_t>(points.size()));
        if (isNew) {
            points.emplace_back(building.vertices[index][u], building.vertices[index][v]);
            indices.push_back(index);
        }
        return place->second;
    };
    for (const auto& loop : face.loops)
        for (size_t i = 0; i < loop.size(); ++i)
            edges.emplace_back(localOf(loop[i]), localOf(loop[(i + 1) % loop.size()]));
    std::vector<std::array<uint32_t, 3>> out;
    if (const auto net = constrainedDelaunay(points, edges))
        for (const auto& t : net->corner) out.push_back({indices[t[0]], indices[t[1]], indices[t[2]]});
    return out;
}

} // namespace heliodon::geometry
