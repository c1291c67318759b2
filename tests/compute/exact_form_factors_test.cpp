#include "compute/exact_form_factors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "compute/contour_exchange.h"
#include "compute/convex_regions.h"
#include "compute/parallel.h"
#include "compute/reference/form_factor_rows.h"
#include "geometry/model_file.h"
#include "shaders/io/exact_form_factors.io.h"
#include "tests/compute/form_factor_cases.h"
#include "tests/compute/rooms.h"
#include "tests/gpu/test_device.h"
#include "tests/sanitized.h"

namespace heliodon::compute {
namespace {

std::vector<float> matrixOf(const geometry::PatchMesh& mesh, double maxError) {
    const ExactFormFactors result = exactFormFactors(test::device(), mesh, {maxError});
    return result.factors.values.download<float>(mesh.patchCount() * mesh.patchCount());
}

// 1e-6: what float32 leaves of Lambert's formula (about 3e-7) and the cubature asked for. One room each:
// rooms do not see one another.
TEST(ExactFormFactors, unoccluded_pairs_agree_with_closed_forms) {
    const auto cases = test::formFactorCases("unoccluded");
    std::vector<reference::Polygon> polygons;
    for (const auto& c : cases) polygons.insert(polygons.end(), c.polygons.begin(), c.polygons.end());
    geometry::PatchMesh mesh = test::meshOf(polygons);
    for (size_t i = 0; i < mesh.patchCount(); ++i) mesh.room[i] = static_cast<uint32_t>(i / 2);
    const std::vector<float> F = matrixOf(mesh, 5e-7);
    const size_t n = mesh.patchCount();
    for (size_t k = 0; k < cases.size(); ++k)
        for (const auto& f : cases[k].entries) {
            const float value = F[(2 * k + f.i) * n + 2 * k + f.j];
            if (f.value == 0) {
                EXPECT_EQ(value, 0.0f) << cases[k].name;
            }
            EXPECT_NEAR(value, f.value, 1e-6) << cases[k].name << " " << f.i << " " << f.j;
        }
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < n; ++j)
            if (i / 2 != j / 2) {
                ASSERT_EQ(F[i * n + j], 0.0f);
            }
}

// Their width is a few hundred roundings of a coordinate.
TEST(ExactFormFactors, slivers_askew_agree_with_the_reference) {
    const reference::Polygon square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    for (int k = 0; k < 6; ++k) {
        const glm::dvec3 along = glm::normalize(glm::dvec3(std::cos(1.0 + k), std::sin(2.0 + 3 * k), 0.3)),
                         across = 1e-4 * glm::normalize(glm::cross(along, glm::dvec3(k - 2.5, 1, 0.2))),
                         corner(0.3, 0.4, 0.5);
        const reference::Polygon sliver{corner, corner + along, corner + along + across, corner + across};
        const geometry::PatchMesh mesh = test::meshOf({square, sliver});
        const double exchange = reference::exchangeIn(mesh, 0, 1).value;
        const std::vector<float> F = matrixOf(mesh, 1e-7);
        EXPECT_NEAR(F[2], exchange / reference::polygonArea(sliver), 1e-7) << k;
        EXPECT_NEAR(F[1], exchange, 1e-10) << k;
    }
}

// Directions in float32 err by much of a needle's width over its length.
TEST(ExactFormFactors, needles_that_share_an_edge_agree_with_the_reference) {
    const glm::dvec3 from(1.3, -0.4, 0.7);
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 along = glm::normalize(glm::dvec3(std::cos(1.0 + k), std::sin(2.0 + 3 * k), 0.3)),
                         across = glm::normalize(glm::cross(along, glm::dvec3(k - 2.5, 1, 0.2))),
                         up = glm::cross(along, across);
        const double angle = 0.5 + 0.3 * k;
        const glm::dvec3 inner = std::cos(angle) * across - std::sin(angle) * up;
        const reference::Polygon needle{from + 0.6 * along + 3e-4 * across, from + along, from},
            other{from, from + along, from + 0.4 * along + 1e-3 * inner};
        const ExactFormFactors result =
            exactFormFactors(test::device(), test::meshOf({needle, other}), {1e-6});
        const double exchange = reference::exchangeUnoccluded(needle, other);
        EXPECT_NEAR(result.factors.values.download<float>(4)[1], exchange / reference::polygonArea(needle),
                    1e-7)
            << k;
        EXPECT_EQ(result.statistics.cells, 0u);
    }
}

