#include "geometry/patch_mesh.h"

#include <cmath>

#include <glm/geometric.hpp>

#include "geometry/outline_area.h"

namespace heliodon::geometry {

void PatchMesh::addPatch(std::span<const uint32_t> indices, uint32_t materialIndex, Role r,
                         uint32_t surfaceId, uint32_t roomId) {
    corners.insert(corners.end(), indices.begin(), indices.end());
    firstCorner.push_back(static_cast<uint32_t>(corners.size()));
    material.push_back(materialIndex);
    role.push_back(r);
    surface.push_back(surfaceId);
    room.push_back(roomId);
    twin.push_back(kNoTwin);
}

std::vector<glm::dvec3> patchCorners(const PatchMesh& mesh, size_t patch) {
    std::vector<glm::dvec3> result;
    result.reserve(mesh.patch(patch).size());
    for (const uint32_t v : mesh.patch(patch)) result.push_back(mesh.vertices[v]);
    return result;
}

glm::dvec3 patchAreaVector(const PatchMesh& mesh, size_t patch) {
    return areaVector(mesh.vertices, mesh.patch(patch));
}

double patchArea(const PatchMesh& mesh, size_t patch) {
    return 0.5 * glm::length(patchAreaVector(mesh, patch));
}

glm::dvec3 patchNormal(const PatchMesh& mesh, size_t patch) {
    return glm::normalize(patchAreaVector(mesh, patch));
}

glm::dvec3 patchCentroid(const PatchMesh& mesh, size_t patch) {
    const auto corner = mesh.patch(patch);
    const glm::dvec3 origin = mesh.vertices[corner[0]];
    const glm::dvec3 normal = patchAreaVector(mesh, patch);
    glm::dvec3 sum{0};
    double weight = 0;
    for (size_t k = 1; k + 1 < corner.size(); ++k) {
        const glm::dvec3 u = mesh.vertices[corner[k]] - origin, v = mesh.vertices[corner[k + 1]] - origin;
        const double twiceArea = glm::dot(glm::cross(u, v), normal);
        sum += twiceArea * (u + v) / 3.0;
        weight += twiceArea;
    }
    return weight > 0 ? origin + sum / weight : origin;
}

double heightAt(const PatchMesh& mesh, size_t patch, double x, double z, double slack) {
    const auto corners = mesh.patch(patch);
    const glm::dvec3 normal = patchNormal(mesh, patch);
    const double sign = normal.y > 0 ? 1 : -1;
    for (size_t k = 0; k < corners.size(); ++k) {
        const glm::dvec3 a = mesh.vertices[corners[k]], b = mesh.vertices[corners[(k + 1) % corners.size()]];
        // Seen from above x is right and z down: counter-clockwise about +y.
        const double side = (b.z - a.z) * (x - a.x) - (b.x - a.x) * (z - a.z);
        if (sign * side < -slack) return std::nan("");
    }
    const glm::dvec3 p = mesh.vertices[corners[0]];
    return p.y - (normal.x * (x - p.x) + normal.z * (z - p.z)) / normal.y;
}

} // namespace heliodon::geometry
