#include "compute/hemicube.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "compute/form_factors.h"
#include "compute/reference/hemicube.h"
#include "geometry/input_error.h"
#include "tests/compute/rooms.h"
#include "tests/gpu/test_device.h"

namespace heliodon::compute {
namespace {

using test::BoxRoom;

TEST(Hemicube, pixels_of_any_even_resolution_sum_to_one) {
    for (uint32_t R : {2u, 6u, 64u, 128u}) {
        const std::vector<double> deltas = hemicubeDeltas(R);
        double sum = 0;
        for (size_t i = 0; i < deltas.size(); ++i) sum += deltas[i] * (i < size_t{R} * R ? 1 : 4);
        EXPECT_NEAR(sum, 1, 1e-12);
    }
}

// Sum of |kernel - reference| over a row: float32 edges move a pixel's middle across an edge now and then, a
// few pixels of 3 R^2, more of them where a grid happens to line up with the walls.
void expectLikeReference(const geometry::PatchMesh& mesh, uint32_t R, double tolerance) {
    Hemicube hemicube(test::device(), mesh, {R});
    const PatchViewpoints views = patchViewpoints(mesh, 1);
    const size_t n = mesh.patchCount();
    const auto F = hemicube.run(views.viewpoints).factors.download<float>(n * n);
    for (size_t i = 0; i < n; ++i) {
        const reference::HemicubeRow row = reference::hemicubeRow(mesh, views.viewpoints[i], R);
        double difference = 0;
        for (size_t j = 0; j < n; ++j) difference += std::abs(F[i * n + j] - row.factors[j]);
        EXPECT_LT(difference, tolerance) << "row " << i;
    }
}

TEST(Hemicube, agrees_with_the_reference_in_a_room) {
    expectLikeReference(test::boxRoom({}), 16, 0.02);
}

TEST(Hemicube, agrees_with_the_reference_in_two_rooms) {
    BoxRoom box;
    box.cells = {2, 2, 2};
    geometry::PatchMesh mesh = test::boxRoom(box);
    BoxRoom inner;
    inner.low = {1, 1, 1}, inner.high = {3, 2, 3};
    inner.cells = {1, 2, 1};
    inner.triangles = false;
    test::addBox(mesh, inner, 1); // lies inside the other, yet in a room of its own
    expectLikeReference(mesh, 10, 0.02);
}

// From patches the backs of a solid are not drawn; within it, they are all that there is.
TEST(Hemicube, within_a_solid_its_backs_hide_the_room) {
    geometry::PatchMesh mesh = test::boxRoom({});
    const size_t room = mesh.corners.size(), first = mesh.patchCount();
    test::addBox(mesh, {.low = {1, 1, 1}, .high = {2, 2, 2}, .cells = {1, 1, 1}});
    std::reverse(mesh.corners.begin() + static_cast<long>(room), mesh.corners.end()); // it faces outwards
    Hemicube hemicube(test::device(), mesh);
    const std::vector<Viewpoint> views{{.position = {1.5, 1.5, 1.5}},
                                       patchViewpoints(mesh, 1, 0, 1).viewpoints[0]};
    const size_t n = mesh.patchCount();
    const std::vector<float> seen = hemicube.run(views).factors.download<float>(2 * n);
    EXPECT_EQ(std::accumulate(seen.begin(), seen.begin() + static_cast<long>(n), 0.0f), 0.0f);
    EXPECT_NEAR(std::accumulate(seen.begin() + static_cast<long>(n), seen.end(), 0.0f), 1.0f, 1e-5f);
    EXPECT_GT(std::accumulate(seen.begin() + static_cast<long>(n + first), seen.end(), 0.0f), 0.0f);
}

TEST(Hemicube, agrees_with_the_reference_among_random_triangles_that_cross_every_horizon) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> at(-1, 1);
    std::vector<std::vector<glm::dvec3>> faces;
    for (int i = 0; i < 67; ++i) {
        std::vector<glm::dvec3> face;
        for (int k = 0; k < 3; ++k) face.push_back({at(random), at(random), at(random)});
        faces.push_back(face);
    }
    expectLikeReference(test::polygons(faces), 32, 0.01);
}

TEST(PatchViewpoints, spread_evenly_over_polygons_of_any_number_of_corners) {
    // Means of x, z and their squares over regular polygons and a stretched one: those of the area.
    for (size_t corners : {3u, 4u, 5u, 7u, 12u})
        for (double stretch : {1.0, 9.0}) {
            std::vector<glm::dvec3> face;
            for (size_t k = 0; k < corners; ++k) {
                const double turn =
                    -2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(corners);
                face.push_back({stretch * std::cos(turn), 0, std::sin(turn)});
            }
            const PatchViewpoints views = patchViewpoints(test::polygons({face}), 1024);
            ASSERT_EQ(views.viewpoints.size(), 1024u);
            glm::dvec3 mean(0), square(0);
            for (const Viewpoint& v : views.viewpoints)
                mean += v.position / 1024.0, square += v.position * v.position / 1024.0;
            // Of a regular polygon: radius^2 / 12 (2 + cos(2 pi / n)) about either axis.
            const double expected = (2 + std::cos(2 * std::numbers::pi / static_cast<double>(corners))) / 12;
            EXPECT_NEAR(mean.x / stretch, 0, 0.01) << corners;
            EXPECT_NEAR(mean.z, 0, 0.01) << corners;
            EXPECT_NEAR(square.x / (stretch * stretch), expected, 0.01) << corners;
            EXPECT_NEAR(square.z, expected, 0.01) << corners;
        }
}

// Rows as their points see them.
std::vector<float> rawRows(const geometry::PatchMesh& mesh, uint32_t resolution, uint32_t points = 1) {
    const PatchViewpoints views = patchViewpoints(mesh, points);
    const size_t n = mesh.patchCount();
    return Hemicube(test::device(), mesh, {resolution})
        .run(views.viewpoints, views.pointsPerPatch)
        .factors.download<float>(n * n);
}

void expectClosed(const std::vector<float>& F, size_t n) {
    for (size_t i = 0; i < F.size() / n; ++i)
        // Cracks between triangles of at most one pixel, 1/12288 of the hemisphere at 64 x 64.
        EXPECT_NEAR(std::accumulate(&F[i * n], &F[i * n] + n, 0.0), 1, 1e-4);
}

TEST(Hemicube, rows_sum_to_one_in_a_closed_box) {
    const geometry::PatchMesh mesh = test::boxRoom({});
    expectClosed(rawRows(mesh, 64), mesh.patchCount());
}

TEST(Hemicube, long_lines_of_few_large_triangles_are_filled_to_the_end) {
    BoxRoom box;
    box.cells = {1, 1, 1};
    const geometry::PatchMesh mesh = test::boxRoom(box);
    expectClosed(rawRows(mesh, 512), mesh.patchCount());
}

// More pixels, or layers of triangles, than one workgroup has turns of loops for
// (shaders/lib/loop_limit.glsl).
TEST(Hemicube, rows_of_millions_of_pixels_sum_to_one_in_a_closed_box) {
    BoxRoom box;
    box.cells = {5, 4, 6};
    const geometry::PatchMesh mesh = test::boxRoom(box);
    const std::vector<Viewpoint> views = patchViewpoints(mesh, 1, 40, 2).viewpoints;
    for (const uint32_t R : {1024u, 2048u})
        expectClosed(
            Hemicube(test::device(), mesh, {R}).run(views).factors.download<float>(2 * mesh.patchCount()),
            mesh.patchCount());
}

TEST(Hemicube, of_many_large_sheets_only_the_nearest_is_seen) {
    constexpr int kSheets = 1279; // with the floor twenty triangles for each lane of a workgroup
    std::vector<std::vector<glm::dvec3>> faces{{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}};
    for (int k = kSheets; k >= 1; --k) { // they face down, and the nearest is the last to be drawn
        const double y = 0.5 + 0.001 * k;
        faces.push_back({{-9, y, -9}, {9, y, -9}, {9, y, 9}, {-9, y, 9}});
    }
    const geometry::PatchMesh mesh = test::polygons(faces);
    const std::vector<float> F = Hemicube(test::device(), mesh, {128})
                                     .run(patchViewpoints(mesh, 1, 0, 1).viewpoints)
                                     .factors.download<float>(mesh.patchCount());
    EXPECT_NEAR(F[kSheets], 1, 0.01);
    for (size_t j = 0; j < kSheets; ++j) EXPECT_NEAR(F[j], 0, 0.01) << j;
}

TEST(Hemicube, unit_squares_have_their_closed_form_factors) {
    // Opposed at distance 1: 0.199825; sharing an edge at right angles: 0.200044 (Howell C-11, C-14).
    const geometry::PatchMesh mesh = test::polygons({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}},
                                                     {{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}},
                                                     {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}});
    const std::vector<float> values = rawRows(mesh, 128, 64);
    EXPECT_NEAR(values[1], 0.199825,
                1e-3); // 8 x 8 points on the square: midpoint rule, error about 1/(24 * 64)
    EXPECT_NEAR(values[2], 0.200044, 4e-3); // the same rule beside the shared edge
    EXPECT_NEAR(values[3], values[1], 1e-3);
    EXPECT_EQ(values[0], 0.0f);
}