// Nothing of them is left to be integrated.
TEST(ExactFormFactors, sheets_that_cover_each_other_send_all_light_across) {
    const geometry::PatchMesh mesh = test::meshOf({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                                                   {{0, 0, 1e-6}, {0, 1, 1e-6}, {1, 1, 1e-6}, {1, 0, 1e-6}}});
    EXPECT_NEAR(matrixOf(mesh, 1e-6)[1], 1 - 2e-6, 3e-6);
}

// Of errors that come of rounding: devices may divide less exactly than software does.
double roundingOf(double software) {
    return test::device().info().type == "software" ? software : 2.5 * software;
}

// Each cell of the wall carries less than 1e-11. What remains: shadows' borders are good to 5e-7 of the
// distance.
TEST(ExactFormFactors, slivers_and_walls_behind_slivers_lose_no_light) {
    const reference::Polygon sliver{{0, 0, 0}, {1, 0, 0}, {0, 1e-4, 0}},
        blocker{{0.45, -0.7, 0.03}, {0.45, 0.3, 0.03}, {0.45, -0.7, 0.0301}},
        wall{{-0.5, -2, 1.8}, {1, -0.5, 1.8}, {1, -2, 1.8}};
    const geometry::PatchMesh mesh = test::meshOf({sliver, wall, blocker});
    const double exchange = reference::exchangeIn(mesh, 0, 1, 1e-8).value;
    EXPECT_NEAR(matrixOf(mesh, 3e-6)[1], exchange / reference::polygonArea(sliver), roundingOf(1e-5));
}

TEST(ExactFormFactors, occluded_pairs_agree_with_split_tensor_cubature) {
    for (const auto& c : test::formFactorCases("occluded")) {
        const std::vector<float> F = matrixOf(test::meshOf(c.polygons), 2e-5);
        for (const auto& f : c.entries)
            EXPECT_NEAR(F[f.i * c.polygons.size() + f.j], f.value, 1e-5)
                << c.name << " " << f.i << " " << f.j;
    }
}

TEST(ExactFormFactors, enclosures_close_without_normalisation) {
    for (const auto& c : test::formFactorCases("enclosure")) {
        const size_t n = c.polygons.size();
        const std::vector<float> F = matrixOf(test::meshOf(c.polygons), 3e-6);
        for (const auto& f : c.entries)
            EXPECT_NEAR(F[f.i * n + f.j], f.value, 3e-6) << c.name << " " << f.i << " " << f.j;
        for (size_t i = 0; i < n; ++i) {
            double sum = 0;
            for (size_t j = 0; j < n; ++j) sum += F[i * n + j];
            EXPECT_NEAR(sum, 1, 1e-5) << c.name << " row " << i;
        }
    }
}

// A room with three partitions against exact visible polygons on nets of points (standard error 7e-6 an
// entry).
TEST(ExactFormFactors, room_with_partitions_agrees_with_reference_rows) {
    const geometry::PatchMesh mesh =
        geometry::readPatches(HELIODON_TEST_DATA "/compute/formfactor/room3_672.obj");
    const size_t n = mesh.patchCount();
    ASSERT_EQ(n, 672u);
    const ExactFormFactors result = exactFormFactors(test::device(), mesh, {1e-4});
    const std::vector<float> F = result.factors.values.download<float>(n * n);
    std::ifstream file(HELIODON_TEST_DATA "/formfactor/room3_672_rows.f32", std::ios::binary);
    std::vector<float> row(n);
    double squares = 0;
    size_t rows = 0, within = 0;
    for (size_t i = 0; i < n; i += 7, ++rows) {
        file.read(reinterpret_cast<char*>(row.data()), static_cast<std::streamsize>(n * sizeof(float)));
        double sum = 0;
        for (size_t j = 0; j < n; ++j) sum += std::pow(double{F[i * n + j]} - double{row[j]}, 2);
        squares += sum;
        within += std::sqrt(sum) <= 3 * static_cast<double>(result.rowError[i]) + 2e-5;
    }
    ASSERT_TRUE(file);
    EXPECT_LT(std::sqrt(squares / static_cast<double>(rows)), 1e-4); // what was asked for
    EXPECT_GE(within, rows * 95 / 100); // claimed errors are estimates, not bounds
    for (size_t i = 0; i < n; ++i) {
        ASSERT_EQ(F[i * n + i], 0.0f);
        for (size_t j = 0; j < n; ++j) {
            ASSERT_GE(F[i * n + j], 0.0f); // not NaN either
            const double there = F[i * n + j] * geometry::patchArea(mesh, i);
            const double back = F[j * n + i] * geometry::patchArea(mesh, j);
            ASSERT_NEAR(there, back, 1e-6 * there); // float32 rounding of areas and factors
        }
    }
}

