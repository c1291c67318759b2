#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <unordered_map>
#include <vector>

#include <glm/geometric.hpp>

#include "geometry/mesher.h"

namespace heliodon::geometry {

namespace {

double angleAt(const PatchMesh& mesh, size_t i, size_t k) {
    const auto corner = mesh.patch(i);
    const size_t n = corner.size();
    const glm::dvec3 p = mesh.vertices[corner[k]];
    const glm::dvec3 a = mesh.vertices[corner[(k + 1) % n]] - p,
                     b = mesh.vertices[corner[(k + n - 1) % n]] - p;
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / std::numbers::pi;
}

// What is meshed in one go: parts of a surface of one material and one role. Their borders are edges of the
// input.
std::vector<uint32_t> partOfPatch(const PatchMesh& mesh) {
    std::vector<uint32_t> part;
    part.reserve(mesh.patchCount());
    std::map<std::tuple<uint32_t, uint32_t, Role>, uint32_t> known;
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        part.push_back(known
                           .try_emplace({mesh.surface[i], mesh.material[i], mesh.role[i]},
                                        static_cast<uint32_t>(known.size()))
                           .first->second);
    return part;
}

// Vertices of parts: one in a corner of the building is as many as parts meet there.
struct PartVertices {
    explicit PartVertices(const PatchMesh& mesh) {
        std::unordered_map<uint64_t, uint32_t> known;
        known.reserve(mesh.corners.size());
        const std::vector<uint32_t> part = partOfPatch(mesh);
        std::vector<uint64_t> sides;
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            const auto corner = mesh.patch(i);
            const size_t first = vertex.size(), n = corner.size();
            for (size_t k = 0; k < n; ++k) {
                const uint64_t key = uint64_t{part[i]} << 32u | corner[k];
                vertex.push_back(known.try_emplace(key, static_cast<uint32_t>(known.size())).first->second);
                angle.push_back(angleAt(mesh, i, k));
            }
            for (size_t k = 0; k < n; ++k) {
                const auto [a, b] = std::minmax(vertex[first + k], vertex[first + (k + 1) % n]);
                sides.push_back(uint64_t{a} << 32u | b);
            }
        }
        whole.assign(known.size(), 0);
        for (size_t c = 0; c < vertex.size(); ++c) whole[vertex[c]] += angle[c];
        onBorder.assign(known.size(), false);
        std::ranges::sort(sides);
        for (size_t s = 0; s < sides.size(); ++s) {
            if ((s > 0 && sides[s - 1] == sides[s]) || (s + 1 < sides.size() && sides[s + 1] == sides[s]))
                continue;
            onBorder[sides[s] >> 32u] = onBorder[sides[s] & 0xffffffffu] = true;
        }
    }

    std::vector<uint32_t> vertex; // per corner of a patch, one patch after the other
    std::vector<double> angle;    // degrees, likewise
    std::vector<double> whole;    // per vertex: the angle of the part itself there
    std::vector<bool> onBorder;   // per vertex
};

} // namespace

MeshQuality measureMesh(const PatchMesh& mesh) {
    MeshQuality quality;
    quality.triangles = mesh.patchCount();
    quality.minAngleDeg = quality.minAngleAllDeg = 180;
    double sum = 0, squares = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const double area = patchArea(mesh, i);
        sum += area;
        squares += area * area;
    }
    const PartVertices vertices(mesh);
    constexpr double kStrip = 0.5; // of the edge length of a mean triangle
    const double edge = std::sqrt(4 / std::sqrt(3.0) * sum / static_cast<double>(mesh.patchCount()));
    for (size_t i = 0, first = 0; i < mesh.patchCount(); first += mesh.patch(i++).size()) {
        const auto corner = mesh.patch(i);
        bool sharp = false, inStrip = corner.size() == 3; // where the part is sharp, no mesh can do better
        double least = 180, longest = 0;
        for (size_t k = 0; k < corner.size(); ++k) {
            const uint32_t v = vertices.vertex[first + k];
            sharp = sharp || vertices.whole[v] < kSharpCorner;
            inStrip = inStrip && vertices.onBorder[v];
            least = std::min(least, vertices.angle[first + k]);
            longest = std::max(longest, glm::length(mesh.vertices[corner[(k + 1) % corner.size()]] -
                                                    mesh.vertices[corner[k]]));
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
