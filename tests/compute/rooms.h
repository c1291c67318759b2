// Simple closed rooms for tests: boxes with their walls divided, windows cut out along the grid.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>

#include <glm/geometric.hpp>

#include "geometry/patch_mesh.h"

namespace heliodon::test {

struct BoxRoom {
    glm::dvec3 low{0}, high{4, 3, 5};
    std::array<uint32_t, 3> cells{4, 3, 5}; // along x, y, z
    bool triangles = true;
    geometry::Material wall{"wall", glm::vec3(0.5f)};
    geometry::Material glass{"glass", glm::vec3(0), glm::vec3(0.88f)};
    // Whether the cell with this middle is glass.
    std::function<bool(glm::dvec3)> isGlass = [](glm::dvec3) { return false; };
};

// Appends the room; its patches get room number `room`.
inline void addBox(geometry::PatchMesh& mesh, const BoxRoom& box, uint32_t room = 0) {
    const auto base = static_cast<uint32_t>(mesh.materials.size());
    mesh.materials.push_back(box.wall);
    mesh.materials.push_back(box.glass);
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
            const int a = (axis + 1) % 3, b = (axis + 2) % 3;
            const uint32_t na = box.cells[static_cast<size_t>(a)], nb = box.cells[static_cast<size_t>(b)];
            const auto corner = [&](uint32_t i, uint32_t j) {
                glm::dvec3 p;
                p[axis] = side ? box.high[axis] : box.low[axis];
                p[a] = box.low[a] + (box.high[a] - box.low[a]) * i / na;
                p[b] = box.low[b] + (box.high[b] - box.low[b]) * j / nb;
                return p;
            };
            for (uint32_t i = 0; i < na; ++i)
                for (uint32_t j = 0; j < nb; ++j) {
                    const auto v = static_cast<uint32_t>(mesh.vertices.size());
                    for (glm::dvec3 p :
                         {corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)})
                        mesh.vertices.push_back(p);
                    const glm::dvec3 middle = 0.5 * (corner(i, j) + corner(i + 1, j + 1));
                    const uint32_t material = base + (box.isGlass(middle) ? 1 : 0);
                    const auto surface = static_cast<uint32_t>(6 * room + 2 * axis + side);
                    const auto add = [&](std::vector<uint32_t> corners) {
                        // Low sides face +axis: a x b is +axis for every axis.
                        if (side) std::reverse(corners.begin(), corners.end());
                        mesh.addPatch(corners, material, geometry::Role::projection, surface, room);
                    };
                    if (box.triangles) {
                        add({v, v + 1, v + 2});
                        add({v, v + 2, v + 3});
                    } else {
                        add({v, v + 1, v + 2, v + 3});
                    }
                }
        }
}

inline geometry::PatchMesh boxRoom(const BoxRoom& box) {
    geometry::PatchMesh mesh;
    addBox(mesh, box);
    return mesh;
}

// Slabs of 1 x 0.8 x 0.02 m, `gap` metres apart, in a room of 2.7 m: a pile in which each is `turn` radians
// further about its axis than the one beneath; all together turned by `lean`, radians about x, y and z.
inline geometry::PatchMesh pileOfSlabs(double gap, double turn, glm::dvec3 lean, uint32_t slabs = 3,
                                       double thickness = 0.02) {
    geometry::PatchMesh mesh = boxRoom({.low = {0, 0, 0}, .high = {2.7, 2.7, 2.7}, .cells = {2, 2, 2}});
    const size_t room = mesh.corners.size();
    const auto about = [](glm::dvec3 p, int axis, double angle) {
        const int a = (axis + 1) % 3, b = (axis + 2) % 3;
        const double c = std::cos(angle), s = std::sin(angle), u = p[a], v = p[b];
        p[a] = c * u - s * v, p[b] = s * u + c * v;
        return p;
    };
    for (uint32_t k = 0; k < slabs; ++k) {
        const size_t first = mesh.vertices.size();
        const double y = k * (thickness + gap);
        addBox(mesh, {.low = {-0.5, y, -0.4}, .high = {0.5, y + thickness, 0.4}, .cells = {2, 1, 2}});
        for (size_t v = first; v < mesh.vertices.size(); ++v) {
            glm::dvec3& p = mesh.vertices[v];
            p = about(p, 1, turn * k);
            for (int axis = 0; axis < 3; ++axis) p = about(p, axis, lean[axis]);
            p += glm::dvec3(1.3, 1.1, 1.3);
        }
    }
    std::reverse(mesh.corners.begin() + static_cast<long>(room), mesh.corners.end()); // they face outwards
    return mesh;
}

