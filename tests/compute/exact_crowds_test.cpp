// Kernel `exact` where many blockers stand between two patches.
#include <cmath>
#include <random>
#include <span>
#include <stdexcept>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "compute/exact_form_factors.h"
#include "compute/exact_scene.h"
#include "compute/reference/exact_form_factors.h"
#include "compute/reference/form_factor_rows.h"
#include "compute/refinement_forecast.h"
#include "tests/compute/rooms.h"
#include "tests/gpu/test_device.h"
#include "tests/sanitized.h"

namespace heliodon::compute {
namespace {

using glm::dvec3;

std::vector<float> matrixOf(const geometry::PatchMesh& mesh, const ExactOptions& options,
                            ExactStatistics* statistics = nullptr) {
    const ExactFormFactors result = exactFormFactors(test::device(), mesh, options);
    if (statistics) *statistics = result.statistics;
    return result.factors.values.download<float>(mesh.patchCount() * mesh.patchCount());
}

// Two unit squares a metre apart and loose triangles between them, which hide about a fifth.
geometry::PatchMesh crowd(uint32_t triangles) {
    std::vector<std::vector<dvec3>> faces{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                                          {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}}};
    std::mt19937 random(triangles);
    std::uniform_real_distribution<double> unit(-1, 1);
    const double size = 0.45 / std::sqrt(triangles);
    for (uint32_t k = 0; k < triangles; ++k) {
        const dvec3 middle(0.5 + 0.4 * unit(random), 0.5 + 0.4 * unit(random), 0.5 + 0.3 * unit(random));
        std::vector<dvec3> corners;
        for (int c = 0; c < 3; ++c)
            corners.push_back(middle + size * dvec3(unit(random), unit(random), unit(random)));
        if (glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0])) < 0.1 * size * size)
            continue;
        faces.push_back(corners);
    }
    return test::polygons(faces);
}

// More than 64 once were forgotten. The reference clips polygons in double precision.
TEST(ExactCrowds, light_past_hundreds_of_loose_triangles_agrees_with_the_reference) {
    for (uint32_t triangles : {80u, 160u}) {
        if (test::kSanitized && triangles > 80) continue;
        const geometry::PatchMesh mesh = crowd(triangles);
        const double truth = reference::exchangeIn(mesh, 0, 1, 1e-4, 16).value;
        EXPECT_LT(truth, 0.185) << "hidden in part"; // 0.1998 in the open
        const std::vector<float> F = matrixOf(mesh, {.maxError = 1e-3});
        EXPECT_NEAR(F[1], truth, 1e-3) << triangles << " triangles";
        EXPECT_NEAR(F[1], F[mesh.patchCount()], 1e-7);
    }
}

// What cells behind crowds err by adds up as squares: claims were twice what was asked, of ten times the
// error.
TEST(ExactCrowds, claims_are_within_what_is_asked) {
    const ExactFormFactors F = exactFormFactors(test::device(), crowd(160), {.maxError = 1e-3});
    EXPECT_LT(F.factors.report.claimedRowError, 4e-4);
}

// Two unit squares a metre apart and, half-way, across x across squares.
void addScreenedPair(std::vector<std::vector<dvec3>>& faces, double x, int across) {
    faces.push_back({{x, 0, 0}, {x + 1, 0, 0}, {x + 1, 1, 0}, {x, 1, 0}});
    faces.push_back({{x, 0, 1}, {x, 1, 1}, {x + 1, 1, 1}, {x + 1, 0, 1}});
    const double pitch = 1.0 / across, side = 0.7 * pitch;
    for (int k = 0; k < across * across; ++k) {
        const dvec3 corner(x + pitch * (k % across) + 0.15 * pitch, pitch * (k / across) + 0.15 * pitch, 0.5),
            u(side, 0, 0), v(0, side, 0);
        faces.push_back({corner, corner + u, corner + u + v, corner + v});
    }
}

