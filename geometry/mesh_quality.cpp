#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include <glm/geometric.hpp>

#include "geometry/mesher.h"

namespace heliodon::geometry {

MeshQuality measureMesh(const PatchMesh& mesh) {
    MeshQuality quality;
    quality.triangles = mesh.patchCount();
    quality.minAngleDeg = quality.minAngleAllDeg = 180;
    // The angle of the surface itself at each of its vertices: where that is sharp, no mesh can do better.
    std::map<std::pair<uint32_t, uint32_t>, double> whole;
    const auto angle = [&](size_t i, size_t k) {
        const auto corner = mesh.patch(i);
        const size_t n = corner.size();
        const glm::dvec3 p = mesh.vertices[corner[k]];
        const glm::dvec3 a = mesh.vertices[corner[(k + 1) % n]] - p,
                         b = mesh.vertices[corner[(k + n - 1) % n]] - p;
        return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / std::numbers::pi;
    };
    double sum = 0, squares = 0;
    std::map<std::tuple<uint32_t, uint32_t, uint32_t>, int> sides; // of edges, per surface: 1 on its border
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const auto corner = mesh.patch(i);
        for (size_t k = 0; k < corner.size(); ++k) {
            whole[{mesh.surface[i], corner[k]}] += angle(i, k);
            const auto [a, b] = std::minmax(corner[k], corner[(k + 1) % corner.size()]);
            ++sides[{mesh.surface[i], a, b}];
        }
        const double area = patchArea(mesh, i);
        sum += area;
        squares += area * area;
    }
    std::set<std::pair<uint32_t, uint32_t>> border; // vertices, by surface
    for (const auto& [key, count] : sides)
        if (count == 1) {
            border.insert({std::get<0>(key), std::get<1>(key)});
            border.insert({std::get<0>(key), std::get<2>(key)});
        }
    constexpr double kSharp = 72;  // degrees: less cannot be divided into two angles of 36
    constexpr double kStrip = 0.5; // of the edge length of a mean triangle
    const double edge = std::sqrt(4 / std::sqrt(3.0) * sum / static_cast<double>(mesh.patchCount()));
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        bool sharp = false, inStrip = mesh.patch(i).size() == 3;
        double least = 180, longest = 0;
        for (size_t k = 0; k < mesh.patch(i).size(); ++k) {
            const std::pair key(mesh.surface[i], mesh.patch(i)[k]);
            sharp = sharp || whole[key] < kSharp;
            inStrip = inStrip && border.contains(key);
            least = std::min(least, angle(i, k));
            longest =
                std::max(longest, glm::length(mesh.vertices[mesh.patch(i)[(k + 1) % mesh.patch(i).size()]] -
                                              mesh.vertices[mesh.patch(i)[k]]));
        }
        quality.minAngleAllDeg = std::min(quality.minAngleAllDeg, least);
        inStrip = inStrip && 2 * patchArea(mesh, i) / longest < kStrip * edge;
        quality.stripTriangles += inStrip;
        if (!sharp && !inStrip) quality.minAngleDeg = std::min(quality.minAngleDeg, least);
    }
    const auto n = static_cast<double>(mesh.patchCount());
    if (n > 0)
        quality.areaDeviation = std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n))) / (sum / n);
    return quality;
}

} // namespace heliodon::geometry