// A room of 6 x 3 x 4 m, its patches half a metre square and larger, with two screens 10 cm thick that leave
// slots of 2 and 3 cm to floor, ceiling and walls.
inline geometry::PatchMesh roomWithScreens() {
    geometry::PatchMesh mesh = boxRoom({.low = {0, 0, 0}, .high = {6, 3, 4}, .cells = {6, 4, 4}});
    const size_t room = mesh.corners.size();
    addBox(mesh, {.low = {2, 0.02, 0.02}, .high = {2.1, 2.98, 3.98}, .cells = {1, 2, 2}});
    addBox(mesh, {.low = {4, 0.03, 0.03}, .high = {4.1, 2.97, 3.97}, .cells = {1, 2, 2}});
    std::reverse(mesh.corners.begin() + static_cast<long>(room), mesh.corners.end()); // screens face outwards
    return mesh;
}

// Two rooms side by side along z, 4 x 3 x 5 m each, glass all over the wall between them at z = 5 and, if
// wanted, over the outer wall at z = 0. Cells of 1 m over `times`.
inline geometry::PatchMesh twoRooms(bool outerGlass, glm::vec3 wall = glm::vec3(0.5f), uint32_t times = 1,
                                    bool triangles = true) {
    const auto at = [](double z) { return [z](glm::dvec3 p) { return std::abs(p.z - z) < 1e-9; }; };
    BoxRoom box;
    box.wall.reflectance = wall;
    box.cells = {4 * times, 3 * times, 5 * times};
    box.triangles = triangles;
    box.isGlass = [&](glm::dvec3 p) { return (outerGlass && at(0)(p)) || at(5)(p); };
    geometry::PatchMesh mesh = boxRoom(box);
    BoxRoom inner = box;
    inner.low.z = 5, inner.high.z = 10;
    inner.isGlass = at(5);
    addBox(mesh, inner, 1);
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        for (size_t j = i + 1; j < mesh.patchCount(); ++j)
            if (mesh.room[i] != mesh.room[j] && mesh.materials[mesh.material[j]].isOpening() &&
                glm::length(geometry::patchCentroid(mesh, i) - geometry::patchCentroid(mesh, j)) < 1e-9)
                mesh.twin[i] = static_cast<int32_t>(j), mesh.twin[j] = static_cast<int32_t>(i);
    return mesh;
}

// A parallelogram in times x times cells of two triangles each, which face u x v.
inline void addSheet(std::vector<std::vector<glm::dvec3>>& faces, glm::dvec3 corner, glm::dvec3 u,
                     glm::dvec3 v, int times) {
    const auto at = [&](int i, int k) { return corner + u * (double(i) / times) + v * (double(k) / times); };
    for (int i = 0; i < times; ++i)
        for (int k = 0; k < times; ++k) {
            faces.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
            faces.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
        }
}

// Loose polygons, one room, one material.
inline geometry::PatchMesh polygons(const std::vector<std::vector<glm::dvec3>>& faces) {
    geometry::PatchMesh mesh;
    mesh.materials.push_back({"matter", glm::vec3(0.5f)});
    for (const auto& face : faces) {
        std::vector<uint32_t> corners;
        for (const glm::dvec3& p : face) {
            corners.push_back(static_cast<uint32_t>(mesh.vertices.size()));
            mesh.vertices.push_back(p);
        }
        mesh.addPatch(corners, 0, geometry::Role::projection, 0, 0);
    }
    return mesh;
}

// Loose needles all through a room from corner to corner, whose boxes every ray has to go through, most in
// vain.
inline std::vector<std::array<glm::dvec3, 3>> needlesAcross(const BoxRoom& box, uint32_t count,
                                                            double width) {
    std::mt19937 random(5);
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    std::vector<std::array<glm::dvec3, 3>> needles;
    for (uint32_t k = 0; k < count; ++k) {
        glm::dvec3 from, to;
        for (int axis = 0; axis < 3; ++axis) {
            const double low = box.low[axis], size = box.high[axis] - low, swap = (k >> axis) & 1u;
            from[axis] = low + size * std::abs(swap - between(0.01, 0.11));
            to[axis] = low + size * std::abs(swap - between(0.89, 0.99));
        }
        const glm::dvec3 aside(between(-width, width), between(-width, width), between(-width, width));
        needles.push_back({from, to, from + aside});
    }
    return needles;
}