// Points behind few blockers look along more lines than those behind many, which software devices hold to one
// number of turns of their loops (shaders/lib/loop_limit.glsl).
TEST(ExactCrowds, pairs_behind_many_and_behind_few_blockers_do_not_cut_each_other_short) {
    std::vector<std::vector<dvec3>> faces;
    addScreenedPair(faces, 0, 30);
    addScreenedPair(faces, 3, 12);
    const geometry::PatchMesh mesh = test::polygons(faces);
    const std::vector<float> F = matrixOf(mesh, {.maxError = 1e-3});
    const size_t other = 2 + 30 * 30;
    const double passes = 0.1998 * (1 - 0.7 * 0.7);
    EXPECT_NEAR(F[1], passes, 2e-3); // a screen so fine hides its share of the light
    EXPECT_NEAR(F[other * mesh.patchCount() + other + 1], passes, 2e-3);
}

// Few large patches behind many blockers are cut where little error is asked: each point of a part has less
// between. Rows of patches stay whole.
TEST(ExactCrowds, large_patches_behind_crowds_are_cut_where_little_error_is_asked) {
    const geometry::PatchMesh mesh = crowd(20);
    const double truth = reference::exchangeIn(mesh, 0, 1, 1e-5, 16).value;
    ExactStatistics loose, fine;
    matrixOf(mesh, {.maxError = 2e-4}, &loose);
    const std::vector<float> F = matrixOf(mesh, {.maxError = 1e-4}, &fine);
    EXPECT_NEAR(F[1], truth, 1e-4); // as asked of rows
    EXPECT_NEAR(F[1], F[mesh.patchCount()], 1e-7);
    EXPECT_GT(fine.partial, 20 * loose.partial) << "pairs of parts";
    const geometry::PatchMesh boards = crowd(130); // as twenty boards in a room, 126 faces
    ASSERT_GT(boards.patchCount(), 120u);
    EXPECT_GT(exactScene(test::device(), boards, 2304, true).pieceCount, 2 * boards.patchCount());
}

// Narrow faces of boards, whose few points would err alike towards all of a wall; however many, the matrix of
// parts stays small.
TEST(ExactCrowds, needles_behind_crowds_are_cut_across) {
    geometry::PatchMesh mesh = crowd(20);
    const auto addWire = [&](dvec3 corner, double length) {
        const auto v = static_cast<uint32_t>(mesh.vertices.size());
        for (const dvec3& p :
             {dvec3(0, 0, 0), dvec3(length, 0, 0), dvec3(length, 1e-3, 0), dvec3(0, 1e-3, 0)})
            mesh.vertices.push_back(corner + p);
        mesh.addPatch(std::vector{v, v + 1, v + 2, v + 3}, 0, geometry::Role::projection, 0, 0);
    };
    const auto wire = static_cast<uint32_t>(mesh.patchCount());
    addWire({0.1, 0.5, 0.5}, 0.8);
    const ExactScene scene = exactScene(test::device(), mesh, 2304, true);
    double longest = 0;
    for (const RadiatingPiece& piece : scene.pieces)
        if (piece.patch == wire)
            longest = std::max(longest, glm::distance(piece.corners[0], piece.corners[1]));
    EXPECT_GT(longest, 0);
    EXPECT_LT(longest, 0.11);
    for (int k = 0; k < 70; ++k) addWire({0.1, 0.012 * k, 2}, 10);
    EXPECT_LE(exactScene(test::device(), mesh, 2304, true).pieceCount, 2000u);
}

// Errors of the parts of a patch do not add up: claims as if they did would be eighty times what is asked.
TEST(ExactCrowds, entries_of_cut_patches_keep_claims_that_are_not_large) {
    constexpr double kAsked = 1e-4, kOracle = 1e-5;
    const geometry::PatchMesh mesh = crowd(20);
    const size_t n = mesh.patchCount();
    const ExactFormFactors F =
        exactFormFactors(test::device(), mesh, {.maxError = kAsked, .entryErrors = true});
    const std::vector<float> values = F.factors.values.download<float>(n * n);
    const reference::FormFactorRows oracle(mesh);
    size_t entries = 0, held = 0;
    double claims = 0;
    for (size_t i = 0; i < n; i += 3) {
        const std::vector<double> truth = oracle.row(i, kOracle, 400).factors;
        for (size_t j = 0; j < n; ++j) {
            const double value = double{values[i * n + j]}, claim = double{F.entryError[i * n + j]};
            claims += claim * claim;
            if (value > 0 || truth[j] > 0)
                ++entries, held += std::abs(value - truth[j]) <= claim + kOracle ? 1 : 0;
        }
    }
    EXPECT_GE(static_cast<double>(held), 0.99 * static_cast<double>(entries));
    EXPECT_GT(entries, 50u);
    EXPECT_LT(std::sqrt(claims / std::ceil(static_cast<double>(n) / 3)), 12 * kAsked);
}

