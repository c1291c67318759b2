#include "engine/passes/projector_share.h"

#include <cassert>
#include <vector>

#include <glm/geometric.hpp>

#include "engine/passes/projector_light.h"
#include "geometry/projector_visibility.h"

namespace heliodon::passes {

using geometry::ProjectorMesh;

std::vector<uint32_t> ShownMesh::cornersSeenBy(size_t projector) const {
    std::vector<uint32_t> corners;
    for (uint32_t c = 0; c < mesh.corners.size(); ++c)
        if (blend.sees(projector, c / 3)) corners.push_back(c);
    return corners;
}

ShownMesh shownMesh(const geometry::PatchMesh& mesh, const VertexLight& vertexLight,
                    const geometry::Occluders& occluders, const geometry::Rig& rig) {
    const std::vector<geometry::OpticalDevice> devices(rig.projectors.begin(), rig.projectors.end());
    assert(devices.size() <= geometry::kMostProjectors);
    const ProjectorMesh cut = geometry::splitByProjectorVisibility(mesh, occluders, devices);
    DrawMesh out;
    out.patch = cut.sourcePatch;
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
                mean += double{mix.weight[static_cast<int>(s)]} * vertexLight.normal(mix.pair[s]);
            }
            if (!(glm::length(mean) > 0.5)) mean = normal;
            out.light.push_back(mix);
            out.cornerPatch.push_back(cut.vertexPatch[v]);
            out.corners.push_back({glm::vec3(cut.vertices[v]), glm::vec3(normal), reflectance,
                                   glm::vec3(glm::normalize(mean))});
        }
    }
    std::vector<glm::dvec3> centres;
    for (const geometry::OpticalDevice& device : devices) centres.push_back(device.centre());
    ShownMesh shown{std::move(out), geometry::blendProjectors(cut, mesh, centres)};
    for (size_t p = 0; p < rig.projectors.size(); ++p)
        shown.blend.candela[p] = fullIntensity(rig.projectors[p]);
    return shown;
}

} // namespace heliodon::passes
