#include "engine/passes/vertex_light.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <glm/trigonometric.hpp>
#include <gtest/gtest.h>

#include "engine/passes/projector_share.h"
#include "geometry/mesher.h"
#include "tests/passes/room_builder.h"

namespace heliodon::passes {
namespace {

using geometry::PatchMesh;
using test::RoomBuilder;

// A slanted wall of uneven triangles: grid corners inside are moved about in the plane.
PatchMesh unevenWall(int n) {
    RoomBuilder b;
    b.wall({0, 0, 0}, {1, 0.2, 0}, {0, 0.5, 0.7}, n, n);
    std::mt19937 random(11);
    std::uniform_real_distribution<double> shift(-0.25 / n, 0.25 / n);
    for (glm::dvec3& v : b.mesh.vertices) {
        const double t = v.z / 0.7, s = v.x; // v = s u + t v
        if (s < 1e-9 || s > 1 - 1e-9 || t < 1e-9 || t > 1 - 1e-9) continue;
        v += shift(random) * glm::dvec3(1, 0.2, 0) + shift(random) * glm::dvec3(0, 0.5, 0.7);
    }
    return b.mesh;
}

glm::vec3 linearField(glm::dvec3 p) {
    return glm::vec3(glm::dvec3(3 + p.x + 0.5 * p.z, 2 - p.y, 5 + 2 * p.x - p.z));
}

TEST(VertexLight, linear_field_is_reproduced_to_the_border_and_corners) {
    const PatchMesh mesh = unevenWall(8);
    std::vector<glm::vec3> values;
    for (size_t p = 0; p < mesh.patchCount(); ++p)
        values.push_back(linearField(geometry::patchCentroid(mesh, p)));
    const VertexLight light(mesh);
    const auto atVertices = light.evaluate(values);
    for (size_t c = 0; c < mesh.corners.size(); ++c) {
        const glm::vec3 want = linearField(mesh.vertices[mesh.corners[c]]);
        // Weights are floats of size about one; a fit sums some ten of them.
        EXPECT_LT(glm::length(atVertices[light.ofCorner(c)] - want), 2e-5f) << c;
    }
}

TEST(VertexLight, values_do_not_cross_from_one_surface_to_the_next) {
    RoomBuilder b;
    b.box({0, 0, 0}, {1, 1, 1}, 4, [](int, int) { return test::kWhite; });
    std::vector<glm::vec3> values;
    for (size_t p = 0; p < b.mesh.patchCount(); ++p) values.emplace_back(float(b.mesh.surface[p]) + 1);
    const VertexLight light(b.mesh);
    const auto atVertices = light.evaluate(values);
    for (size_t p = 0; p < b.mesh.patchCount(); ++p)
        for (uint32_t c = b.mesh.firstCorner[p]; c < b.mesh.firstCorner[p + 1]; ++c)
            EXPECT_NEAR(atVertices[light.ofCorner(c)].x, values[p].x, 1e-4 * values[p].x);
}

TEST(VertexLight, a_steep_edge_never_gives_negative_light) {
    const PatchMesh mesh = unevenWall(6);
    std::vector<glm::vec3> values;
    for (size_t p = 0; p < mesh.patchCount(); ++p)
        values.emplace_back(geometry::patchCentroid(mesh, p).x < 0.4 ? 1000.0f : 0.0f);
    for (const glm::vec3& v : VertexLight(mesh).evaluate(values)) {
        EXPECT_GE(v.x, 0);
        EXPECT_LT(v.x, 2000); // and overshoots by less than the step
    }
}

// A lamp near the wall. Fits alone round its light off: they leave 13 % on average and lose 4 % in all.
TEST(VertexLight, each_patch_is_drawn_with_the_light_that_it_has) {
    const PatchMesh mesh = unevenWall(8);
    const glm::dvec3 lamp(0.4, 0.4, 0.05);
    std::vector<glm::vec3> values;
    for (size_t p = 0; p < mesh.patchCount(); ++p) {
        const glm::dvec3 d = geometry::patchCentroid(mesh, p) - lamp;
        values.emplace_back(static_cast<float>(1 / glm::dot(d, d)));
    }
    const VertexLight light(mesh);
    const auto atVertices = light.evaluate(values);
    double has = 0, drawn = 0, off = 0, area = 0;
    for (size_t p = 0; p < mesh.patchCount(); ++p) {
        double mean = 0;
        for (uint32_t c = mesh.firstCorner[p]; c < mesh.firstCorner[p + 1]; ++c)
            mean += double{atVertices[light.ofCorner(c)].x} / 3;
        const double a = geometry::patchArea(mesh, p), value = double{values[p].x};
        has += a * value, drawn += a * mean, off += a * (mean - value) * (mean - value), area += a;
    }
    EXPECT_NEAR(drawn / has, 1, 5e-3); // the top is not drawn higher than patches and fit say
    EXPECT_LT(std::sqrt(off / area), 0.04 * has / area);
}

TEST(VertexLight, lone_patches_and_slivers_keep_their_value) {
    PatchMesh mesh;
    mesh.materials = {{"white", glm::vec3(0.5f)}};
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 0, -1}, {5, 0, 0}, {6, 0, 0}, {7, 0, -1e-9}, {9, 0, 0}};
    mesh.addPatch(std::array{0u, 1u, 2u}, 0, geometry::Role::projection, 0, 0);
    mesh.addPatch(std::array{3u, 4u, 5u}, 0, geometry::Role::projection, 1, 0);
    mesh.addPatch(std::array{6u, 6u, 6u}, 0, geometry::Role::projection, 2, 0); // a point
    const VertexLight light(mesh);
    const std::vector<glm::vec3> values{glm::vec3(7), glm::vec3(8), glm::vec3(9)};
    const auto atVertices = light.evaluate(values);
    for (size_t c = 0; c < mesh.corners.size(); ++c)
        EXPECT_NEAR(atVertices[light.ofCorner(c)].x, 7.0 + double(c / 3), 1e-3);
}

