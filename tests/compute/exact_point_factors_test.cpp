#include "compute/exact_point_factors.h"

#include <cmath>
#include <numeric>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "geometry/model_file.h"
#include "tests/compute/form_factor_cases.h"
#include "tests/compute/rooms.h"
#include "tests/gpu/test_device.h"

namespace heliodon::compute {
namespace {

using glm::dvec3;

std::vector<float> factorsOf(const geometry::PatchMesh& mesh, const std::vector<SurfacePoint>& points) {
    ExactPointFactors kernel(test::device(), mesh);
    const std::vector<float> result = kernel.run(points);
    EXPECT_EQ(kernel.overflows(), 0u);
    return result;
}

// 1e-6: float32 in Lambert's formula.
TEST(ExactPointFactors, elements_agree_with_closed_forms) {
    for (const auto& c : test::elementCases()) {
        const auto F = factorsOf(test::meshOf({c.polygon}), {{c.point, c.normal}});
        EXPECT_NEAR(F[0], c.value, 1e-6) << c.name;
        if (c.value == 0) {
            EXPECT_EQ(F[0], 0.0f) << c.name;
        }
    }
}

std::vector<SurfacePoint> pointsInRoom3() {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<SurfacePoint> points;
    const auto solid = [](double x, double y) {
        return (x > 1.99 && x < 2.21 && y < 4.01) || (x > 3.99 && x < 4.21 && y > 1.99) ||
               (x > 5.99 && x < 6.21 && y > 1.49 && y < 4.51);
    };
    while (points.size() < 24) {
        const dvec3 p(8 * unit(random), 6 * unit(random), 3 * unit(random));
        const dvec3 n(2 * unit(random) - 1, 2 * unit(random) - 1, 2 * unit(random) - 1);
        if (!solid(p.x, p.y) && glm::length(n) > 0.1) points.push_back({p, glm::normalize(n)});
    }
    points.push_back(
        {{1, 1, 0}, {0, 0, 1}}); // on the floor, on a partition, and a desk's height above the floor
    points.push_back({{2, 2, 1}, {-1, 0, 0}});
    points.push_back({{5, 3, 0.8}, {0, 0, 1}});
    return points;
}

// Against the oracle with all patches as blockers, and rows sum to 1 in a closed room: 1e-5 is the sum of n
// float32 errors.
TEST(ExactPointFactors, room_with_partitions_agrees_with_the_oracle_and_closes) {
    const geometry::PatchMesh mesh =
        geometry::readPatches(HELIODON_TEST_DATA "/geometry/models/room3_672.obj");
    const size_t n = mesh.patchCount();
    const std::vector<SurfacePoint> points = pointsInRoom3();
    const auto F = factorsOf(mesh, points);
    std::vector<reference::Polygon> patches;
    for (size_t j = 0; j < n; ++j) patches.push_back(reference::polygonOf(mesh, j));
    for (size_t p = 0; p < points.size(); ++p) {
        const float* row = F.data() + p * n;
        EXPECT_NEAR(std::accumulate(row, row + n, 0.0), 1, 1e-5) << p;
        if (p % 3 == 0)
            for (size_t j = 0; j < n; j += 11) {
                const double truth =
                    reference::visiblePointFactor(mesh, points[p].position, points[p].normal, j);
                EXPECT_NEAR(row[j], truth, 1e-6) << p << " " << j;
            }
    }
}

// Monte Carlo: cosine-distributed rays, nearest patch. Four standard errors of the share of N rays.
TEST(ExactPointFactors, table_and_screen_agree_with_rays) {
    std::vector<reference::Polygon> polygons;
    geometry::PatchMesh mesh = test::boxRoom({.high = {4, 3, 5}, .cells = {2, 2, 2}});
    const auto add = [&](std::vector<dvec3> corners) {
        std::vector<uint32_t> indices;
        for (const dvec3& p : corners) {
            indices.push_back(static_cast<uint32_t>(mesh.vertices.size()));
            mesh.vertices.push_back(p);
        }
        mesh.addPatch(indices, 0, geometry::Role::projection, 99, 0);
    };
    add({{1, 0.8, 1}, {1, 0.8, 2.5}, {2.5, 0.8, 2.5}, {2.5, 0.8, 1}});     // a table top without thickness
    add({{1, 0.79, 1}, {2.5, 0.79, 1}, {2.5, 0.79, 2.5}, {1, 0.79, 2.5}}); // its underside
    add({{3, 0, 1}, {3.3, 0, 4}, {3.2, 1.7, 4}, {2.9, 1.9, 2.5}}); // a leaning screen, its front to -x
    const size_t n = mesh.patchCount();
    const std::vector<SurfacePoint> points{{{1.7, 0, 1.6}, {0, 1, 0}},
                                           {{3.8, 1.2, 2.5}, {-1, 0, 0}},
                                           {{0.5, 1, 4}, glm::normalize(dvec3(1, -0.4, -1))}};
    const auto F = factorsOf(mesh, points);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    constexpr int kRays = 40000;
    for (size_t p = 0; p < points.size(); ++p) {
        const dvec3 normal = points[p].normal,
                    other = std::abs(normal.x) < 0.6 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
        const dvec3 u = glm::normalize(glm::cross(other, normal)), v = glm::cross(normal, u);
        std::vector<double> hits(n, 0.0);
        for (int k = 0; k < kRays; ++k) {
            const double r = std::sqrt(unit(random)), phi = 2 * M_PI * unit(random);
            const dvec3 d = r * std::cos(phi) * u + r * std::sin(phi) * v + std::sqrt(1 - r * r) * normal;
            double nearest = INFINITY;
            size_t hit = n;
            for (size_t j = 0; j < n; ++j) {
                const auto corner = mesh.patch(j);
                const dvec3 a = geometry::patchNormal(mesh, j), o = mesh.vertices[corner[0]];
                const double slope = glm::dot(d, a), t = glm::dot(o - points[p].position, a) / slope;
                if (!(t > 1e-9 && t < nearest)) continue;
                const dvec3 x = points[p].position + t * d;
                bool inside = true;
                for (size_t c = 0; c < corner.size() && inside; ++c) {
                    const dvec3 s = mesh.vertices[corner[c]],
                                e = mesh.vertices[corner[(c + 1) % corner.size()]];
                    inside = glm::dot(glm::cross(e - s, x - s), a) >= 0;
                }
                if (!inside) continue;
                nearest = t;
                hit = slope < 0 ? j : n;
            }
            if (hit < n) hits[hit] += 1.0 / kRays;
        }
        for (size_t j = 0; j < n; ++j) {
            const double sigma = std::sqrt(std::max(hits[j], 1.0 / kRays) / kRays);
            EXPECT_NEAR(F[p * n + j], hits[j], 4 * sigma) << p << " " << j;
        }
    }
}

TEST(ExactPointFactors, rooms_do_not_see_one_another_and_no_points_are_fine) {
    geometry::PatchMesh mesh;
    test::addBox(mesh, {.high = {1, 1, 1}, .cells = {1, 1, 1}}, 0);
    test::addBox(mesh, {.low = {1, 0, 0}, .high = {2, 1, 1}, .cells = {1, 1, 1}}, 1);
    EXPECT_TRUE(factorsOf(mesh, {}).empty());
    const auto F = factorsOf(mesh, {{{0.5, 0.5, 0.5}, {1, 0, 0}, 0}, {{1.5, 0.5, 0.5}, {1, 0, 0}, 1}});
    const size_t n = mesh.patchCount();
    for (size_t j = 0; j < n; ++j) EXPECT_EQ(F[(mesh.room[j] == 0 ? 1 : 0) * n + j], 0.0f);
    EXPECT_NEAR(std::accumulate(F.begin(), F.begin() + static_cast<long>(n), 0.0), 1, 1e-6);
}

} // namespace
} // namespace heliodon::compute
