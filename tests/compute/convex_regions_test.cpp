#include "compute/convex_regions.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/compute/rooms.h"

namespace heliodon::compute {
namespace {

using glm::dvec3;

// Those cells of a grid of 36 x 24 that `has` names, two triangles each, somewhere in space. Vertices inside
// are moved about by up to `jitter` of a cell, so that columns of them are upright only nearly.
geometry::PatchMesh wall(const std::function<bool(int, int)>& has, double jitter, unsigned seed) {
    constexpr int kColumns = 36, kRows = 24;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> any(-1, 1);
    const auto direction = [&] { return glm::normalize(dvec3(any(random), any(random), any(random))); };
    const dvec3 u = direction(), v = glm::normalize(glm::cross(u, direction())),
                origin = 30.0 * dvec3(any(random), any(random), any(random));
    const auto inside = [&](int x, int y) { // of the wall, no corner and no border
        return x > 0 && y > 0 && x < kColumns && y < kRows && has(x - 1, y - 1) && has(x, y - 1) &&
               has(x - 1, y) && has(x, y);
    };
    geometry::PatchMesh mesh;
    for (int y = 0; y <= kRows; ++y)
        for (int x = 0; x <= kColumns; ++x) {
            const double by = inside(x, y) ? jitter : 0.0;
            mesh.vertices.push_back(origin + 0.1 * ((x + by * any(random)) * u + (y + by * any(random)) * v));
        }
    mesh.materials.resize(1);
    const auto add = [&](int a, int b, int c) {
        for (int corner : {a, b, c}) mesh.corners.push_back(static_cast<uint32_t>(corner));
        mesh.firstCorner.push_back(static_cast<uint32_t>(mesh.corners.size()));
        mesh.material.push_back(0);
        mesh.role.push_back(geometry::Role::projection);
        mesh.surface.push_back(0);
        mesh.room.push_back(0);
        mesh.twin.push_back(geometry::kNoTwin);
    };
    for (int y = 0; y < kRows; ++y)
        for (int x = 0; x < kColumns; ++x) {
            if (!has(x, y)) continue;
            const int a = y * (kColumns + 1) + x, c = a + kColumns + 1;
            add(a, a + 1, c + 1);
            add(a, c + 1, c);
        }
    return mesh;
}

double areaOf(const ConvexRegion& region) {
    dvec3 sum{0};
    for (size_t k = 1; k + 1 < region.corners.size(); ++k)
        sum += 0.5 *
               glm::cross(region.corners[k] - region.corners[0], region.corners[k + 1] - region.corners[0]);
    return glm::length(sum);
}

// However a wall is meshed and wherever it stands, it is as many rectangles as its shape needs.
TEST(ConvexRegions, a_wall_is_few_polygons_however_it_is_meshed) {
    struct Case {
        const char* name;
        std::function<bool(int, int)> has;
        size_t regions;
        double area;
    };
    const Case cases[] = {
        {"rectangle", [](int, int) { return true; }, 1, 8.64},
        {"L", [](int x, int y) { return x < 10 || y < 8; }, 2, 0.01 * (10 * 24 + 26 * 8)},
        {"U", [](int x, int y) { return x < 10 || x >= 30 || y < 8; }, 3, 0.01 * (16 * 24 + 20 * 8)},
        {"window", [](int x, int y) { return x < 10 || x >= 30 || y < 8 || y >= 20; }, 4,
         0.01 * (864 - 20 * 12)},
        {"8 storeys of 18 windows", [](int x, int y) { return x % 2 != 1 || y % 3 != 1; }, 9 + 8 * 18,
         0.01 * (864 - 8 * 18)}};
    for (const Case& c : cases)
        for (double jitter : {0.0, 1e-15, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 0.1})
            for (unsigned seed = 0; seed < 5; ++seed) {
                const geometry::PatchMesh mesh = wall(c.has, jitter, seed);
                const std::vector<uint32_t> group(mesh.patchCount(), 0);
                const std::vector<ConvexRegion> regions = mergedRegions(mesh, group, 8);
                double area = 0;
                for (const ConvexRegion& region : regions) {
                    area += areaOf(region);
                    EXPECT_EQ(region.corners.size(), 4u) << c.name << " " << jitter << " " << seed;
                }
                EXPECT_EQ(regions.size(), c.regions) << c.name << " " << jitter << " " << seed;
                EXPECT_NEAR(area, c.area, 1e-5) << c.name << " " << jitter << " " << seed;
            }
}

// A dome over a round floor; every facet has the whole room on one side until a plate hangs in it.
TEST(ConvexRegions, planes_block_that_have_some_of_their_room_on_both_sides) {
    constexpr uint32_t kRings = 60, kSides = 240;
    std::vector<std::vector<dvec3>> faces;
    const auto at = [](uint32_t ring, uint32_t side) {
        const double up = 0.5 * std::numbers::pi * ring / kRings,
                     round = 2 * std::numbers::pi * (side % kSides) / kSides;
        return 3.0 * dvec3(std::cos(up) * std::cos(round), std::sin(up), std::cos(up) * std::sin(round));
    };
    for (uint32_t ring = 0; ring < kRings; ++ring)
        for (uint32_t side = 0; side < kSides; ++side) {
            faces.push_back({at(ring, side), at(ring, side + 1), at(ring + 1, side)});
            if (ring + 1 < kRings)
                faces.push_back({at(ring, side + 1), at(ring + 1, side + 1), at(ring + 1, side)});
        }
    for (uint32_t side = 0; side < kSides; ++side) faces.push_back({dvec3(0), at(0, side + 1), at(0, side)});
    EXPECT_TRUE(blockingPlanes(test::polygons(faces), 8).regions.empty());
    faces.push_back({{-1, 1, -1}, {-1, 1, 1}, {1, 1, 1}, {1, 1, -1}});
    const BlockingPlanes found = blockingPlanes(test::polygons(faces), 8);
    ASSERT_EQ(found.regions.size(), 1u);
    EXPECT_NEAR(areaOf(found.regions[0]), 4, 1e-9);
}

} // namespace
} // namespace heliodon::compute
