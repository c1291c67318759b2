#include "engine/passes/draw_mesh.h"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace heliodon::passes {

using geometry::PatchMesh;

double DrawMesh::area(size_t triangle) const {
    const glm::dvec3 a(corners[3 * triangle].position), b(corners[3 * triangle + 1].position),
        c(corners[3 * triangle + 2].position);
    return 0.5 * glm::length(glm::cross(b - a, c - a));
}

std::vector<glm::vec3> DrawMesh::positions(std::span<const uint32_t> some) const {
    std::vector<glm::vec3> out;
    for (const uint32_t corner : some) out.push_back(corners[corner].position);
    return out;
}

void DrawMesh::mixLight(std::span<const glm::vec3> luxPerPair, float scale, std::span<glm::vec3> out) const {
    for (size_t i = 0; i < light.size(); ++i) {
        const LightMix& mix = light[i];
        out[i] = scale * (mix.weight.x * luxPerPair[mix.pair[0]] + mix.weight.y * luxPerPair[mix.pair[1]] +
                          mix.weight.z * luxPerPair[mix.pair[2]]);
    }
}

TrianglePlaces::TrianglePlaces(const PatchMesh& mesh, uint32_t patch) {
    const std::vector<glm::dvec3> corner = geometry::patchCorners(mesh, patch);
    const glm::dvec3 a = corner[1] - corner[0], b = corner[2] - corner[0];
    const double aa = glm::dot(a, a), ab = glm::dot(a, b), bb = glm::dot(b, b), square = aa * bb - ab * ab;
    origin_ = corner[0];
    // Of a triangle without area, all of it is the first corner.
    second_ = square > 0 ? (bb * a - ab * b) / square : glm::dvec3(0);
    third_ = square > 0 ? (aa * b - ab * a) / square : glm::dvec3(0);
}

glm::vec2 TrianglePlaces::of(glm::vec3 point) const {
    const glm::dvec3 offset = glm::dvec3(point) - origin_;
    return {glm::dot(second_, offset), glm::dot(third_, offset)};
}

DrawMesh drawMesh(const PatchMesh& mesh, const VertexLight& vertexLight) {
    DrawMesh out;
    for (size_t p = 0; p < mesh.patchCount(); ++p) {
        const glm::vec3 normal(geometry::patchNormal(mesh, p));
        const glm::vec3 reflectance = mesh.materials[mesh.material[p]].reflectance;
        const uint32_t first = mesh.firstCorner[p];
        for (uint32_t c = first + 1; c + 1 < mesh.firstCorner[p + 1]; ++c) {
            out.patch.push_back(static_cast<uint32_t>(p));
            for (uint32_t corner : {first, c, c + 1}) {
                const uint32_t pair = vertexLight.ofCorner(corner);
                out.corners.push_back(
                    {glm::vec3(mesh.vertices[mesh.corners[corner]]), normal, reflectance, normal});
                out.light.push_back({{pair, pair, pair}, {1, 0, 0}});
            }
        }
    }
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
            corners.push_back(
                {glm::vec3(p), glm::vec3(normal / length), glm::vec3(0), glm::vec3(normal / length)});
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
            corners.push_back({p, {0, 1, 0}, glm::vec3(0), {0, 1, 0}});
    return corners;
}

} // namespace heliodon::passes