// A wall must not hide its own patches, nor one side of a screen the other's light: every row sums to 1.
// Errors of single entries add up to some times the row error that was asked for.
TEST(ExactFormFactors, tilted_screens_without_thickness_that_cross_lose_no_light) {
    for (uint32_t cells : {1u, 5u}) {
        const geometry::PatchMesh mesh = test::crossingScreens(cells);
        const size_t n = mesh.patchCount();
        const std::vector<float> F = matrixOf(mesh, 1e-3);
        for (size_t i = 0; i < n; ++i) {
            double sum = 0;
            for (size_t j = 0; j < n; ++j) sum += F[i * n + j];
            EXPECT_NEAR(sum, 1, 1e-2) << cells << " cells, row " << i;
        }
    }
}

// Two partitions without thickness that stand on the floor, whose shadows' lines coincide in pairs there: in
// turned coordinates only nearly. What rounding took for light cost twenty times the cells.
TEST(ExactFormFactors, a_room_that_is_turned_and_far_off_costs_and_exchanges_the_same) {
    geometry::PatchMesh upright =
        test::boxRoom({.low = {0, 0, 0}, .high = {4, 2.5, 3}, .cells = {1, 1, 1}, .triangles = false});
    for (const auto& [x, z] : {std::pair(1.0, 0.0), std::pair(2.0, 0.6)}) {
        const auto v = static_cast<uint32_t>(upright.vertices.size());
        for (const glm::dvec3& p : {glm::dvec3(x, 0, z), {x, 2.5, z}, {x, 2.5, z + 2.4}, {x, 0, z + 2.4}})
            upright.vertices.push_back(p);
        for (const std::array<uint32_t, 4>& side :
             {std::array{v, v + 1, v + 2, v + 3}, {v + 3, v + 2, v + 1, v}})
            upright.addPatch(side, 0, geometry::Role::projection, 99, 0);
    }
    geometry::PatchMesh turned = upright;
    const glm::dvec3 u = glm::normalize(glm::dvec3(-0.33, -0.57, 0.75)),
                     v = glm::normalize(glm::cross(u, glm::dvec3(0.4, 1, 0.2))), w = glm::cross(u, v);
    for (glm::dvec3& p : turned.vertices) p = p.x * u + p.y * v + p.z * w + glm::dvec3(1e4, 1e4, -1e4);
    const ExactFormFactors one = exactFormFactors(test::device(), upright, {3e-5}),
                           other = exactFormFactors(test::device(), turned, {3e-5});
    const size_t n = upright.patchCount();
    const std::vector<float> F = one.factors.values.download<float>(n * n),
                             G = other.factors.values.download<float>(n * n);
    for (size_t k = 0; k < n * n; ++k) EXPECT_NEAR(F[k], G[k], roundingOf(1e-5)) << k;
    EXPECT_EQ(one.statistics.blockers, other.statistics.blockers);
    EXPECT_EQ(one.statistics.partial, other.statistics.partial);
    EXPECT_LT(static_cast<double>(other.statistics.cells),
              roundingOf(1.5 * static_cast<double>(one.statistics.cells)));
}

// One at a time, since the shadows of both sides are the same.
TEST(ExactFormFactors, both_sides_of_sheets_that_cross_block_once) {
    const geometry::PatchMesh mesh = test::crossingScreens(1);
    const uint32_t blockers = exactFormFactors(test::device(), mesh, {1e-2}).statistics.blockers;
    EXPECT_EQ(2 * blockers, blockingRegions(mesh, io::kExactBlockerCorners).size());
}

// A stack of slats casts more lines of shadows on the ceiling than a point can keep: sampled there, and no
// light lost. Twice, since groups of invocations differ from run to run.
TEST(ExactFormFactors, light_past_a_stack_of_slats_is_neither_lost_nor_left_to_chance) {
    geometry::PatchMesh mesh = test::boxRoom({.low = {0, 0, 0}, .high = {4, 3, 4}, .cells = {3, 3, 3}});
    const size_t room = mesh.corners.size();
    for (int k = 0; k < 10; ++k) {
        const double y = 0.3 + 0.25 * k;
        test::addBox(mesh, {.low = {1.9, y, 0.2}, .high = {2.1, y + 0.02, 3.8}, .cells = {1, 1, 1}});
    }
    std::reverse(mesh.corners.begin() + static_cast<long>(room), mesh.corners.end()); // slats face outwards
    const size_t n = mesh.patchCount();
    const std::vector<float> F = matrixOf(mesh, 3e-4);
    double squares = 0;
    for (size_t i = 0; i < n; ++i) {
        double sum = 0;
        for (size_t j = 0; j < n; ++j) sum += F[i * n + j];
        squares += (sum - 1) * (sum - 1);
        EXPECT_NEAR(sum, 1, 1e-2) << "row " << i;
    }
    EXPECT_LT(std::sqrt(squares / static_cast<double>(n)), 2e-3);
    EXPECT_EQ(F, matrixOf(mesh, 3e-4));
}

