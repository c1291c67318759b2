#include "engine/passes/draw_mesh.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <glm/geometric.hpp>

namespace heliodon::passes {

namespace {

using geometry::PatchMesh;

struct Triangles {
    std::vector<glm::dvec3> corners;

    // Whether anything lies strictly between two points.
    bool between(glm::dvec3 from, glm::dvec3 to) const {
        const glm::dvec3 d = to - from;
        for (size_t i = 0; i < corners.size(); i += 3) {
            const glm::dvec3 e1 = corners[i + 1] - corners[i], e2 = corners[i + 2] - corners[i];
            const glm::dvec3 p = glm::cross(d, e2);
            const double determinant = glm::dot(e1, p);
            if (std::abs(determinant) < 1e-18) continue;
            const glm::dvec3 s = from - corners[i], q = glm::cross(s, e1);
            const double u = glm::dot(s, p) / determinant, v = glm::dot(d, q) / determinant;
            const double t = glm::dot(e2, q) / determinant;
            if (u >= 0 && v >= 0 && u + v <= 1 && t > 0 && t < 1) return true;
        }
        return false;
    }
};

Triangles physicalTriangles(const PatchMesh& mesh, const geometry::Occluders& occluders) {
    Triangles all;
    for (uint32_t v : occluders.triangles) all.corners.push_back(occluders.vertices[v]);
    if (!all.corners.empty()) return all;
    for (size_t p = 0; p < mesh.patchCount(); ++p) {
        if (mesh.role[p] != geometry::Role::projection) continue;
        const auto corner = mesh.patch(p);
        for (size_t k = 1; k + 1 < corner.size(); ++k)
            for (uint32_t v : {corner[0], corner[k], corner[k + 1]}) all.corners.push_back(mesh.vertices[v]);
    }
    return all;
}

constexpr double kGrazingLimit = 0.2;

bool sees(const geometry::Projector& projector, const Triangles& blockers, glm::dvec3 point,
          glm::dvec3 normal, double lift) {
    const glm::dvec3 towards = projector.centre() - point;
    if (glm::dot(normal, towards) <= kGrazingLimit * glm::length(towards)) return false;
    const auto pixel = projector.pixelFromWorld(point);
    if (!pixel || pixel->x < 0 || pixel->y < 0 || pixel->x > projector.width - 1 ||
        pixel->y > projector.height - 1)
        return false;
    return !blockers.between(point + lift * normal, projector.centre());
}

void addPatch(DrawMesh& out, const PatchMesh& mesh, const VertexLight& vertexLight, size_t patch,
              const std::function<void(uint32_t)>& onCorner) {
    const glm::vec3 normal(geometry::patchNormal(mesh, patch));
    const glm::vec3 reflectance = mesh.materials[mesh.material[patch]].reflectance;
    const uint32_t first = mesh.firstCorner[patch];
    for (uint32_t c = first + 1; c + 1 < mesh.firstCorner[patch + 1]; ++c)
        for (uint32_t corner : {first, c, c + 1}) {
            const uint32_t pair = vertexLight.ofCorner(corner);
            out.corners.push_back({glm::vec3(mesh.vertices[mesh.corners[corner]]), normal, reflectance});
            out.light.push_back({{pair, pair, pair}, {1, 0, 0}});
            onCorner(pair);
        }
}

// Per pair and projector: 1 where every neighbouring triangle is seen, weighted towards the projector that
// lights the place best.
std::vector<std::vector<float>> sharesAtVertices(const PatchMesh& mesh, const VertexLight& vertexLight,
                                                 const geometry::Occluders& occluders,
                                                 const geometry::Rig& rig) {
    const Triangles blockers = physicalTriangles(mesh, occluders);
    std::vector<std::vector<float>> share(rig.projectors.size(), std::vector<float>(vertexLight.size()));
    std::vector<float> total(vertexLight.size());
    for (size_t i = 0; i < rig.projectors.size(); ++i) {
        std::vector<bool> all(vertexLight.size(), true);
        std::vector<float> strength(vertexLight.size());
        for (size_t p = 0; p < mesh.patchCount(); ++p) {
            if (mesh.role[p] != geometry::Role::projection) continue;
            const glm::dvec3 centroid = geometry::patchCentroid(mesh, p),
                             normal = geometry::patchNormal(mesh, p);
            const bool seen = sees(rig.projectors[i], blockers, centroid, normal, 1e-3);
            const glm::dvec3 towards = rig.projectors[i].centre() - centroid;
            const double r = glm::length(towards), cosine = glm::dot(towards, normal) / r;
            for (uint32_t c = mesh.firstCorner[p]; c < mesh.firstCorner[p + 1]; ++c) {
                const uint32_t pair = vertexLight.ofCorner(c);
                if (!seen) all[pair] = false;
                strength[pair] = static_cast<float>(std::max(cosine, 0.0) / (r * r));
            }
        }
        for (size_t pair = 0; pair < all.size(); ++pair) {
            share[i][pair] = all[pair] ? strength[pair] : 0;
            total[pair] += share[i][pair];
        }
    }
    for (auto& list : share)
        for (size_t pair = 0; pair < list.size(); ++pair)
            if (total[pair] > 0) list[pair] /= total[pair];
    return share;
}

} // namespace

void DrawMesh::mixLight(std::span<const glm::vec3> luxPerPair, float scale, std::span<glm::vec3> out) const {
    for (size_t i = 0; i < light.size(); ++i) {
        const LightMix& mix = light[i];
        out[i] = scale * (mix.weight.x * luxPerPair[mix.pair[0]] + mix.weight.y * luxPerPair[mix.pair[1]] +
                          mix.weight.z * luxPerPair[mix.pair[2]]);
    }
}

DrawMesh drawMesh(const PatchMesh& mesh, const VertexLight& vertexLight) {
    DrawMesh out;
    for (size_t p = 0; p < mesh.patchCount(); ++p) addPatch(out, mesh, vertexLight, p, [](uint32_t) {});
    return out;
}

DrawMesh shownMesh(const PatchMesh& mesh, const VertexLight& vertexLight,
                   const geometry::Occluders& occluders, const geometry::Rig& rig) {
    DrawMesh out;
    out.share.resize(rig.projectors.size());
    const auto shares = sharesAtVertices(mesh, vertexLight, occluders, rig);
    for (size_t p = 0; p < mesh.patchCount(); ++p)
        if (mesh.role[p] == geometry::Role::projection)
            addPatch(out, mesh, vertexLight, p, [&](uint32_t pair) {
                for (size_t i = 0; i < shares.size(); ++i) out.share[i].push_back(shares[i][pair]);
            });
    return out;
}

std::vector<DrawCorner> drawSolids(const geometry::Occluders& occluders) {
    std::vector<DrawCorner> corners;
    for (size_t i = 0; i + 2 < occluders.triangles.size(); i += 3) {
        const glm::dvec3 &a = occluders.vertices[occluders.triangles[i]],
                         &b = occluders.vertices[occluders.triangles[i + 1]],
                         &c = occluders.vertices[occluders.triangles[i + 2]];
        const glm::dvec3 normal = glm::cross(b - a, c - a);
        const double length = glm::length(normal);
        if (!(length > 0)) continue;
        for (const glm::dvec3& p : {a, b, c})
            corners.push_back({glm::vec3(p), glm::vec3(normal / length), glm::vec3(0)});
    }
    return corners;
}

std::vector<DrawCorner> drawDisc(glm::dvec3 centre, double radius) {
    std::vector<DrawCorner> corners;
    constexpr int kSides = 128;
    const auto rim = [&](int i) {
        const double angle = 2 * std::numbers::pi * i / kSides;
        return glm::vec3(centre + radius * glm::dvec3(std::cos(angle), 0, -std::sin(angle)));
    };
    for (int i = 0; i < kSides; ++i)
        for (const glm::vec3& p : {glm::vec3(centre), rim(i), rim(i + 1)})
            corners.push_back({p, {0, 1, 0}, glm::vec3(0)});
    return corners;
}

} // namespace heliodon::passes