// Centroids of one patch lie in one place but for rounding, which is no slope: such triangles would be drawn
// thousands of times as bright.
TEST(VertexLight, a_lone_patch_anywhere_keeps_its_value) {
    PatchMesh mesh;
    mesh.materials = {{"white", glm::vec3(0.5f)}};
    std::mt19937 random(5);
    std::uniform_real_distribution<double> place(-0.4, 0.4), size(0.001, 0.03);
    for (uint32_t i = 0; i < 3000; ++i) {
        const glm::dvec3 at(place(random), place(random), place(random));
        for (int k = 0; k < 3; ++k)
            mesh.vertices.push_back(at + glm::dvec3(size(random), size(random), size(random)));
        mesh.addPatch(std::array{3 * i, 3 * i + 1, 3 * i + 2}, 0, geometry::Role::projection, i, 0);
    }
    for (const glm::vec3& v :
         VertexLight(mesh).evaluate(std::vector<glm::vec3>(mesh.patchCount(), glm::vec3(7))))
        EXPECT_NEAR(v.x, 7, 1e-4);
}

TEST(VertexLight, indirect_light_leaves_out_the_first_bounce_of_the_sun) {
    PatchMesh mesh;
    mesh.materials = {{"red", {0.5f, 0.25f, 0}, glm::vec3(0), 1.52f, {10, 0, 0}}};
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 0, -1}};
    mesh.addPatch(std::array{0u, 1u, 2u}, 0, geometry::Role::projection, 0, 0);
    compute::Lighting light;
    light.exitance = {glm::vec3(10 + 0.5 * 300, 0.25 * 300, 0)}; // 100 indirect and 200 sun on the patch
    light.sunIlluminance = {glm::vec3(200)};
    EXPECT_NEAR(indirectExitance(mesh, light)[0].x, 60, 1e-4);
    const glm::vec3 illuminance = indirectIlluminance(mesh, light)[0];
    EXPECT_NEAR(illuminance.x, 100, 1e-3);
    EXPECT_NEAR(illuminance.y, 100, 1e-3);
    EXPECT_NEAR(illuminance.z, 100, 1e-3); // reflects nothing: the mean of the others
}

// The room's curved wall, radius 6 - 0.1875 in: facets turn by several degrees, what is drawn turns steadily.
TEST(ShownMesh, normals_of_a_curved_wall_turn_steadily_over_its_facets) {
    const geometry::Closure closure = geometry::closeSketch(
        geometry::readSketch(HELIODON_TEST_DATA "/geometry/sketches/p09_D_curved.json"));
    const geometry::PatchMesh mesh = geometry::meshBuilding(*closure.building);
    const DrawMesh shown = shownMesh(mesh, VertexLight(mesh), closure.building->occluders,
                                     geometry::readRig(HELIODON_SOURCE "/examples/rig.json"))
                               .mesh;
    constexpr double inch = geometry::kMetresPerInch, radius = (6 - 0.1875) * inch;
    const glm::dvec3 centre(3 * inch, 0, 0);
    double worstFacet = 0, worstSmooth = 0, facets = 0, smooth = 0; // degrees from the radius, and their sums
    size_t corners = 0;
    for (const DrawCorner& corner : shown.corners) {
        glm::dvec3 inward = centre - glm::dvec3(corner.position);
        inward.y = 0;
        const bool onArc = inward.x < -0.5 * inch && std::abs(glm::length(inward) - radius) < 0.05 * inch &&
                           std::abs(corner.normal.y) < 0.1;
        if (!onArc) continue;
        ++corners;
        inward = glm::normalize(inward);
        const auto off = [&](glm::vec3 n) {
            return glm::degrees(std::acos(std::min(1.0, glm::dot(inward, glm::dvec3(n)))));
        };
        facets += off(corner.normal);
        smooth += off(corner.smoothNormal);
        worstFacet = std::max(worstFacet, off(corner.normal));
        worstSmooth = std::max(worstSmooth, off(corner.smoothNormal));
    }
    EXPECT_GT(corners, 300u);
    EXPECT_GT(worstFacet, 4);
    EXPECT_LT(worstSmooth, 3.5); // at the wall's ends, where facets are on one side alone
    EXPECT_LT(smooth, 0.4 * facets);
}

} // namespace
} // namespace heliodon::passes
