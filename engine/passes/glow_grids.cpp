#include "engine/passes/glow_grids.h"

#include <algorithm>

#include "geometry/projector_visibility.h"

namespace heliodon::passes {

namespace {

bool isOnTriangle(glm::vec2 place) {
    constexpr float kBeside = 1e-3f;
    return place.x > -kBeside && place.y > -kBeside && place.x + place.y < 1 + kBeside;
}

} // namespace

GlowGrids::GlowGrids(const geometry::PatchMesh& mesh, const VertexLight& vertexLight,
                     std::span<const compute::PatchGlow> grids, std::span<const glm::vec3> perLux)
    : mesh_(mesh), perLux_(perLux), gridOf_(mesh.patchCount()), atPair_(vertexLight.size(), glm::vec3(0)) {
    constexpr std::array<size_t, 3> kCorners{0, compute::PatchGlow::kCells, io::kGlowPlaces - 1};
    for (const compute::PatchGlow& grid : grids) {
        gridOf_[grid.patch] = &grid;
        for (uint32_t k = 0; k < 3; ++k)
            atPair_[vertexLight.ofCorner(mesh.firstCorner[grid.patch] + k)] =
                perLux[grid.patch] * grid.lux[kCorners[k]];
    }
}

std::optional<GlowGrids::OnTriangle> GlowGrids::on(const DrawMesh& drawn, size_t triangle) const {
    OnTriangle out;
    const uint32_t patch = drawn.patch[triangle];
    if (drawn.cornerPatch.empty() && !gridOf_[patch]) return std::nullopt;
    const TrianglePlaces places(mesh_, patch);
    for (size_t k = 0; k < 3; ++k) out.at[k] = places.of(drawn.corners[3 * triangle + k].position);
    if (drawn.cornerPatch.empty() || std::ranges::all_of(out.at, isOnTriangle)) {
        if (!gridOf_[patch]) return std::nullopt;
        for (size_t k = 0; k < out.light.size(); ++k) out.light[k] = perLux_[patch] * gridOf_[patch]->lux[k];
        return out;
    }
    const glm::vec3 a = atCorner(drawn, 3 * triangle), b = atCorner(drawn, 3 * triangle + 1),
                    c = atCorner(drawn, 3 * triangle + 2);
    if (a == glm::vec3(0) && b == a && c == a) return std::nullopt;
    return OnTriangle{{{{0, 0}, {1, 0}, {0, 1}}}, compute::PatchGlow::places(a, b, c)};
}

glm::vec3 GlowGrids::atCorner(const DrawMesh& drawn, size_t corner) const {
    const uint32_t patch = drawn.cornerPatch[corner];
    if (patch == geometry::ProjectorMesh::kCorner) return atPair_[drawn.light[corner].pair[0]];
    if (!gridOf_[patch]) return glm::vec3(0);
    return perLux_[patch] *
           gridOf_[patch]->at(TrianglePlaces(mesh_, patch).of(drawn.corners[corner].position));
}

} // namespace heliodon::passes