// Each of 1000 cells becomes two, of which each becomes one that splits no more.
TEST(ExactCrowds, what_refinement_has_left_follows_from_what_cells_have_become) {
    RefinementForecast forecast(1000);
    forecast.step(0, 100, 200);
    EXPECT_EQ(forecast.workLeft(), 0) << "nothing timed yet";
    forecast.step(1, 200, 200);
    forecast.step(2, 200, 0);
    // 900 cells, 1800 and 1800 more, over the last 400.
    EXPECT_DOUBLE_EQ(forecast.workLeft(), 4500.0 / 400);
}

TEST(ExactCrowds, parts_to_come_are_expected_to_take_as_long_as_those_before) {
    PartsForecast forecast;
    forecast.begin(0.2);
    EXPECT_EQ(forecast.secondsLeft(10), 10) << "the first may have made kernels";
    forecast.begin(0.1);
    EXPECT_GE(forecast.secondsLeft(10), 80) << "0.8 of all, of which this is 0.1";
}

TEST(ExactCrowds, long_work_is_told_of) {
    std::vector<double> told; // seconds
    ExactOptions options{.maxError = 1e-4};
    options.longWork = [&](double seconds) { told.push_back(seconds); };
    const std::vector<float> quietly = matrixOf(crowd(20), options);
    EXPECT_TRUE(told.empty()) << "a second of work";
    options.longFrom = 0;
    EXPECT_EQ(matrixOf(crowd(20), options), quietly);
    ASSERT_FALSE(told.empty());
    EXPECT_GT(told[0], 0);
}

TEST(ExactCrowds, long_work_is_told_of_by_streams_too) {
    size_t told = 0, tiles = 0;
    FormFactorOptions options{.kernel = "exact", .maxError = 1e-4};
    options.longWork = [&](double) { ++told; };
    options.longFrom = 0;
    streamFormFactors(test::device(), crowd(20), options, [&](const FormFactorTile&) { ++tiles; });
    EXPECT_GT(told, 0u);
    EXPECT_EQ(tiles, 1u);
}

// A hall of hanging posts: closed, so every row sums to one.
TEST(ExactCrowds, no_light_is_lost_or_won_among_posts) {
    for (bool triangles : {false, true}) {
        geometry::PatchMesh mesh =
            test::boxRoom({.low = {0, 0, 0}, .high = {10, 3, 8}, .cells = {3, 1, 3}, .triangles = triangles});
        const size_t room = mesh.corners.size();
        for (int i = 0; i < 8; ++i)
            for (int k = 0; k < 6; ++k) {
                const dvec3 low(0.8 + 1.1 * i + 0.07 * k, 0.1, 0.9 + 1.15 * k - 0.05 * i);
                test::addBox(mesh, {.low = low,
                                    .high = low + dvec3(0.08, 2.8, 0.09),
                                    .cells = {1, 1, 1},
                                    .triangles = false});
            }
        std::reverse(mesh.corners.begin() + static_cast<long>(room),
                     mesh.corners.end()); // posts face outwards
        const size_t n = mesh.patchCount();
        const std::vector<float> F = matrixOf(mesh, {.maxError = 5e-3});
        double squares = 0, all = 0;
        for (size_t i = 0; i < n; ++i) {
            double sum = -1;
            for (size_t j = 0; j < n; ++j) sum += double{F[i * n + j]};
            squares += sum * sum;
            all += sum;
        }
        EXPECT_LT(std::sqrt(squares / static_cast<double>(n)), 8e-3);
        EXPECT_LT(std::abs(all / static_cast<double>(n)), 1e-3); // errors that do not conspire
    }
}