// At 1e-4 far pairs are taken along lines, at 2e-5 round the borders of what is visible. Light through a slot
// of 1 % of the height falls between points and lines.
TEST(ExactFormFactors, lines_across_far_pairs_agree_with_exact_borders) {
    geometry::PatchMesh mesh = test::boxRoom({.low = {0, 0, 0}, .high = {4, 3, 4}, .cells = {6, 5, 6}});
    const size_t room = mesh.corners.size();
    test::addBox(mesh, {.low = {1.9, 0.02, 0.02}, .high = {2.1, 1.5, 3.98}, .cells = {1, 2, 4}});
    test::addBox(mesh, {.low = {1.9, 1.53, 0.02}, .high = {2.1, 2.98, 3.98}, .cells = {1, 2, 4}});
    std::reverse(mesh.corners.begin() + static_cast<long>(room), mesh.corners.end()); // facing outwards
    const size_t n = mesh.patchCount();
    const std::vector<float> byLines = matrixOf(mesh, 1e-4), byBorders = matrixOf(mesh, 2e-5);
    double squares = 0;
    for (size_t k = 0; k < n * n; ++k) squares += std::pow(double{byLines[k]} - double{byBorders[k]}, 2);
    EXPECT_LT(std::sqrt(squares / static_cast<double>(n)), 1e-4);
    EXPECT_GT(squares, 0) << "the same method twice";
}

// Two patches of neighbouring walls that share a corner, the edge of a box 3 cm off: three blockers.
// Whichever corner comes first, rounding must not cut a sliver off a patch that touches the other's plane.
TEST(ExactFormFactors, patches_that_touch_behind_three_blockers_agree_with_the_reference) {
    const std::vector<std::vector<glm::dvec3>> patches{{{14.0 / 3, 3, 0}, {14.0 / 3, 3, 2.0 / 3}, {4, 3, 0}},
                                                       {{4, 2.5, 0}, {14.0 / 3, 3, 0}, {4, 3, 0}}};
    for (size_t turn = 0; turn < 9; ++turn) {
        std::vector<std::vector<glm::dvec3>> faces = patches;
        std::rotate(faces[0].begin(), faces[0].begin() + static_cast<long>(turn % 3), faces[0].end());
        std::rotate(faces[1].begin(), faces[1].begin() + static_cast<long>(turn / 3), faces[1].end());
        faces.push_back({{4.1, 2.97, 0.03}, {4.1, 2.97, 3.97}, {4.1, 0.03, 3.97}, {4.1, 0.03, 0.03}});
        faces.push_back({{4.1, 2.97, 3.97}, {4.1, 2.97, 0.03}, {4, 2.97, 0.03}, {4, 2.97, 3.97}});
        faces.push_back({{4.1, 2.97, 0.03}, {4.1, 0.03, 0.03}, {4, 0.03, 0.03}, {4, 2.97, 0.03}});
        const geometry::PatchMesh mesh = test::polygons(faces);
        const double truth = reference::exchangeIn(mesh, 0, 1, 1e-6).value / geometry::patchArea(mesh, 0);
        EXPECT_NEAR(matrixOf(mesh, 1e-4)[1], truth, 1e-5) << "turn " << turn;
    }
}

