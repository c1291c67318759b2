#include "compute/monte_carlo.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <span>
#include <stdexcept>

#include <gtest/gtest.h>

#include "compute/reference/exact_form_factors.h"
#include "compute/reference/monte_carlo.h"
#include "tests/compute/cases.h"
#include "tests/compute/form_factor_cases.h"
#include "tests/compute/rooms.h"
#include "tests/gpu/test_device.h"

namespace heliodon::compute {
namespace {

const std::string kData = std::string(HELIODON_TEST_DATA) + "/compute/formfactor/";

TEST(MonteCarlo, directions_are_stratified_and_places_fill_the_square) {
    const uint32_t half = 1024, side = 1u << monteCarloKeptBits(half);
    const auto points = monteCarloPoints(half);
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> cells;
    double x = 0, y = 0;
    for (const glm::uvec4& p : points) {
        ++cells[{p.x / (0x80000000u / side * 2), p.y / (0x80000000u / side * 2)}];
        x += p.z * 0x1p-32, y += p.w * 0x1p-32;
    }
    ASSERT_EQ(cells.size(), side * side);
    for (const auto& [cell, count] : cells) EXPECT_EQ(count, half / (side * side));
    // Each coordinate is stratified into `half` intervals: the mean is off by less than half of one.
    EXPECT_NEAR(x / half, 0.5, 0.5 / half);
    EXPECT_NEAR(y / half, 0.5, 0.5 / half);
}

// Device and reference trace the same rays; float32 may send a ray that grazes an edge to the neighbour.
void expectLikeReference(const geometry::PatchMesh& mesh, uint32_t rays) {
    MonteCarlo kernel(test::device(), mesh, {rays});
    const auto n = static_cast<uint32_t>(mesh.patchCount());
    std::vector<float> values(size_t{n} * n);
    std::vector<MonteCarloSpread> spreads(n);
    kernel.rows(0, n, values, spreads);
    for (uint32_t i = 0; i < n; ++i) {
        const auto row = reference::monteCarloRow(mesh, i, kernel.rays());
        double difference = 0, variance = 1; // a hit may have been missed
        for (uint32_t j = 0; j < n; ++j) {
            const double a = row.hits[0][j], b = row.hits[1][j];
            difference += std::abs(double{values[i * n + j]} * kernel.rays() - (a + b));
            variance += (a - b) * (a - b);
        }
        EXPECT_LE(difference, 4) << "row " << i; // two rays of 256
        EXPECT_NEAR(spreads[i].estimate(), std::sqrt(variance) / kernel.rays(), 4.0 / kernel.rays())
            << "row " << i;
    }
}

TEST(MonteCarlo, agrees_with_the_reference_in_rooms_of_quads_and_of_triangles) {
    test::BoxRoom box;
    expectLikeReference(test::boxRoom(box), 256);
    box.triangles = false;
    box.cells = {2, 1, 3};
    geometry::PatchMesh mesh = test::boxRoom(box);
    test::BoxRoom inner;
    inner.low = {1, 1, 1}, inner.high = {3, 2, 3};
    inner.cells = {1, 2, 1};
    test::addBox(mesh, inner, 1); // lies inside the other, yet in a room of its own
    expectLikeReference(mesh, 256);
}

// The claim is a 99th percentile: of thousands of entries, little above the error.
TEST(MonteCarlo, the_claimed_error_is_the_error_and_falls_with_the_rays) {
    for (const char* name : {"cube_quads_4x4", "room3_672"}) {
        const geometry::PatchMesh mesh = geometry::readPatches(kData + name + ".obj");
        const std::vector<float> exact = test::readFloats(kData + name + ".f32");
        double before = 1;
        for (uint32_t rays : {256u, 1024u}) {
            const MonteCarloFormFactors F = MonteCarlo(test::device(), mesh, {rays}).run();
            const double error = test::rowError(F.factors.values.download<float>(exact.size()), exact);
            EXPECT_GE(F.factors.report.claimedRowError, error) << name;
            EXPECT_LE(F.factors.report.claimedRowError, 1.3 * error) << name;
            EXPECT_LT(error, 0.55 * before) << name; // plain random points: 0.5
            before = error;
        }
    }
}

// Where entries are few, both halves agree by luck in one row of ten.
TEST(MonteCarlo, rows_of_few_patches_keep_their_claims) {
    size_t rows = 0, held = 0;
    for (const char* name : {"cube_quads_1x1", "cylinder24", "tetra_regular", "thin_slab_1_1_0.001"}) {
        const geometry::PatchMesh mesh = geometry::readPatches(kData + name + ".obj");
        const std::vector<float> exact = test::readFloats(kData + name + ".f32");
        const size_t n = mesh.patchCount();
        for (uint32_t rays : {64u, 256u, 1024u, 4096u}) {
            const MonteCarloFormFactors F = MonteCarlo(test::device(), mesh, {rays}).run();
            const auto values = F.factors.values.download<float>(n * n);
            EXPECT_LE(test::rowError(values, exact), F.factors.report.claimedRowError) << name << rays;
            for (size_t i = 0; i < n; ++i) {
                double squares = 0;
                for (size_t j = 0; j < n; ++j)
                    squares += std::pow(double{values[i * n + j]} - exact[i * n + j], 2);
                ++rows, held += std::sqrt(squares) <= F.rows[i].claim();
            }
        }
    }
    EXPECT_GE(static_cast<double>(held), 0.99 * static_cast<double>(rows));
}

// Rooms with blockers, slots and hidden pairs: within four standard errors of a plain random count, which
// low-discrepancy points do not exceed.
TEST(MonteCarlo, occluded_and_free_pairs_have_their_exact_factors) {
    for (const char* category : {"unoccluded", "occluded"})
        for (const test::FormFactorCase& c : test::formFactorCases(category)) {
            const geometry::PatchMesh mesh = test::meshOf(c.polygons);
            MonteCarlo kernel(test::device(), mesh, {16384});
            const size_t n = mesh.patchCount();
            const auto values = kernel.run().factors.values.download<float>(n * n);
            for (const auto& entry : c.entries) {
                const double ratio = geometry::patchArea(mesh, entry.i) / geometry::patchArea(mesh, entry.j);
                // Both directions are combined; the variance of either is F / rays times its area's share.
                const double sigma =
                    std::sqrt(std::max(entry.value, 1e-9) / (1 + ratio) / 16384) + 1.0 / 16384;
                // 2e-6: planes nearer to the ray's start than the float32 grid of the scene are not seen.
                EXPECT_NEAR(values[entry.i * n + entry.j], entry.value, 4 * sigma + 2e-6) << c.name;
            }
        }
}

// What lies within a needle's width of its plane: the neighbour along its edge, turned against it. Not the
// one 1e-4 wide that is turned by 10 degrees, whose heights are no more than what counts as in the plane.
TEST(MonteCarlo, needles_that_share_an_edge_see_one_another) {
    for (double width : {1e-2, 1e-3, 3e-4, 2e-4, 1e-4})
        for (double degrees : {10.0, 20.0, 30.0, 60.0, 150.0}) {
            const double angle = degrees * std::numbers::pi / 180;
            if (width * std::sin(angle) < 2e-5) continue;
            const geometry::PatchMesh mesh = test::polygons(
                {{{0, 0, 0}, {width, 0.3, 0}, {0, 1, 0}},
                 {{0, 0, 0}, {0, 1, 0}, {width * std::cos(angle), 0.6, width * std::sin(angle)}}});
            const MonteCarloFormFactors F = MonteCarlo(test::device(), mesh, {4096}).run();
            const std::vector<double> exact = reference::exactFormFactors(mesh);
            EXPECT_LE(test::rowError(F.factors.values.download<float>(4), {exact.begin(), exact.end()}),
                      F.factors.report.claimedRowError)
                << width << " m wide, turned by " << degrees;
        }
}

// Of two patches back to back the front is met: no ray is lost, and the sum of a row scatters as 1 /
// sqrt(rays).
TEST(MonteCarlo, screens_without_thickness_lose_no_rays) {
    const geometry::PatchMesh mesh = test::crossingScreens(1);
    const size_t n = mesh.patchCount();
    const auto F = MonteCarlo(test::device(), mesh, {16384}).run().factors.values.download<float>(n * n);
    for (size_t i = 0; i < n; ++i) {
        double sum = 0;
        for (size_t j = 0; j < n; ++j) sum += F[i * n + j];
        EXPECT_NEAR(sum, 1, 4.0 / 128) << "row " << i;
    }
}

// Rays that start millimetres over a sheet's plane meet both its sides as far apart as rounding is beside
// that height, a ten-thousandth of the distance: a quarter of them ended on the back.
TEST(MonteCarlo, rays_from_beside_the_edge_of_a_screen_meet_its_front) {
    // One of 24 strips round the upright edge of a room, and a sheet that begins there.
    const auto corner = [](double k, double y) {
        const double turn = k * std::numbers::pi / 48;
        return glm::dvec3(0.05 - 0.05 * std::cos(turn), y, 0.05 - 0.05 * std::sin(turn));
    };
    const std::vector<glm::dvec3> strip{corner(12, 0), corner(13, 0), corner(13, 2), corner(12, 2)},
        front{{0.03, 0.2, 0.03}, {0.03, 1.7, 0.03}, {1.23, 1.7, 1.03}, {1.23, 0.2, 1.03}};
    const geometry::PatchMesh mesh = test::polygons({strip, front, {front.rbegin(), front.rend()}});
    const auto F = MonteCarlo(test::device(), mesh, {16384}).run().factors.values.download<float>(9);
    const double exact = reference::exactFormFactors(mesh, 1e-6)[1], four = 4 * std::sqrt(exact / 16384);
    EXPECT_NEAR(F[1], exact, four);
    const reference::MonteCarloRow row = reference::monteCarloRow(mesh, 0, 16384);
    EXPECT_NEAR((row.hits[0][1] + row.hits[1][1]) / 16384.0, exact, four);
}

// Loops longer than devices let them be (shaders/lib/loop_limit.glsl): half the hits of these rays went
// missing.
TEST(MonteCarlo, rays_past_thousands_of_boxes_are_followed_to_their_ends) {
    const test::BoxRoom box{.cells = {1, 1, 1}};
    geometry::PatchMesh mesh = test::boxRoom(box);
    for (const auto& corners : test::needlesAcross(box, 1000, 7e-3)) {
        const auto v = static_cast<uint32_t>(mesh.vertices.size());
        mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
        mesh.addPatch(std::vector<uint32_t>{v, v + 1, v + 2}, 0, geometry::Role::projection, v, 0);
    }
    constexpr uint32_t kRows = 8;
    const size_t n = mesh.patchCount();
    std::vector<float> values(kRows * n);
    std::vector<MonteCarloSpread> spreads(kRows);
    MonteCarlo(test::device(), mesh, {256}).rows(0, kRows, values, spreads);
    for (uint32_t i = 0; i < kRows; ++i) {
        const auto row = reference::monteCarloRow(mesh, i, 256);
        double difference = 0;
        for (uint32_t j = 0; j < n; ++j)
            difference += std::abs(256 * double{values[i * n + j]} - double(row.hits[0][j] + row.hits[1][j]));
        EXPECT_LE(difference, 4) << "row " << i;
    }
}

TEST(MonteCarlo, pairs_are_reciprocal_and_every_run_gives_the_same_bits) {
    const geometry::PatchMesh mesh = test::boxRoom({});
    const size_t n = mesh.patchCount();
    MonteCarlo kernel(test::device(), mesh, {512});
    const auto first = kernel.run().factors.values.download<float>(n * n);
    EXPECT_EQ(first, kernel.run().factors.values.download<float>(n * n));
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < i; ++j) // one rounding each
            EXPECT_NEAR(geometry::patchArea(mesh, i) * first[i * n + j],
                        geometry::patchArea(mesh, j) * first[j * n + i], 1e-6);
}

// Many rays go in several submissions, so that whoever asked for them can stop: the same hits as rows one by
// one, which fit into one submission each.
TEST(MonteCarlo, long_work_can_be_stopped_between_submissions) {
    size_t submissions = 0, allowed = std::numeric_limits<size_t>::max();
    gpu::DeviceOptions options;
    options.beforeSubmit = [&] {
        if (submissions++ >= allowed) throw std::runtime_error("stopped");
    };
    gpu::Device device(options);
    const geometry::PatchMesh mesh = test::boxRoom({});
    const auto n = static_cast<uint32_t>(mesh.patchCount());
    MonteCarlo kernel(device, mesh, {65536});
    std::vector<float> all(size_t{n} * n), one(n);
    std::vector<MonteCarloSpread> spreads(n);
    submissions = 0;
    kernel.rows(0, n, all, spreads);
    EXPECT_GE(submissions, size_t{n} * 65536 / (1u << 20));
    for (uint32_t i = 0; i < n; i += n / 5) {
        const size_t before = submissions;
        kernel.rows(i, 1, one, spreads);
        EXPECT_EQ(submissions, before + 1);
        EXPECT_TRUE(std::ranges::equal(one, std::span(all).subspan(size_t{i} * n, n))) << "row " << i;
    }
    submissions = 0, allowed = 2;
    EXPECT_THROW(kernel.run(), std::runtime_error);
    EXPECT_EQ(submissions, 3u);
}

TEST(MonteCarlo, empty_meshes_and_degenerate_patches_are_no_special_case) {
    EXPECT_EQ(MonteCarlo(test::device(), test::polygons({})).run().factors.patchCount, 0u);
    const auto mesh = test::polygons({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}},
                                      {{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}},
                                      {{0, 0.5, 0}, {1, 0.5, 0}, {2, 0.5, 0}}});
    const auto values = MonteCarlo(test::device(), mesh, {4096}).run().factors.values.download<float>(9);
    EXPECT_NEAR(values[1], 0.199825, 0.01); // opposed unit squares, Howell C-11; 1/sqrt(8192)
    for (size_t k : {0u, 2u, 4u, 5u, 6u, 7u, 8u}) EXPECT_EQ(values[k], 0.0f);
}

} // namespace
} // namespace heliodon::compute
