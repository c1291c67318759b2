// A room on the table as a sketch would give it: walls of foam core as solids, the room's surfaces as
// patches, a window to the south, a skylight, and light that is plausible rather than solved: every patch
// sees every opening unobstructed, plus an even ambient.
#pragma once

#include "compute/lighting.h"
#include "geometry/rig.h"
#include "tests/passes/room_builder.h"

namespace heliodon::test {

struct SketchScene {
    geometry::PatchMesh mesh;
    geometry::Occluders occluders;
    compute::Lighting light;
};

inline void addSolid(geometry::Occluders& out, glm::dvec3 low, glm::dvec3 high) {
    const auto first = static_cast<uint32_t>(out.vertices.size());
    for (int i = 0; i < 8; ++i)
        out.vertices.emplace_back(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
    for (uint32_t v : {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                       2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5})
        out.triangles.push_back(first + v);
}

inline SketchScene sketchScene(int n = 12, glm::dvec3 towardsSun = {0.25, 0.6, 0.8}) {
    const double inch = 0.0254, x = 8 * inch, z = 6 * inch, height = 10 * inch, t = 0.375 * inch;
    RoomBuilder b;
    b.mesh.materials[kWhite].reflectance = {0.72f, 0.68f, 0.62f};
    b.mesh.materials[kGrey].reflectance = {0.36f, 0.24f, 0.16f};
    const glm::dvec3 right(2 * x, 0, 0), up(0, height, 0), south(0, 0, 2 * z), low(-x, 0, -z);
    const auto white = [](int, int) { return kWhite; };
    b.wall(low, south, right, n, n, [](int, int) { return kGrey; });
    b.wall(low + up, right, south, n, n, [&](int i, int j) {
        return 3 * i >= 2 * n - 3 && 3 * i < 2 * n + 3 && 4 * j >= n && 2 * j < n ? kGlass : kWhite;
    });
    b.wall(low, right, up, n, n, white);
    b.wall(low + south + right, -right, up, n, n, [&](int i, int j) {
        return 2 * i >= n && 3 * i < 2 * n + n / 2 && 3 * j >= n && 3 * j < 2 * n + n / 4 ? kGlass : kWhite;
    });
    b.wall(low + south, -south, up, n, n, white);
    b.wall(low + right, south, up, n, n, white);
    SketchScene scene;
    scene.mesh = b.mesh;
    geometry::PatchMesh& mesh = scene.mesh;
    for (size_t p = 0; p < mesh.patchCount(); ++p)
        if (geometry::patchNormal(mesh, p).y < -0.5) mesh.role[p] = geometry::Role::fillIn;
    addSolid(scene.occluders, {-x - t, 0, -z - t}, {x + t + 0.05, height, -z});
    addSolid(scene.occluders, {-x - t, 0, z}, {x + t, height, z + t});
    addSolid(scene.occluders, {-x - t, 0, -z}, {-x, height, z});
    addSolid(scene.occluders, {x, 0, -z}, {x + t, height, z});

    compute::Lighting& light = scene.light;
    light.sunDirection = glm::normalize(towardsSun);
    light.sunNormalIlluminance = glm::vec3(60000, 56000, 50000);
    light.sunIlluminance.assign(mesh.patchCount(), glm::vec3(0));
    for (size_t p = 0; p < mesh.patchCount(); ++p) {
        const geometry::Material& material = mesh.materials[mesh.material[p]];
        glm::dvec3 sky(400);
        const glm::dvec3 at = geometry::patchCentroid(mesh, p), normal = geometry::patchNormal(mesh, p);
        for (size_t q = 0; q < mesh.patchCount(); ++q) {
            if (!mesh.materials[mesh.material[q]].isOpening()) continue;
            const glm::dvec3 d = geometry::patchCentroid(mesh, q) - at, nq = geometry::patchNormal(mesh, q);
            const double r2 = glm::dot(d, d),
                         cosines = std::max(0.0, glm::dot(normal, d)) * std::max(0.0, -glm::dot(nq, d));
            if (r2 > 0)
                sky += glm::dvec3(9000, 11000, 13000) * cosines * geometry::patchArea(mesh, q) /
                       (3.1416 * r2 * r2);
        }
        light.exitance.push_back(material.reflectance * glm::vec3(sky));
    }
    return scene;
}

} // namespace heliodon::test