// Boards in rows across a room of six faces: of a wall beside them each sees what is about its foot, which equal
// strips of the whole wall passed by (rows off by 0.1).
TEST(ExactCrowds, walls_are_seen_where_boards_stand_near_them) {
    geometry::PatchMesh mesh =
        test::boxRoom({.low = {0, 0, 0}, .high = {6, 3, 4}, .cells = {1, 1, 1}, .triangles = false});
    const size_t room = mesh.corners.size();
    for (int level = 0; level < 2; ++level)
        for (int row = 0; row < 4; ++row)
            for (int i = 0; i < 5; ++i) {
                const dvec3 low(0.01 + 0.3 * i, 0.5 + 1.1 * level, 0.01 + 1.22 * row);
                test::addBox(mesh, {.low = low,
                                    .high = low + dvec3(0.02, 0.2, 0.3),
                                    .cells = {1, 1, 1},
                                    .triangles = false});
            }
    std::reverse(mesh.corners.begin() + static_cast<long>(room), mesh.corners.end()); // boards face outwards
    const size_t n = mesh.patchCount();
    const ExactFormFactors result = exactFormFactors(test::device(), mesh, {.maxError = 5e-3});
    const std::vector<float> F = result.factors.values.download<float>(n * n);
    double squares = 0;
    for (size_t i = 0; i < n; ++i) {
        double sum = -1;
        for (size_t j = 0; j < n; ++j) sum += double{F[i * n + j]};
        EXPECT_NEAR(sum, 0, 2e-2) << i;
        squares += sum * sum;
    }
    EXPECT_LT(std::sqrt(squares / static_cast<double>(n)), 4e-3);
    // By which `auto` goes on: of crowds claims are not so far above the errors as elsewhere.
    EXPECT_LT(result.factors.report.caution, 2);
    EXPECT_GT(exactFormFactors(test::device(), crowd(3), {.maxError = 5e-3}).factors.report.caution, 4);
}

geometry::PatchMesh roomWithSlab(bool triangles) {
    geometry::PatchMesh mesh =
        test::boxRoom({.low = {0, 0, 0}, .high = {4, 3, 4}, .cells = {4, 3, 4}, .triangles = triangles});
    const size_t room = mesh.corners.size();
    test::addBox(
        mesh, {.low = {1.5, 0.02, 0.1}, .high = {1.6, 2.98, 3}, .cells = {1, 1, 2}, .triangles = triangles});
    std::reverse(mesh.corners.begin() + static_cast<long>(room), mesh.corners.end()); // facing outwards
    return mesh;
}

// Rounds of few blockers and of few cells.
TEST(ExactCrowds, little_memory_gives_the_same_bits_with_exact_borders) {
    const geometry::PatchMesh mesh = roomWithSlab(false);
    ExactStatistics much, little;
    EXPECT_EQ(matrixOf(mesh, {.maxError = 2e-3}, &much),
              matrixOf(mesh, {.maxError = 2e-3, .workBytes = 10000}, &little));
    EXPECT_EQ(much.windows, 1u);
    EXPECT_GT(little.windows, 1u);
    EXPECT_GT(little.depthFirstSteps, 1u);
    EXPECT_EQ(little.cells, much.cells);
    for (uint64_t bytes : {0u, 1u, 100u})
        EXPECT_THROW(matrixOf(mesh, {.maxError = 2e-3, .workBytes = bytes}), std::runtime_error);
}

// With lines each round estimates what its pairs may err.
TEST(ExactCrowds, little_memory_keeps_the_error_asked_with_lines) {
    const geometry::PatchMesh mesh = roomWithSlab(true);
    const ExactOptions little{.maxError = 1e-3, .workBytes = 60000};
    ExactStatistics statistics;
    const std::vector<float> fine = matrixOf(mesh, {.maxError = 1e-4}),
                             F = matrixOf(mesh, little, &statistics);
    EXPECT_GT(statistics.windows, 1u);
    EXPECT_EQ(F, matrixOf(mesh, little)) << "windows hold what they held";
    double squares = 0;
    for (size_t k = 0; k < F.size(); ++k) squares += std::pow(double{F[k]} - double{fine[k]}, 2);
    EXPECT_LT(std::sqrt(squares / static_cast<double>(mesh.patchCount())), 1e-3);
    EXPECT_GT(squares, 0) << "the same twice";
}

} // namespace
} // namespace heliodon::compute