TEST(Hemicube, back_sides_block_and_receive_nothing) {
    // A floor patch under a plate that looks away from it.
    const geometry::PatchMesh mesh =
        test::polygons({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}},
                        {{-1, 0.5, -1}, {-1, 0.5, 2}, {2, 0.5, 2}, {2, 0.5, -1}}, // faces up
                        {{-9, 1, -9}, {9, 1, -9}, {9, 1, 9}, {-9, 1, 9}}});       // faces down
    const std::vector<float> F = rawRows(mesh, 64);
    EXPECT_EQ(F[1], 0.0f);
    const auto seen = reference::hemicubeRow(mesh, patchViewpoints(mesh, 1).viewpoints[0], 64);
    EXPECT_NEAR(F[2], seen.factors[2], 1e-3);
    EXPECT_LT(F[2], 0.4f);
}

TEST(Hemicube, the_same_bits_on_every_run) {
    const geometry::PatchMesh mesh = test::boxRoom({});
    EXPECT_EQ(rawRows(mesh, 64), rawRows(mesh, 64));
}

TEST(Hemicube, empty_and_single_patch_meshes_are_no_special_case) {
    EXPECT_TRUE(rawRows(test::polygons({}), 64).empty());
    const auto one = test::polygons({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}}});
    EXPECT_EQ(rawRows(one, 64)[0], 0.0f);
}

