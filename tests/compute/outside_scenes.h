// A room of 4 x 3 x 5 m with a window towards -z, and what may stand before it.
#pragma once

#include <string>
#include <vector>

#include "geometry/patch_mesh.h"
#include "tests/compute/rooms.h"

namespace heliodon::test {

// Glass over x 1 to 3, y 1 to 2.
inline geometry::PatchMesh roomWithWindow(uint32_t fine, bool triangles = true) {
    BoxRoom box{.cells = {4 * fine, 3 * fine, 5 * fine}, .triangles = triangles};
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    return boxRoom(box);
}

// A rectangle that stands outside, seen from where its corners run counter-clockwise.
inline void standOutside(geometry::PatchMesh& mesh, std::vector<glm::dvec3> corners, float reflectance,
                         bool bothSides = false) {
    geometry::Occluders& out = mesh.outside;
    const auto v = static_cast<uint32_t>(out.vertices.size());
    out.vertices.insert(out.vertices.end(), corners.begin(), corners.end());
    const auto material = static_cast<uint32_t>(mesh.materials.size());
    mesh.materials.push_back({"outside", glm::vec3(reflectance)});
    std::vector<uint32_t> triangles{v, v + 1, v + 2, v, v + 2, v + 3};
    if (bothSides) triangles.insert(triangles.end(), {v, v + 2, v + 1, v, v + 3, v + 2});
    out.triangles.insert(out.triangles.end(), triangles.begin(), triangles.end());
    out.material.insert(out.material.end(), triangles.size() / 3, material);
}

// A wall with ends `a` and `b`, on the left of who walks from one to the other.
inline void wallOutside(geometry::PatchMesh& mesh, glm::dvec2 a, glm::dvec2 b, double low, double high,
                        float reflectance, bool bothSides = false) {
    standOutside(mesh, {{a.x, low, a.y}, {a.x, high, a.y}, {b.x, high, b.y}, {b.x, low, b.y}}, reflectance,
                 bothSides);
}

inline const std::vector<std::string> kOutsideScenes{"facade", "reveal", "overhang", "fins",
                                                     "court",  "street", "all"};

inline void addOutside(geometry::PatchMesh& mesh, const std::string& scene) {
    const bool all = scene == "all"; // but what encloses
    if (all || scene == "facade") wallOutside(mesh, {17, -10}, {-13, -10}, 0, 12, 0.5f);
    if (scene == "reveal") {
        wallOutside(mesh, {1, -0.4}, {1, 0}, 1, 2, 0.7f), wallOutside(mesh, {3, 0}, {3, -0.4}, 1, 2, 0.7f);
        standOutside(mesh, {{1, 1, 0}, {3, 1, 0}, {3, 1, -0.4}, {1, 1, -0.4}}, 0.7f);
        standOutside(mesh, {{1, 2, -0.4}, {3, 2, -0.4}, {3, 2, 0}, {1, 2, 0}}, 0.7f);
    }
    if (all || scene == "overhang")
        standOutside(mesh, {{0, 2.2, -1.5}, {4, 2.2, -1.5}, {4, 2.2, 0}, {0, 2.2, 0}}, 0.5f, true);
    if (all || scene == "fins")
        for (const double x : {0.9, 2.0, 3.1}) wallOutside(mesh, {x, 0}, {x, -1}, 0.8, 2.2, 0.6f, true);
    if (scene == "street") wallOutside(mesh, {12, -3}, {-8, -3}, -2, 20, 0.6f);
    if (scene == "court") {
        wallOutside(mesh, {7, -6}, {-3, -6}, 0, 9, 0.4f);
        wallOutside(mesh, {-3, -6}, {-3, 0}, 0, 9, 0.4f), wallOutside(mesh, {7, 0}, {7, -6}, 0, 9, 0.4f);
    }
}

// For who traces rays: what stands outside as patches of no room, sides of a sheet a hair apart.
inline geometry::PatchMesh withOutsideAsPatches(geometry::PatchMesh mesh) {
    const geometry::Occluders& out = mesh.outside;
    for (size_t t = 0; t < out.triangles.size(); t += 3) {
        const auto first = static_cast<uint32_t>(mesh.vertices.size());
        const auto corner = [&](size_t k) { return out.vertices[out.triangles[t + k]]; };
        const glm::dvec3 normal = glm::normalize(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
        for (size_t k = 0; k < 3; ++k) mesh.vertices.push_back(corner(k) + 1e-5 * normal);
        mesh.addPatch(std::vector{first, first + 1, first + 2}, out.material[t / 3], geometry::Role::extra, 0,
                      geometry::kNoRoom);
    }
    return mesh;
}

} // namespace heliodon::test
