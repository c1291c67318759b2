#include "engine/passes/projector_share.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <glm/geometric.hpp>

#include "geometry/projector_visibility.h"

namespace heliodon::passes {

namespace {

using geometry::ProjectorMesh;

// The weight of a projector that sees a triangle, beside shares that sum to one: it decides only where there
// are none.
constexpr double kLastResort = 1e-3;

// Per pair of VertexLight: the mean normal of the surface's patches there, weighted by area.
std::vector<glm::dvec3> smoothNormals(const geometry::PatchMesh& mesh, const VertexLight& vertexLight) {
    std::vector<glm::dvec3> normals(vertexLight.size(), glm::dvec3(0));
    for (size_t p = 0; p < mesh.patchCount(); ++p)
        for (uint32_t c = mesh.firstCorner[p]; c < mesh.firstCorner[p + 1]; ++c)
            normals[vertexLight.ofCorner(c)] += geometry::patchAreaVector(mesh, p);
    return normals;
}

} // namespace

DrawMesh shownMesh(const geometry::PatchMesh& mesh, const VertexLight& vertexLight,
                   const geometry::Occluders& occluders, const geometry::Rig& rig) {
    const std::vector<geometry::OpticalDevice> devices(rig.projectors.begin(), rig.projectors.end());
    const size_t count = devices.size();
    assert(count <= geometry::kMostProjectors);
    const ProjectorMesh cut = geometry::splitByProjectorVisibility(mesh, occluders, devices);
    const std::vector<glm::dvec3> smooth = smoothNormals(mesh, vertexLight);
    DrawMesh out;
    out.share.resize(rig.projectors.size());
    for (size_t t = 0; t < cut.triangleCount(); ++t) {
        const uint32_t patch = cut.sourcePatch[t];
        const glm::dvec3 normal = geometry::patchNormal(mesh, patch);
        const glm::vec3 reflectance = mesh.materials[mesh.material[patch]].reflectance;
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t v = cut.triangles[3 * t + k];
            LightMix mix{{}, cut.sourceWeight[v]};
            glm::dvec3 mean(0);
            for (size_t s = 0; s < 3; ++s) {
                mix.pair[s] = vertexLight.pairOf(cut.sourceVertex[v][s], mesh.surface[patch]);
                const glm::dvec3& part = smooth[mix.pair[s]];
                if (glm::length(part) > 0)
                    mean += double{mix.weight[static_cast<int>(s)]} * glm::normalize(part);
            }
            if (!(glm::length(mean) > 0.5)) mean = normal;
            out.light.push_back(mix);
            out.corners.push_back({glm::vec3(cut.vertices[v]), glm::vec3(normal), reflectance,
                                   glm::vec3(glm::normalize(mean))});
            std::array<double, geometry::kMostProjectors> weight{};
            double total = 0;
            for (size_t i = 0; i < count; ++i) {
                if (!(cut.visible[t] >> i & 1)) continue;
                const glm::dvec3 towards = rig.projectors[i].centre() - cut.vertices[v];
                const double r2 = glm::dot(towards, towards),
                             facing = std::max(0.1, glm::dot(normal, towards) / std::sqrt(r2));
                weight[i] = double{cut.weights[v * cut.projectorCount + i]} + kLastResort * facing / r2;
                total += weight[i];
            }
            for (size_t i = 0; i < rig.projectors.size(); ++i)
                out.share[i].push_back(total > 0 && i < count ? static_cast<float>(weight[i] / total) : 0.0f);
        }
    }
    return out;
}

void handOverShares(DrawMesh& shown, const std::vector<bool>& dark) {
    for (size_t corner = 0; corner < shown.corners.size(); ++corner) {
        double lit = 0;
        for (size_t i = 0; i < dark.size(); ++i)
            if (!dark[i]) lit += double{shown.share[i][corner]};
        for (size_t i = 0; i < dark.size(); ++i) {
            float& share = shown.share[i][corner];
            share = dark[i] || !(lit > 0) ? 0 : static_cast<float>(double{share} / lit);
        }
    }
}

} // namespace heliodon::passes