// Slivers of light and shadow, narrower than the gaps between points. Reference rows are good to about 1e-5,
// nearly all of their entries to 2e-6.
TEST(ExactFormFactors, large_patches_beside_narrow_slots_keep_the_error_asked) {
    const geometry::PatchMesh mesh = test::roomWithScreens();
    const size_t n = mesh.patchCount();
    const ExactFormFactors result =
        exactFormFactors(test::device(), mesh, {.maxError = 1e-4, .entryErrors = true});
    const std::vector<float> F = result.factors.values.download<float>(n * n);
    double sums = 0;
    for (size_t i = 0; i < n; ++i) {
        const auto row = std::span(F).subspan(i * n, n);
        sums += std::pow(std::accumulate(row.begin(), row.end(), -1.0), 2);
    }
    EXPECT_LT(std::sqrt(sums / static_cast<double>(n)), 1.5e-4); // errors of entries that do not conspire
    const reference::FormFactorRows oracle(mesh);
    constexpr size_t kRows = test::kSanitized ? 4 : 16;
    std::vector<reference::FormFactorRows::Row> truth(kRows);
    const auto rowOf = [&](size_t k) { return k * n / kRows + k % 3; };
    inParallel(kRows, [&](size_t k) { truth[k] = oracle.row(rowOf(k), 1e-6, 600); });
    double squares = 0;
    size_t within = 0;
    for (size_t k = 0; k < kRows; ++k)
        for (size_t j = 0; j < n; ++j) {
            const size_t at = rowOf(k) * n + j;
            const double error = std::abs(double{F[at]} - truth[k].factors[j]);
            squares += error * error;
            within += error <= double{result.entryError[at]} + 2e-6;
        }
    EXPECT_LT(std::sqrt(squares / kRows), 1e-4);
    EXPECT_GE(within, kRows * n * 995 / 1000);
}

// Sixteen times as long as wide, so that of two cells of a patch the one that meets the other patch at its
// tip only has its middle two thirds of its length away: it was taken for smooth, and rows were off by up
// to 2.4 times what they claim.
TEST(ExactFormFactors, strips_along_a_corridor_keep_their_claims) {
    constexpr int kStrips = 12;
    constexpr double kLength = 16;
    std::vector<reference::Polygon> strips{{{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}},
                                           {{kStrips * kLength, 0, 0},
                                            {kStrips * kLength, 0, 1},
                                            {kStrips * kLength, 1, 1},
                                            {kStrips * kLength, 1, 0}}};
    for (int k = 0; k < kStrips; ++k) {
        const double a = k * kLength, b = a + kLength;
        strips.push_back({{a, 0, 0}, {a, 0, 1}, {b, 0, 1}, {b, 0, 0}});
        strips.push_back({{a, 1, 0}, {b, 1, 0}, {b, 1, 1}, {a, 1, 1}});
        strips.push_back({{a, 0, 0}, {b, 0, 0}, {b, 1, 0}, {a, 1, 0}});
        strips.push_back({{a, 0, 1}, {a, 1, 1}, {b, 1, 1}, {b, 0, 1}});
    }
    const geometry::PatchMesh mesh = test::meshOf(strips);
    const size_t n = mesh.patchCount();
    std::vector<double> truth(n * n);
    inParallel(n, [&](size_t i) {
        for (size_t j = 0; j < n; ++j)
            if (i != j)
                truth[i * n + j] = contourExchange(strips[i], strips[j]) / reference::polygonArea(strips[i]);
    });
    for (const double asked : {3e-3, 1e-3, 3e-4}) {
        const ExactFormFactors result = exactFormFactors(test::device(), mesh, {asked});
        const std::vector<float> F = result.factors.values.download<float>(n * n);
        double squares = 0;
        for (size_t k = 0; k < n * n; ++k) squares += (F[k] - truth[k]) * (F[k] - truth[k]);
        EXPECT_LT(std::sqrt(squares / static_cast<double>(n)), 0.5 * result.factors.report.claimedRowError)
            << asked;
    }
}

// The sheet crosses the wall a tenth of its height above its foot: the border of the shadow runs along a row
// of cells, nearer to their edge than their outermost points, and the wall was off by 3.9e-4, claimed 2.5e-5.
TEST(ExactFormFactors, borders_of_shadows_along_rows_of_cells_are_found) {
    const double cut = 0.0811466224, foot = 0.0619800714, y = 0.459877722;
    const reference::Polygon floor{{0, 0, 0}, {1, 0, 0}, {1, y, 0}, {0, y, 0}};
    const auto wall = [y](double low, double high) {
        return reference::Polygon{
            {-0.47101258, y, low}, {0.52898742, y, low}, {0.52898742, y, high}, {-0.47101258, y, high}};
    };
    const reference::Polygon sheet{{-1, -1, cut}, {2, -1, cut}, {2, 2, cut}, {-1, 2, cut}};
    const std::vector<float> F = matrixOf(test::meshOf({floor, wall(foot, 0.262606418), sheet}), 1e-4);
    const double lit = contourExchange(floor, wall(foot, cut)), area = 0.262606418 - foot;
    EXPECT_NEAR(F[3], lit / area, 5e-5);
}

