#include "engine/passes/frame_light.h"

#include <algorithm>
#include <utility>

#include <glm/geometric.hpp>

#include "engine/passes/weighted_quantile.h"
#include "shaders/io/display.io.h"

namespace heliodon::passes {

double autoWhite(const geometry::PatchMesh& mesh, const compute::Lighting& light) {
    const std::vector<glm::vec3> indirect = indirectExitance(mesh, light);
    std::vector<std::pair<double, double>> luxAndArea;
    double total = 0;
    for (size_t p = 0; p < mesh.patchCount(); ++p) {
        if (mesh.role[p] != geometry::Role::projection || mesh.materials[mesh.material[p]].isOpening())
            continue;
        const double area = geometry::patchArea(mesh, p);
        luxAndArea.emplace_back(glm::dot(indirect[p], io::kLuminance), area);
        total += area;
    }
    std::sort(luxAndArea.begin(), luxAndArea.end());
    return luxAndArea.empty() ? 1 : std::max(weightedQuantile(luxAndArea, total, 0.95), kLeastWhite);
}

std::vector<glm::vec3> pictureLight(const geometry::PatchMesh& mesh, const compute::Lighting& light) {
    std::vector<glm::vec3> values = indirectExitance(mesh, light);
    const bool lamps = std::any_of(mesh.materials.begin(), mesh.materials.end(),
                                   [](const auto& m) { return glm::dot(m.exitance, glm::vec3(1)) > 0; });
    const bool lit =
        std::any_of(values.begin(), values.end(), [](glm::vec3 v) { return glm::dot(v, v) > 0; });
    // Light without lamps has come through the openings, so it is day.
    const bool day = (lit && !lamps) || glm::dot(light.sunNormalIlluminance, glm::vec3(1)) > 0;
    if (!day) return values;
    const glm::vec3 sky = static_cast<float>(autoWhite(mesh, light)) * glm::vec3(0.75f, 0.88f, 1.0f);
    for (size_t p = 0; p < values.size(); ++p)
        if (const geometry::Material& m = mesh.materials[mesh.material[p]];
            m.isOpening() && m.blind.kind == geometry::Blind::Kind::none)
            values[p] = glm::max(values[p], sky);
    return values;
}

void markOpenings(const FrameScene& scene, std::vector<glm::vec3>& perVertex) {
    const geometry::PatchMesh& mesh = scene.mesh;
    constexpr float kUnknown = -1e7f; // lux; below zero with any sun on it
    for (size_t p = 0; p < mesh.patchCount(); ++p)
        if (mesh.materials[mesh.material[p]].isOpening())
            for (uint32_t c = mesh.firstCorner[p]; c < mesh.firstCorner[p + 1]; ++c)
                perVertex[scene.vertexLight.ofCorner(c)] = glm::vec3(kUnknown);
}

std::vector<float> shownLux(const geometry::PatchMesh& mesh, const compute::Lighting& light) {
    std::vector<float> lux;
    const std::vector<glm::vec3> indirect = indirectIlluminance(mesh, light);
    for (size_t p = 0; p < indirect.size(); ++p)
        if (mesh.role[p] == geometry::Role::projection)
            lux.push_back(glm::dot(
                indirect[p] + (light.sunIlluminance.empty() ? glm::vec3(0) : light.sunIlluminance[p]),
                io::kLuminance));
    return lux;
}

} // namespace heliodon::passes