// What is left open of a hall's form factor to the speck is a million million times as much the other way
// round.
TEST(FormFactors, no_hemicube_claims_that_rows_are_off_by_more_than_one) {
    geometry::PatchMesh mesh = test::boxRoom({.low = {0, 0, 0}, .high = {10, 10, 10}, .cells = {2, 2, 2}});
    const size_t hall = mesh.corners.size();
    test::addBox(mesh, {.low = {5, 4, 5}, .high = {5.00001, 4.00001, 5.00001}, .cells = {1, 1, 1}});
    std::reverse(mesh.corners.begin() + static_cast<long>(hall), mesh.corners.end()); // it faces outwards
    FormFactorOptions options;
    options.kernel = "hemicube";
    options.maxError = 1e-3;
    const FormFactorReport report = computeFormFactors(test::device(), mesh, options).report;
    EXPECT_LE(report.claimedRowError, 1);
    EXPECT_LE(report.claimedRowSumError, 1);
}

// Walls miss a die of a centimetre with most of their pixels: nothing to hold against what the die itself
// sees.
TEST(FormFactors, hemicubes_of_halls_with_a_die_claim_no_more_than_thrice_their_error) {
    geometry::PatchMesh mesh = test::boxRoom({.low = {0, 0, 0}, .high = {10, 10, 10}, .cells = {3, 3, 3}});
    const size_t hall = mesh.corners.size();
    for (const double x : {3.0, 5.0, 6.5})
        test::addBox(mesh, {.low = {x, 4, 5}, .high = {x + 0.01, 4.01, 5.01}, .cells = {1, 1, 1}});
    std::reverse(mesh.corners.begin() + static_cast<long>(hall), mesh.corners.end()); // they face outwards
    const size_t n = mesh.patchCount();
    FormFactorOptions options;
    options.kernel = "hemicube";
    const FormFactors hemicube = computeFormFactors(test::device(), mesh, options);
    options.kernel = "exact";
    options.maxError = 1e-4;
    const std::vector<float> F = hemicube.values.download<float>(n * n),
                             exact = computeFormFactors(test::device(), mesh, options)
                                         .values.download<float>(n * n);
    double squares = 0;
    for (size_t k = 0; k < n * n; ++k) squares += std::pow(double{F[k]} - double{exact[k]}, 2);
    const double error = std::sqrt(squares / static_cast<double>(n));
    EXPECT_LT(hemicube.report.claimedRowError, 3 * error);
    EXPECT_GT(hemicube.report.claimedRowError, error / 1.6);
}

// Among triangles that hide each other 64 pixels err about as much as 32 do, where four points do not.
TEST(FormFactors, hemicubes_take_more_points_where_more_pixels_do_not_help) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> middle(0, 4), corner(-1, 1);
    std::vector<std::vector<glm::dvec3>> faces;
    for (int i = 0; i < 60; ++i) {
        const double x = middle(random), y = middle(random), z = middle(random);
        std::vector<glm::dvec3> face;
        for (int k = 0; k < 3; ++k) {
            const double dx = corner(random), dy = corner(random), dz = corner(random);
            face.push_back({x + dx, y + dy, z + dz});
        }
        faces.push_back(face);
    }
    FormFactorOptions options;
    options.kernel = "hemicube";
    options.maxError = 2e-3;
    const FormFactorReport report = computeFormFactors(test::device(), test::polygons(faces), options).report;
    EXPECT_LE(report.claimedRowError, options.maxError) << report.why;
}

TEST(FormFactors, unknown_kernels_are_refused_by_name) {
    FormFactorOptions options;
    options.kernel = "guess";
    EXPECT_THROW(computeFormFactors(test::device(), test::boxRoom({}), options), geometry::InputError);
}

} // namespace
} // namespace heliodon::compute