// A closed box with two screens without thickness that cross, patches on both sides, divided into `cells` x
// `cells`; corners are rounded to float, so that patches lie in the planes of their walls only nearly.
inline geometry::PatchMesh crossingScreens(uint32_t cells) {
    std::vector<std::vector<glm::dvec3>> faces;
    const auto add = [&](glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v) {
        const auto at = [&](uint32_t i, uint32_t j) {
            return glm::dvec3(glm::vec3(corner + u * (double(i) / cells) + v * (double(j) / cells)));
        };
        for (uint32_t i = 0; i < cells; ++i)
            for (uint32_t j = 0; j < cells; ++j)
                faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    };
    const glm::dvec3 x(3, 0, 0), y(0, 3, 0), z(0, 0, 3), o(0);
    add(o, y, x), add(z, x, y), add(o, x, z), add(y, z, x), add(o, z, y), add(x, y, z);
    for (auto& face : faces) std::reverse(face.begin(), face.end()); // to look inwards
    const auto screen = [&](glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v) {
        add(corner, u, v);
        add(corner, v, u);
    };
    screen({1.5, 0, 0.5}, {0, 2, 0}, {0, 0, 2});
    screen({0.5, 0.5, 1.5}, {2, 0.3, 0}, {0, 2, 0.2});
    return polygons(faces);
}

// A room of 2 m under a slot in its ceiling, 10 cm wide and 30 cm deep, with glass on top; each wall in so
// many squares.
inline geometry::PatchMesh slottedRoom(uint32_t roomCells, uint32_t along, uint32_t deep, uint32_t across) {
    geometry::PatchMesh mesh;
    mesh.materials.resize(3);
    mesh.materials[0].reflectance = glm::vec3(0.5F), mesh.materials[1].reflectance = glm::vec3(0.6F);
    mesh.materials[2].reflectance = glm::vec3(0), mesh.materials[2].transmittance = glm::vec3(1);
    mesh.materials[2].refractiveIndex = 1;
    int surface = 0;
    const auto wall = [&](glm::dvec3 corner, glm::dvec3 a, glm::dvec3 b, uint32_t na, uint32_t nb,
                          uint32_t material) {
        const auto first = static_cast<uint32_t>(mesh.vertices.size());
        for (uint32_t i = 0; i <= na; ++i)
            for (uint32_t j = 0; j <= nb; ++j)
                mesh.vertices.push_back(corner + double(i) / na * a + double(j) / nb * b);
        for (uint32_t i = 0; i < na; ++i)
            for (uint32_t j = 0; j < nb; ++j) {
                const uint32_t v = first + i * (nb + 1) + j;
                mesh.addPatch(std::vector{v, v + nb + 1, v + nb + 2, v + 1}, material,
                              geometry::Role::projection, surface, 0);
            }
        ++surface;
    };
    const glm::dvec3 x(2, 0, 0), y(0, 2, 0), z(0, 0, 2), deepness(0, 0.3, 0), width(0, 0, 0.1);
    const uint32_t n = roomCells;
    wall({0, 0, 0}, z, x, n, n, 0);
    wall({0, 2, 0}, x, 0.475 * z, n, n, 0), wall({0, 2, 1.05}, x, 0.475 * z, n, n, 0);
    wall({0, 0, 0}, x, y, n, n, 0), wall({0, 0, 2}, y, x, n, n, 0);
    wall({0, 0, 0}, y, z, n, n, 0), wall({2, 0, 0}, z, y, n, n, 0);
    wall({0, 2, 0.95}, x, deepness, along, deep, 1), wall({0, 2, 1.05}, deepness, x, deep, along, 1);
    wall({0, 2, 0.95}, deepness, width, deep, across, 1),
        wall({2, 2, 0.95}, width, deepness, across, deep, 1);
    wall({0, 2.3, 0.95}, x, width, along, across, 2);
    return mesh;
}

} // namespace heliodon::test
