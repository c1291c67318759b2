#include "geometry/projector_blend.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>

#include <glm/geometric.hpp>

namespace heliodon::geometry {

namespace {

constexpr uint32_t kUnreached = 0xffffffffu;

// Where no projector sees all triangles round a vertex, each set of projectors gets its own copy of it:
// better a seam between them than a dark spot.
void splitSeams(ProjectorMesh& mesh, std::vector<uint32_t>& common) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> copies;
    for (size_t t = 0; t < mesh.triangleCount(); ++t)
        for (size_t k = 0; k < 3 && mesh.visible[t]; ++k) {
            uint32_t& v = mesh.triangles[3 * t + k];
            if (common[v] != 0) continue;
            const auto [place, isNew] =
                copies.try_emplace({v, mesh.visible[t]}, static_cast<uint32_t>(mesh.vertices.size()));
            if (isNew) {
                mesh.vertices.push_back(glm::dvec3(mesh.vertices[v]));
                mesh.sourceVertex.push_back(std::array<uint32_t, 3>(mesh.sourceVertex[v]));
                mesh.sourceWeight.push_back(glm::vec3(mesh.sourceWeight[v]));
                common.push_back(mesh.visible[t]);
            }
            v = place->second;
        }
}

// The vertices at the other ends of visible triangles' edges, as lists one after the other.
struct Neighbours {
    explicit Neighbours(const ProjectorMesh& mesh) : first(mesh.vertices.size() + 1, 0) {
        for (size_t t = 0; t < mesh.triangleCount(); ++t)
            for (size_t k = 0; k < 3 && mesh.visible[t]; ++k) first[mesh.triangles[3 * t + k] + 1] += 2;
        for (size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
        vertices.resize(first.back());
        std::vector<uint32_t> at(first.begin(), first.end() - 1);
        for (size_t t = 0; t < mesh.triangleCount(); ++t)
            for (size_t k = 0; k < 3 && mesh.visible[t]; ++k) {
                const uint32_t v = mesh.triangles[3 * t + k];
                vertices[at[v]++] = mesh.triangles[3 * t + (k + 1) % 3];
                vertices[at[v]++] = mesh.triangles[3 * t + (k + 2) % 3];
            }
    }
    std::vector<uint32_t> first, vertices;
};

// Along edges of the mesh (Dijkstra with the fade's length as limit), from vertices of a surface that p does
// not see.
std::vector<double> distanceFromDark(const ProjectorMesh& mesh, const std::vector<uint32_t>& common, size_t p,
                                     const Neighbours& around, double falloff) {
    std::vector<double> distance(mesh.vertices.size(), std::numeric_limits<double>::infinity());
    std::vector<uint32_t> dark;
    for (uint32_t v = 0; v < mesh.vertices.size(); ++v)
        if (common[v] != kUnreached && !(common[v] >> p & 1u)) {
            distance[v] = 0;
            dark.push_back(v);
        }
    std::priority_queue<std::pair<double, uint32_t>, std::vector<std::pair<double, uint32_t>>, std::greater<>>
        front;
    const auto pass = [&](uint32_t v, double d) {
        for (uint32_t i = around.first[v]; i < around.first[v + 1]; ++i) {
            const uint32_t w = around.vertices[i];
            if (distance[w] <= d) continue;
            const double through = d + glm::length(mesh.vertices[w] - mesh.vertices[v]);
            if (through >= distance[w]) continue;
            distance[w] = through;
            front.emplace(through, w);
        }
    };
    for (const uint32_t v : dark) pass(v, 0);
    while (!front.empty()) {
        const auto [d, v] = front.top();
        front.pop();
        if (d > falloff) break;
        if (d <= distance[v]) pass(v, d);
    }
    return distance;
}

} // namespace

void blendProjectors(ProjectorMesh& mesh, std::span<const OpticalDevice> projectors,
                     std::span<const glm::dvec3> normals, double falloff) {
    const size_t count = projectors.size();
    std::vector<uint32_t> common(mesh.vertices.size(), kUnreached);
    for (size_t t = 0; t < mesh.triangleCount(); ++t)
        if (mesh.visible[t])
            for (size_t k = 0; k < 3; ++k) common[mesh.triangles[3 * t + k]] &= mesh.visible[t];
    splitSeams(mesh, common);
    mesh.weights.assign(mesh.vertices.size() * count, 0);
    std::vector<glm::dvec3> normal(mesh.vertices.size());
    for (size_t t = 0; t < mesh.triangleCount(); ++t)
        for (size_t k = 0; k < 3; ++k) normal[mesh.triangles[3 * t + k]] = normals[t];
    const Neighbours around(mesh);
    for (size_t p = 0; p < count; ++p) {
        const std::vector<double> distance = distanceFromDark(mesh, common, p, around, falloff);
        for (size_t v = 0; v < mesh.vertices.size(); ++v) {
            if (common[v] == kUnreached || !(common[v] >> p & 1u)) continue;
            const glm::dvec3 d = projectors[p].centre() - mesh.vertices[v];
            const double square = glm::dot(d, d), cosine = glm::dot(d, normal[v]) / std::sqrt(square);
            const double fade = std::clamp(distance[v] / falloff, 0.02, 1.0);
            mesh.weights[v * count + p] =
                static_cast<float>(fade * fade * (3 - 2 * fade) * std::max(cosine, 1e-3) / square);
        }
    }
    for (size_t v = 0; v < mesh.vertices.size(); ++v) {
        float sum = 0;
        for (size_t p = 0; p < count; ++p) sum += mesh.weights[v * count + p];
        for (size_t p = 0; p < count && sum > 0; ++p) mesh.weights[v * count + p] /= sum;
    }
}

} // namespace heliodon::geometry