// Of the upper of two slats, 0.5 mm thick, points high on the wall see top and front edge, the latter
// edge-on: a shadow as thin as rounding beside another. What both cover came out as a hundred times the light
// there is: pairs were 9 % off.
TEST(ExactFormFactors, light_between_thin_slats_reaches_a_wall_that_sees_them_edge_on) {
    geometry::PatchMesh mesh = test::boxRoom({.low = {0, 0, 0}, .high = {1, 1, 1}, .cells = {2, 2, 2}});
    const size_t room = mesh.corners.size(), firstVertex = mesh.vertices.size(), first = mesh.patchCount();
    const glm::dvec3 x(1, 0, 0), along(0, std::sin(0.6), std::cos(0.6)), up = glm::cross(along, x);
    for (int k = 0; k < 2; ++k)
        test::addBox(mesh, {.low = {0.2, 0, 0}, .high = {0.8, 5e-4, 0.01}, .cells = {3, 1, 1}});
    std::reverse(mesh.corners.begin() + static_cast<long>(room),
                 mesh.corners.end()); // solid: they face outwards
    const size_t vertices = (mesh.vertices.size() - firstVertex) / 2;
    for (size_t v = firstVertex; v < mesh.vertices.size(); ++v) {
        const glm::dvec3 p = mesh.vertices[v];
        const double lift = v < firstVertex + vertices ? 0.396 : 0.408;
        mesh.vertices[v] = p.x * x + p.y * up + p.z * along + glm::dvec3(0, lift, 0.4);
    }
    const size_t n = mesh.patchCount();
    const std::vector<float> F = matrixOf(mesh, 1e-4);
    for (size_t i = first; i < n; ++i) { // the lower slat's top
        if (geometry::patchCentroid(mesh, i).y > 0.406 || glm::dot(geometry::patchNormal(mesh, i), up) < 0.9)
            continue;
        for (size_t j = 0; j < first; ++j) {
            if (geometry::patchCentroid(mesh, j).z > 1e-9) continue;
            const double truth =
                reference::exchangeIn(mesh, i, j, 1e-6, 100).value / geometry::patchArea(mesh, i);
            EXPECT_NEAR(F[i * n + j], truth, 1e-4) << i << ", " << j;
        }
    }
}

// What the floor has beneath the box is inside it: nothing of the room may reach there past the box's backs.
TEST(ExactFormFactors, a_floor_that_goes_on_beneath_a_box_sees_the_room_beside_it_only) {
    geometry::PatchMesh mesh = test::boxRoom({.low = {0, 0, 0}, .high = {4, 2, 4}, .cells = {1, 1, 2}});
    const size_t room = mesh.corners.size();
    test::addBox(mesh, {.low = {1.2, 0, 0.7}, .high = {2.1, 0.8, 1.9}, .cells = {1, 1, 1}});
    std::reverse(mesh.corners.begin() + static_cast<long>(room), mesh.corners.end());
    const size_t n = mesh.patchCount();
    const auto F =
        exactFormFactors(test::device(), mesh, {.maxError = 1e-4}).factors.values.download<float>(n * n);
    const reference::FormFactorRows oracle(mesh);
    for (size_t i = 0; i < n; ++i) {
        if (std::abs(geometry::patchNormal(mesh, i).y) < 0.9) continue;
        const auto row = oracle.row(i, 1e-6, 100).factors;
        double squares = 0;
        for (size_t j = 0; j < n; ++j) squares += std::pow(double{F[i * n + j]} - row[j], 2);
        EXPECT_LT(std::sqrt(squares), 3e-4) << "row " << i; // 3 times what was asked on the mean of rows
    }
}

TEST(ExactFormFactors, same_input_gives_the_same_bits) {
    const geometry::PatchMesh mesh =
        geometry::readPatches(HELIODON_TEST_DATA "/compute/formfactor/room3_672.obj");
    EXPECT_EQ(matrixOf(mesh, 1e-3), matrixOf(mesh, 1e-3));
}

TEST(ExactFormFactors, empty_and_single_patches_exchange_nothing) {
    EXPECT_EQ(exactFormFactors(test::device(), {}).factors.patchCount, 0u);
    const geometry::PatchMesh one = test::meshOf({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
    EXPECT_EQ(matrixOf(one, 1e-4), std::vector<float>{0.0f});
}

} // namespace
} // namespace heliodon::compute
