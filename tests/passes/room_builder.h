// Small rooms for tests: walls as grids of patches, some cells of which may be openings.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "geometry/patch_mesh.h"

namespace heliodon::test {

constexpr uint32_t kWhite = 0, kGlass = 1, kHole = 2, kGrey = 3;

class RoomBuilder {
public:
    RoomBuilder() {
        mesh.materials = {{"white", glm::vec3(0.7f)},
                          {"glass", glm::vec3(0), glm::vec3(0.88f, 0.8f, 0.5f), 1.52f},
                          {"hole", glm::vec3(0), glm::vec3(1), 1.0f},
                          {"grey", glm::vec3(0.3f)}};
    }

    // n x m cells; counter-clockwise as u turns to v, so the normal is u x v. `materialOf(i, j)` picks cells.
    void wall(glm::dvec3 origin, glm::dvec3 u, glm::dvec3 v, int n, int m,
              const std::function<uint32_t(int, int)>& materialOf, uint32_t room = 0, bool triangles = true) {
        const uint32_t surface = nextSurface_;
        nextSurface_ += 4;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < m; ++j) {
                const auto at = [&](int a, int b) {
                    return vertex(origin + u * (double(a) / n) + v * (double(b) / m));
                };
                const uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
                const uint32_t material = materialOf(i, j);
                const auto role = geometry::Role::projection;
                if (!triangles) {
                    mesh.addPatch(std::array{a, b, c, d}, material, role, surface + material, room);
                    continue;
                }
                mesh.addPatch(std::array{a, b, c}, material, role, surface + material, room);
                mesh.addPatch(std::array{a, c, d}, material, role, surface + material, room);
            }
    }
    void wall(glm::dvec3 origin, glm::dvec3 u, glm::dvec3 v, int n, int m, uint32_t material = kWhite,
              uint32_t room = 0) {
        wall(
            origin, u, v, n, m, [=](int, int) { return material; }, room);
    }
    // A closed box with normals to the inside. `southOf(i, j)` picks the materials of the wall at +z, i along
    // +x, j up; the other walls are white.
    void box(glm::dvec3 low, glm::dvec3 size, int n, const std::function<uint32_t(int, int)>& southOf,
             uint32_t room = 0) {
        const glm::dvec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
        const auto white = [](int, int) { return kWhite; };
        wall(low, z, x, n, n, white, room);     // floor
        wall(low + y, x, z, n, n, white, room); // ceiling
        wall(low, x, y, n, n, white, room);     // north
        wall(
            low + z + x, -x, y, n, n, [&](int i, int j) { return southOf(n - 1 - i, j); }, room);
        wall(low + z, -z, y, n, n, white, room); // west
        wall(low + x, z, y, n, n, white, room);  // east
    }

    geometry::PatchMesh mesh;

private:
    uint32_t vertex(glm::dvec3 p) {
        const auto key =
            std::make_tuple(std::llround(p.x * 1e9), std::llround(p.y * 1e9), std::llround(p.z * 1e9));
        const auto [entry, fresh] = ids_.try_emplace(key, static_cast<uint32_t>(mesh.vertices.size()));
        if (fresh) mesh.vertices.push_back(p);
        return entry->second;
    }

    std::map<std::tuple<long long, long long, long long>, uint32_t> ids_;
    uint32_t nextSurface_ = 0;
};

} // namespace heliodon::test
