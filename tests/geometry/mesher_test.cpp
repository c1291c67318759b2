#include "geometry/mesher.h"

#include <cmath>
#include <map>
#include <set>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

using namespace heliodon::geometry;

namespace {

Building buildingOf(const std::string& name) {
    Closure closure = closeSketch(readSketch(std::string(HELIODON_TEST_DATA "/geometry/sketches/") + name));
    EXPECT_TRUE(closure.building) << closure.report.message;
    return std::move(*closure.building);
}

double faceArea(const Building& building) {
    double sum = 0;
    for (const Face& face : building.faces) {
        glm::dvec3 twice{0};
        for (const auto& loop : face.loops)
            for (size_t i = 0; i < loop.size(); ++i)
                twice +=
                    glm::cross(building.vertices[loop[i]], building.vertices[loop[(i + 1) % loop.size()]]);
        sum += 0.5 * glm::length(twice);
    }
    return sum;
}

void expectNoTVertices(const PatchMesh& mesh) {
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const auto corner = mesh.patch(i);
        for (size_t k = 0; k < corner.size(); ++k) ++edges[{corner[k], corner[(k + 1) % corner.size()]}];
    }
    for (const auto& [edge, count] : edges) {
        ASSERT_EQ(count, 1);
        ASSERT_TRUE(edges.contains({edge.second, edge.first}));
    }
}

} // namespace

class MeshOfSketch : public testing::TestWithParam<std::string> {};

TEST_P(MeshOfSketch, closes_keeps_the_area_and_is_about_as_fine_as_asked) {
    const Building building = buildingOf(GetParam());
    const bool curved = GetParam() == "p09_D_curved.json" || GetParam() == "i01_mixed.sketch.json";
    for (const size_t wanted : {600u, 2000u, 10000u}) {
        const PatchMesh mesh = meshBuilding(building, {wanted});
        expectNoTVertices(mesh);
        double area = 0;
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            area += patchArea(mesh, i);
            ASSERT_GT(patchArea(mesh, i), 0);
        }
        // Triangles over the fold of two facets cut the corner: by the square of the turn, 1e-3 at most here.
        EXPECT_NEAR(area, faceArea(building), (curved ? 1e-3 : 1e-9) * area);
        EXPECT_NEAR(static_cast<double>(mesh.patchCount()), static_cast<double>(wanted),
                    (wanted < 1000 ? 0.04 : 0.03) * static_cast<double>(wanted));
    }
}

INSTANTIATE_TEST_SUITE_P(Sketches, MeshOfSketch,
                         testing::Values("p01_rect_tight.json", "p04_L.json", "p05_T_two_rooms.json",
                                         "p06_U.json", "p08_cubicle.json", "p09_D_curved.json",
                                         "i01_mixed.sketch.json", "i02_pinwheel.sketch.json"));

TEST(Mesher, triangles_of_the_benchmark_room_are_uniform) {
    const Building building = buildingOf("p04_L.json");
    const MeshQuality coarse = measureMesh(meshBuilding(building, {2000}));
    EXPECT_GT(coarse.minAngleDeg, 30); // measured 33; gmsh Frontal has 36.1, pmp-library 22.3
    EXPECT_LT(coarse.areaDeviation, 0.13);
    EXPECT_LT(measureMesh(meshBuilding(building, {10000})).areaDeviation, 0.09);
}

TEST(Mesher, normals_point_into_the_air_of_curved_walls_too) {
    const PatchMesh mesh = meshBuilding(buildingOf("p09_D_curved.json"));
    const glm::dvec3 middle(0, 0.127, 0);
    double volume = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const double height = glm::dot(middle - patchCentroid(mesh, i), patchNormal(mesh, i));
        EXPECT_GT(height, 0) << i; // the room is convex
        volume += patchArea(mesh, i) * height / 3;
    }
    EXPECT_NEAR(volume / std::pow(kMetresPerInch, 3), 1671.39,
                0.005 * 1671.39); // chords: 0.13 %, folds cut a little more
}

TEST(Mesher, glasses_of_an_interior_window_have_mirrored_triangles) {
    const PatchMesh mesh = meshBuilding(buildingOf("p05_T_two_rooms.json"));
    size_t twins = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        if (mesh.twin[i] == kNoTwin) continue;
        ++twins;
        const auto j = static_cast<size_t>(mesh.twin[i]);
        ASSERT_EQ(mesh.twin[j], static_cast<int32_t>(i));
        EXPECT_NE(mesh.room[i], mesh.room[j]);
        // Across the wall's thickness, 0.375 in, straight.
        EXPECT_NEAR(glm::length(patchCentroid(mesh, i) - patchCentroid(mesh, j)), 0.375 * kMetresPerInch,
                    1e-9);
        EXPECT_NEAR(patchArea(mesh, i), patchArea(mesh, j), 1e-12);
        EXPECT_NEAR(glm::dot(patchNormal(mesh, i), patchNormal(mesh, j)), -1, 1e-12);
    }
    EXPECT_GT(twins, 10u);
}

TEST(Mesher, facets_of_one_arc_are_one_surface) {
    const Building building = buildingOf("p09_D_curved.json");
    const PatchMesh mesh = meshBuilding(building);
    EXPECT_EQ(std::set<uint32_t>(mesh.surface.begin(), mesh.surface.end()).size(),
              7u); // 3 walls, arc, floor, ceiling, glass
}
