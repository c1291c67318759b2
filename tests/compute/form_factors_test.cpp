#include "compute/form_factors.h"

#include <numbers>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "compute/exact_form_factors.h"
#include "compute/gpu/device.h"
#include "compute/hierarchical.h"
#include "compute/kernel_choice.h"
#include "compute/monte_carlo.h"
#include "compute/reference/exact_form_factors.h"
#include "compute/reference/radiosity.h"
#include "geometry/input_error.h"
#include "tests/compute/cases.h"
#include "tests/compute/form_factor_cases.h"
#include "tests/compute/rooms.h"
#include "tests/gpu/test_device.h"

namespace heliodon::compute {
namespace {

const std::string kData = std::string(HELIODON_TEST_DATA) + "/compute/formfactor/";

struct Enclosure {
    const char* name;
    double rowL2; // RMS over rows of ||F_i - reference_i||, one point for each patch
};

class Enclosures : public testing::TestWithParam<Enclosure> {};

// Near pairs in closed form, the others from both ends: what pixels of 64 x 64 leave.
TEST_P(Enclosures, near_pairs_in_closed_form_leave_only_the_error_of_pixels) {
    const geometry::PatchMesh mesh = geometry::readPatches(kData + GetParam().name + ".obj");
    const size_t n = mesh.patchCount();
    const std::vector<float> exact = test::readFloats(kData + GetParam().name + ".f32");
    ASSERT_EQ(exact.size(), n * n);
    FormFactorOptions options;
    options.kernel = "hemicube";
    const FormFactors F = computeFormFactors(test::device(), mesh, options);
    const double rowL2 = test::rowError(F.values.download<float>(n * n), exact);
    RecordProperty("rowL2", std::to_string(rowL2));
    EXPECT_LT(F.report.closureMax, 0.045); // no longer by construction: errors of single entries remain
    EXPECT_LT(F.report.reciprocityRms.value(), 1e-7);
    EXPECT_LT(rowL2, GetParam().rowL2);
    // A sample is an honest measure of what pixels leave, where there are far pairs.
    if (n > 100) {
        EXPECT_LT(rowL2, F.report.claimedRowError);
        EXPECT_LT(F.report.claimedRowError, 2 * rowL2);
        EXPECT_LE(F.report.closureMax, F.report.claimedRowSumError);
    }
}

// Bounds: 1.2 times what was measured when the kernel agreed with its double-precision reference.
INSTANTIATE_TEST_SUITE_P(Hemicube, Enclosures,
                         testing::Values(Enclosure{"cube_quads_1x1", 1e-5}, Enclosure{"cube_quads_4x4", 2e-3},
                                         Enclosure{"cylinder24", 5e-5}, Enclosure{"tetra_regular", 1e-5},
                                         Enclosure{"thin_slab_1_1_0.001", 1.6e-3},
                                         Enclosure{"room3_672", 4.3e-3}),
                         [](const auto& instance) {
                             std::string name = instance.param.name;
                             std::replace(name.begin(), name.end(), '.', '_');
                             return name;
                         });

FormFactorOptions asking(const char* kernel, double maxError) {
    FormFactorOptions options;
    options.kernel = kernel;
    options.maxError = maxError;
    return options;
}

TEST(FormFactors, every_kernel_reaches_the_error_asked_or_says_what_remains) {
    const geometry::PatchMesh mesh = geometry::readPatches(kData + "room3_672.obj");
    const std::vector<float> exact = test::readFloats(kData + "room3_672.f32");
    for (const char* kernel : {"auto", "exact", "hemicube", "hierarchical", "montecarlo"})
        for (double asked : {1e-2, 4e-3}) {
            const FormFactors F = computeFormFactors(test::device(), mesh, asking(kernel, asked));
            const double error = test::rowError(F.values.download<float>(exact.size()), exact);
            EXPECT_LE(error, 1.1 * asked) << kernel; // claims are estimates
            EXPECT_FALSE(F.report.why.empty());
        }
}

TEST(FormFactors, auto_takes_links_for_coarse_and_visible_polygons_for_fine_errors) {
    const geometry::PatchMesh mesh = test::boxRoom({});
    const FormFactorReport coarse = computeFormFactors(test::device(), mesh, asking("auto", 1e-2)).report;
    EXPECT_EQ(coarse.kernel, test::device().info().type == "discrete" ? "exact" : "hierarchical");
    EXPECT_NE(coarse.why.find("nothing can stand between"), std::string::npos);
    EXPECT_EQ(computeFormFactors(test::device(), mesh, asking("auto", 1e-4)).report.kernel, "exact");
    EXPECT_EQ(computeFormFactors(test::device(), mesh).report.kernel, "exact");
}

TEST(KernelChoice, links_pay_from_lower_errors_on_the_more_stands_between) {
    double before = 1;
    for (double blockers : {12.0, 80.0, 130.0, 500.0}) {
        const double pays = errorFromWhichLinksPay({blockers, 5, false});
        EXPECT_LT(pays, before);
        EXPECT_LE(errorFromWhichLinksPay({blockers, 5, true}), pays);
        EXPECT_GE(errorFromWhichLinksPay({blockers, 1, true}), pays);   // no clusters
        EXPECT_GT(errorFromWhichLinksPay({blockers, 20, false}), 2e-3); // few of them between two patches
        before = pays;
    }
    EXPECT_EQ(errorFromWhichLinksPay({1e6, 10, true}), kLeastErrorOfLinks); // as far as links go
    EXPECT_EQ(errorFromWhichLinksPay({1, 10, false}), errorFromWhichLinksPay({2, 10, false}));
    // Three and five boxes in the air, 2000 patches (docs/form-factors.md).
    EXPECT_LT(errorFromWhichLinksPay({18, 130, false}), 5e-3);
    EXPECT_LT(errorFromWhichLinksPay({30, 70, false}), 5e-3);
}

// Ten tall boards, ten small boxes and three partitions (docs/form-factors.md).
TEST(KernelChoice, large_blockers_are_left_to_visible_polygons_longer) {
    EXPECT_GT(errorFromWhichLinksPay({60, 34, false, 0.054}), 1e-2);
    EXPECT_LT(errorFromWhichLinksPay({60, 34, false, 0.054}), 2e-2);
    EXPECT_LT(errorFromWhichLinksPay({60, 34, false, 0.003}), 5e-3);
    EXPECT_GT(errorFromWhichLinksPay({12, 700, false, 0.081}), 2e-2);
}

// A room with a few partitions, and one full of small boxes; beside a large empty room, what stands in a
// small one counts for little.
TEST(KernelChoice, what_stands_in_a_room_decides_what_auto_takes) {
    if (test::device().info().type == "discrete") GTEST_SKIP() << "visible polygons, whatever stands there";
    const auto choice = [](const geometry::PatchMesh& mesh, double asked, bool forLight = false) {
        FormFactorOptions options = asking("auto", asked);
        options.forLight = forLight;
        return chooseKernel(test::device(), mesh, options);
    };
    const geometry::PatchMesh partitions = geometry::readPatches(kData + "room3_672.obj");
    EXPECT_EQ(choice(partitions, 3e-2).kernel, "hierarchical");
    EXPECT_EQ(choice(partitions, 1e-2).kernel, "exact");
    EXPECT_NE(choice(partitions, 1e-2).why.find("of 8.1 % of the room"), std::string::npos);
    EXPECT_NE(choice(partitions, 5e-3).why.find("12 blockers and"), std::string::npos);

    geometry::PatchMesh full = test::boxRoom({});
    for (int i = 0; i < 25; ++i)
        test::addBox(full,
                     {.low = {0.1 + 0.15 * i, 1, 1}, .high = {0.2 + 0.15 * i, 1.1, 1.1}, .cells = {1, 1, 1}});
    EXPECT_EQ(choice(full, 1.9e-3).kernel, "hierarchical");
    EXPECT_EQ(choice(full, 1.9e-3, true).kernel, "exact");
    EXPECT_NE(choice(full, 1.9e-3, true).why.find("sums of rows"), std::string::npos);
    EXPECT_EQ(choice(full, 1e-4).kernel, "exact");

    test::addBox(full, {.low = {0, 0, 10}, .high = {20, 20, 30}, .cells = {20, 20, 20}}, 1);
    EXPECT_EQ(choice(full, 4e-3).kernel, "exact");
}

// Loose boxes whose faces are patches: planes by the hundred, and nothing curved. Links, which find no
// clusters there, take longer for fine errors, though there are many blockers.
TEST(KernelChoice, unmeshed_faces_are_left_to_visible_polygons) {
    if (test::device().info().type == "discrete") GTEST_SKIP() << "visible polygons, whatever stands there";
    geometry::PatchMesh mesh = test::boxRoom({.cells = {1, 1, 1}, .triangles = false});
    for (int i = 0; i < 36; ++i) {
        const double x = 0.5 + 0.5 * (i % 6) + 0.01 * i, y = 1 + 0.02 * i,
                     z = 0.5 + 0.6 * (i / 6) + 0.003 * i;
        test::addBox(
            mesh,
            {.low = {x, y, z}, .high = {x + 0.2, y + 0.2, z + 0.2}, .cells = {1, 1, 1}, .triangles = false});
    }
    for (double asked : {1e-3, 2e-3})
        EXPECT_EQ(chooseKernel(test::device(), mesh, asking("auto", asked)).kernel, "exact") << asked;
    const KernelChoice coarse = chooseKernel(test::device(), mesh, asking("auto", 5e-3));
    EXPECT_EQ(coarse.kernel, "hierarchical");
    EXPECT_LT(coarse.ofLinks, 1);
}

// Visible polygons behind thousands of blockers take minutes, which nobody asked light for.
TEST(KernelChoice, light_among_a_crowd_of_boards_is_left_to_rays_unless_an_error_is_asked) {
    if (test::device().info().type == "discrete") GTEST_SKIP() << "visible polygons, whatever stands there";
    const auto boards = [](int count) {
        geometry::PatchMesh mesh = test::boxRoom({.cells = {1, 1, 1}});
        for (int i = 0; i < count; ++i) {
            const glm::dvec3 low(0.1 + 0.17 * (i % 20), 0.1 + 0.1 * (i / 20), 1 + 0.01 * (i % 7));
            test::addBox(mesh, {.low = low, .high = low + glm::dvec3(0.15, 0.01, 0.1), .cells = {1, 1, 1}});
        }
        return mesh;
    };
    const geometry::PatchMesh crowd = boards(460);
    FormFactorOptions light;
    light.forLight = true;
    const KernelChoice rays = chooseKernel(test::device(), crowd, light);
    EXPECT_EQ(rays.kernel, "montecarlo");
    EXPECT_EQ(rays.maxError, 5e-3);
    EXPECT_NE(rays.why.find("CPU seconds"), std::string::npos) << rays.why;
    EXPECT_EQ(chooseKernel(test::device(), boards(100), light).kernel, "exact");
    light.maxError = 1e-3;
    EXPECT_EQ(chooseKernel(test::device(), crowd, light).kernel, "exact");
}

// Seen from inside, without its poles; two triangles lie in a plane.
geometry::PatchMesh ball(int sides, int rings) {
    std::vector<std::vector<glm::dvec3>> faces;
    const auto at = [&](int i, int j) {
        const double a = 2 * std::numbers::pi * i / sides, b = std::numbers::pi * j / rings;
        return glm::dvec3(std::sin(b) * std::cos(a), std::cos(b), std::sin(b) * std::sin(a));
    };
    for (int i = 0; i < sides; ++i)
        for (int j = 1; j < rings - 1; ++j) {
            faces.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
            faces.push_back({at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)});
        }
    return test::polygons(faces);
}

TEST(KernelChoice, curved_surfaces_are_left_to_links_sooner_while_their_pairs_can_be_kept) {
    if (test::device().info().type == "discrete") GTEST_SKIP() << "visible polygons, whatever stands there";
    const KernelChoice many = chooseKernel(test::device(), ball(200, 40), asking("auto", 1e-2));
    EXPECT_EQ(many.kernel, "exact") << many.why;
    EXPECT_NE(many.why.find("link to be kept"), std::string::npos) << many.why;
    const KernelChoice choice = chooseKernel(test::device(), ball(24, 8), asking("auto", 1e-3));
    EXPECT_EQ(choice.kernel, "hierarchical");
    EXPECT_NE(choice.why.find("few patches a plane"), std::string::npos);
}

// Two sheets, each of two sides, that cross by a micrometre: half of each faces the other across it, which float32
// does not see. Both sides of one sheet exchange nothing.
TEST(FormFactors, what_sheets_lose_that_cross_by_a_hair_is_claimed) {
    for (const double askew : {1e-6, 0.0}) {
        std::vector<std::vector<glm::dvec3>> faces;
        const auto box = test::boxRoom({.low = {0, 0, 0}, .high = {4, 3, 4}, .cells = {1, 1, 1}});
        for (size_t i = 0; i < box.patchCount(); ++i) faces.push_back(geometry::patchCorners(box, i));
        for (const double end : askew > 0 ? std::vector{0.0, askew} : std::vector{0.0}) {
            const std::vector<glm::dvec3> front{
                {1, 1 + end, 1}, {1, 1 + end, 3}, {3, 1 - end, 3}, {3, 1 - end, 1}};
            faces.push_back(front);
            faces.emplace_back(front.rbegin(), front.rend());
        }
        const geometry::PatchMesh mesh = test::polygons(faces);
        const auto n = static_cast<double>(mesh.patchCount());
        for (const char* kernel : {"hemicube", "hierarchical", "montecarlo"}) {
            const auto report = computeFormFactors(test::device(), mesh, asking(kernel, 1e-2)).report;
            if (askew > 0)
                EXPECT_GE(report.claimedRowError, std::sqrt(4 * 0.25 / n)) << kernel; // half of four rows
            else
                EXPECT_LE(report.claimedRowError, 2e-2) << kernel;
        }
    }
}

// 1 : 10000, sharing an edge at 0.1 degrees: the tips are 1.7e-7 apart, one plane to float32.
TEST(FormFactors, what_needles_that_share_an_edge_lose_is_claimed) {
    const double angle = 0.1 * std::numbers::pi / 180, width = 1e-4;
    const geometry::PatchMesh mesh =
        test::meshOf({{{0, 0, 0}, {0, 0, 1}, {width, 0, 0.5}},
                      {{0, 0, 1}, {0, 0, 0}, {width * std::cos(angle), width * std::sin(angle), 0.5}}});
    const auto exact = computeFormFactors(test::device(), mesh, asking("exact", 1e-5));
    const float truth = exact.values.download<float>(4)[1];
    EXPECT_GT(truth, 0.999f);
    EXPECT_LT(exact.report.claimedRowError, 1e-5);
    for (const char* kernel : {"hierarchical", "hemicube", "montecarlo"}) {
        const auto factors = computeFormFactors(test::device(), mesh, asking(kernel, 1e-2));
        const float error = std::abs(factors.values.download<float>(4)[1] - truth);
        EXPECT_GE(factors.report.claimedRowError, 0.999 * double{error}) << kernel;
    }
}

// Pairs in closed form come to the end of floats, which is no reason for others to be left coarse.
TEST(FormFactors, hemicubes_go_on_where_near_pairs_can_get_no_better) {
    const auto report = computeFormFactors(test::device(), ball(8, 6), asking("hemicube", 1e-6)).report;
    EXPECT_EQ(report.points, 16u) << report.why;
}

size_t heldOf(const std::vector<float>& values, const std::vector<float>& exact,
              std::span<const float> claimed) {
    size_t held = 0;
    const size_t n = claimed.size();
    for (size_t i = 0; i < n; ++i) {
        double squares = 0;
        for (size_t j = 0; j < n; ++j)
            squares += std::pow(double{values[i * n + j]} - double{exact[i * n + j]}, 2);
        held += std::sqrt(squares) <= double{claimed[i]};
    }
    return held;
}

// Claims of single rows; those of `hierarchical` are tested beside its links.
TEST(FormFactors, rows_keep_the_errors_that_are_claimed_for_them) {
    for (const char* name : {"room3_672", "cube_quads_4x4"}) {
        const geometry::PatchMesh mesh = geometry::readPatches(kData + name + ".obj");
        const std::vector<float> exact = test::readFloats(kData + name + ".f32");
        const auto n = static_cast<double>(mesh.patchCount());
        for (double asked : {1e-3, 1e-4}) {
            const ExactFormFactors F = exactFormFactors(test::device(), mesh, {asked});
            const auto values = F.factors.values.download<float>(exact.size());
            EXPECT_GE(static_cast<double>(heldOf(values, exact, F.rowError)), 0.99 * n) << name << asked;
            EXPECT_LE(test::rowError(values, exact), F.factors.report.claimedRowError) << name << asked;
        }
        for (uint32_t rays : {1024u, 4096u}) {
            const MonteCarloFormFactors F = MonteCarlo(test::device(), mesh, {rays}).run();
            const auto values = F.factors.values.download<float>(exact.size());
            std::vector<float> claims;
            for (const MonteCarloSpread& row : F.rows) claims.push_back(static_cast<float>(row.claim()));
            EXPECT_GE(static_cast<double>(heldOf(values, exact, claims)), 0.99 * n) << name << rays;
        }
        for (uint32_t resolution : {32u, 64u}) {
            FormFactorOptions options;
            options.kernel = "hemicube";
            options.resolution = resolution;
            const FormFactors F = computeFormFactors(test::device(), mesh, options);
            EXPECT_LE(test::rowError(F.values.download<float>(exact.size()), exact), F.report.claimedRowError)
                << name << resolution;
        }
    }
}

// Radiosity by Gaussian elimination in double precision, with the kernel's matrix and with the exact one:
// walls of which each glows by itself, and one lamp.
TEST(FormFactors, radiosity_keeps_the_error_asked_of_it) {
    const geometry::PatchMesh mesh = geometry::readPatches(kData + "room3_672.obj");
    const std::vector<float> exact = test::readFloats(kData + "room3_672.f32");
    const size_t n = mesh.patchCount();
    std::vector<float> rho(n), glow(n), lamp(n);
    for (size_t i = 0; i < n; ++i) {
        rho[i] = i % 3 == 0 ? 0.8f : 0.5f;
        glow[i] = static_cast<float>(i * 7919 % 101);
    }
    lamp[n / 2] = 1000;
    for (double asked : {3e-2, 3e-3}) {
        FormFactorOptions options;
        options.maxRadiosityError = asked;
        options.reflectance = 0.8;
        const FormFactors F = computeFormFactors(test::device(), mesh, options);
        EXPECT_NE(F.report.why.find("radiosity within"), std::string::npos);
        EXPECT_GT(F.report.claimedRadiosityError, 0);
        EXPECT_LE(F.report.claimedRadiosityError, 2 * asked); // `exact` is cautious
        EXPECT_NEAR(F.report.claimedRadiosityError, 4 * F.report.claimedRowError, 1e-12);
        const std::vector<float> values = F.values.download<float>(n * n);
        for (const std::vector<float>& emitted : {glow, lamp}) {
            const std::vector<double> B = reference::radiosity(values, rho, emitted),
                                      truth = reference::radiosity(exact, rho, emitted);
            double worst = 0;
            for (size_t i = 0; i < n; ++i) worst = std::max(worst, std::abs(B[i] - truth[i]));
            EXPECT_LE(worst, asked * *std::max_element(truth.begin(), truth.end())) << asked;
        }
    }
    // Where no reflectance is named, the materials' counts; dark walls need little.
    geometry::PatchMesh dark = mesh;
    for (geometry::Material& m : dark.materials) m.reflectance = glm::vec3(0.1f);
    FormFactorOptions options;
    options.maxRadiosityError = 1e-3;
    const FormFactorReport report = computeFormFactors(test::device(), dark, options).report;
    EXPECT_NE(report.why.find("rows within 0.009"), std::string::npos) << report.why;
}

// Bars 2 mm thick, 2 mm before a wall: of the rays between a bar's side and a patch of the wall hardly any is
// as short as those along which both exchange what they do.
geometry::PatchMesh barsBeforeAWall() {
    geometry::PatchMesh mesh = test::boxRoom({.low = {0, 0, 0}, .high = {4, 3, 4}, .cells = {2, 2, 2}});
    const size_t room = mesh.corners.size();
    for (int k = 0; k < 2; ++k)
        test::addBox(
            mesh,
            {.low = {0.5, 1 + 0.01 * k, 0.002}, .high = {3.5, 1.002 + 0.01 * k, 0.004}, .cells = {1, 1, 1}});
    std::reverse(mesh.corners.begin() + static_cast<long>(room), mesh.corners.end()); // boxes face outwards
    return mesh;
}

TEST(FormFactors, auto_goes_on_with_visible_polygons_where_links_miss_what_was_asked) {
    if (test::device().info().type == "discrete") GTEST_SKIP() << "visible polygons, whatever stands there";
    const FormFactorReport report =
        computeFormFactors(test::device(), barsBeforeAWall(), asking("auto", 6e-3)).report;
    EXPECT_EQ(report.kernel, "exact");
    EXPECT_LE(report.claimedRowError, 6e-3);
    EXPECT_NE(report.why.find("visible polygons instead"), std::string::npos) << report.why;
    EXPECT_TRUE(report.warnings.empty());
}

// The same where visible polygons cannot be found, either.
TEST(FormFactors, auto_goes_on_with_rays_where_neither_links_nor_visible_polygons_do) {
    FormFactorOptions options = asking("auto", 6e-3);
    options.progress = [](double) { throw TooManyBlockers("too many"); };
    const FormFactorReport report =
        computeFormFactors(test::device(), barsBeforeAWall(), options).report;
    EXPECT_EQ(report.kernel, "montecarlo") << report.why;
    EXPECT_LE(report.claimedRowError, 6e-3);
    EXPECT_NE(report.why.find("where 0.006 was asked for: montecarlo"), std::string::npos) << report.why;
    EXPECT_TRUE(report.warnings.empty());
}

// Of faces in one place nobody knows who gets the light.
TEST(FormFactors, auto_says_where_no_kernel_keeps_what_was_asked) {
    geometry::PatchMesh mesh = test::boxRoom({.low = {0, 0, 0}, .high = {3, 3, 3}, .cells = {2, 2, 2}});
    const size_t room = mesh.corners.size();
    for (int twice = 0; twice < 2; ++twice)
        test::addBox(mesh, {.low = {1, 0.5, 1}, .high = {2, 1, 2}, .cells = {1, 1, 1}});
    std::reverse(mesh.corners.begin() + static_cast<long>(room), mesh.corners.end()); // facing outwards
    const FormFactorReport report = computeFormFactors(test::device(), mesh, asking("auto", 5e-3)).report;
    EXPECT_TRUE(std::ranges::any_of(report.warnings, [](const std::string& warning) {
        return warning.find("no kernel keeps the row error of 0.005") != std::string::npos;
    }));
    EXPECT_NE(report.why.find("where 0.005 was asked for"), std::string::npos) << report.why;
}

// As they come in a unit cube, with corners about `size` around.
geometry::PatchMesh looseTriangles(int count, double size) {
    std::mt19937 random(3);
    const auto in = [&](double reach) {
        const auto one = [&] { return reach * (static_cast<double>(random()) / 2147483648.0 - 1); };
        const double x = one(), y = one();
        return glm::dvec3(x, y, one());
    };
    std::vector<std::vector<glm::dvec3>> faces;
    for (int i = 0; i < count; ++i) {
        const glm::dvec3 middle = in(1), a = in(size), b = in(size);
        faces.push_back({middle + a, middle + b, middle + in(size)});
    }
    return test::polygons(faces);
}

// Triangles that lie loose, each a blocker of its own: sums of single rows may be off by much, but rows were
// asked for.
TEST(FormFactors, auto_keeps_links_whose_rows_are_as_asked) {
    if (test::device().info().type == "discrete") GTEST_SKIP() << "visible polygons, whatever stands there";
    const geometry::PatchMesh mesh = looseTriangles(450, 0.3);
    const FormFactorReport report = computeFormFactors(test::device(), mesh, asking("auto", 1e-2)).report;
    EXPECT_EQ(report.kernel, "hierarchical") << report.why;
    EXPECT_GT(report.claimedRowSumError, 15 * 1e-2); // else this tests nothing
}

// Each pair's rays say within how much they may err before all pairs have had theirs, and a second round does
// not better what a first one has not.
TEST(FormFactors, links_that_will_not_keep_what_is_asked_are_given_up_early) {
    const geometry::PatchMesh mesh = looseTriangles(100, 0.9);
    const HierarchicalFormFactors all(test::device(), mesh, {1e-2}),
        some(test::device(), mesh, {1e-2, 1.5e-2}), kept(test::device(), mesh, {3e-2, 1.0});
    EXPECT_GT(all.report().claimedRowError, 1.5e-2); // else this tests nothing
    EXPECT_FALSE(all.gaveUp());
    EXPECT_TRUE(some.gaveUp());
    EXPECT_GT(some.report().claimedRowError, 1.5e-2);
    EXPECT_FALSE(kept.gaveUp());
    EXPECT_GT(kept.statistics().links, 0u);
    const HierarchicalFormFactors stuck(test::device(), looseTriangles(30, 1.3), {3e-3});
    EXPECT_EQ(stuck.statistics().again, 1u);
}

// Scenes of so many take half a minute: whoever is told of the progress says that `exact` met them.
TEST(FormFactors, auto_goes_on_with_links_where_visible_polygons_cannot_be_found) {
    const geometry::PatchMesh mesh = test::roomWithScreens();
    const auto tooMany = [](double) { throw TooManyBlockers("too many"); };
    FormFactorOptions options = asking("auto", 2.5e-3);
    ASSERT_EQ(computeFormFactors(test::device(), mesh, options).report.kernel, "exact");
    options.progress = tooMany;
    const FormFactorReport report = computeFormFactors(test::device(), mesh, options).report;
    EXPECT_EQ(report.kernel, "hierarchical");
    EXPECT_NE(report.why.find("links between clusters instead"), std::string::npos) << report.why;
    options.kernel = "exact";
    EXPECT_THROW(computeFormFactors(test::device(), mesh, options), TooManyBlockers);

    const size_t n = mesh.patchCount();
    std::vector<double> sums(n, 0.0);
    bool first = true;
    const auto take = [&](const FormFactorTile& tile) {
        if (std::exchange(first, false)) throw TooManyBlockers("too many");
        for (size_t i = 0; i < tile.rows; ++i)
            for (size_t j = 0; j < tile.columns; ++j)
                sums[tile.firstRow + i] += double{tile.values[i * tile.columns + j]};
    };
    const FormFactorReport streamed = streamFormFactors(test::device(), mesh, asking("auto", 2.5e-3), take);
    EXPECT_EQ(streamed.kernel, "hierarchical");
    double gap = 0;
    for (double sum : sums) gap = std::max(gap, std::abs(sum - 1));
    EXPECT_NEAR(streamed.closureMax, gap, 1e-9) << "what came before is forgotten";
    first = true;
    EXPECT_THROW(streamFormFactors(test::device(), mesh, asking("exact", 2.5e-3), take), TooManyBlockers);
}

TEST(FormFactors, light_lost_in_closed_rooms_is_warned_of) {
    const geometry::PatchMesh room = geometry::readPatches(kData + "room3_672.obj");
    const FormFactorReport coarse =
        computeFormFactors(test::device(), room, asking("hierarchical", 2e-2)).report;
    ASSERT_GT(coarse.closureMax, kClosureBound);
    ASSERT_EQ(coarse.warnings.size(), 1u);
    EXPECT_NE(coarse.warnings[0].find("closed"), std::string::npos);
    EXPECT_TRUE(computeFormFactors(test::device(), room, asking("exact", 1e-3)).report.warnings.empty());
    geometry::PatchMesh insideOut = geometry::readPatches(kData + "cube_quads_1x1.obj");
    std::reverse(insideOut.corners.begin(), insideOut.corners.end()); // squares, alike in all else
    const FormFactorReport dark = computeFormFactors(test::device(), insideOut, asking("exact", 1e-3)).report;
    ASSERT_EQ(dark.warnings.size(), 1u);
    EXPECT_NE(dark.warnings[0].find("look out"), std::string::npos) << dark.warnings[0];
    // Two squares in the open: most light goes elsewhere, and should.
    const geometry::PatchMesh open = test::polygons(
        {{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}, {{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}});
    EXPECT_TRUE(
        computeFormFactors(test::device(), open, asking("hierarchical", 1e-2)).report.warnings.empty());
}

// A closed room, 3 x 3 x 2 m: one wall in strips over its whole width, one in needles from a corner, the
// others in four cells each.
geometry::PatchMesh thinPatches(int strips, int needles) {
    using glm::dvec3;
    std::vector<std::vector<dvec3>> faces;
    const dvec3 o(0), x(3, 0, 0), y(0, 3, 0), z(0, 0, 2);
    for (int k = 0; k < strips; ++k) {
        const dvec3 low = y * (double(k) / strips), high = y * (double(k + 1) / strips);
        faces.push_back({low, x + low, x + high, high});
    }
    for (int k = 0; k < needles; ++k) {
        const double low = double(k) / needles, high = double(k + 1) / needles;
        faces.push_back({z, z + y + x * low, z + y + x * high});
        faces.push_back({z, z + x + y * high, z + x + y * low});
    }
    const auto wall = [&](dvec3 corner, dvec3 u, dvec3 v) { test::addSheet(faces, corner, u, v, 2); };
    wall(o, y, z), wall(x, z, y), wall(o, z, x), wall(y, x, z);
    return test::polygons(faces);
}

TEST(FormFactors, hemicubes_keep_their_claim_on_thin_patches_and_the_error_asked_at_few_pixels) {
    for (const auto& [strips, needles] : {std::pair(60, 2), std::pair(3, 16), std::pair(40, 12)}) {
        const geometry::PatchMesh mesh = thinPatches(strips, needles);
        const size_t n = mesh.patchCount();
        const auto exact =
            exactFormFactors(test::device(), mesh, {.maxError = 3e-4}).factors.values.download<float>(n * n);
        for (double asked : {0.0, 2e-2, 6e-3}) {
            const FormFactors F = computeFormFactors(test::device(), mesh, asking("hemicube", asked));
            const double error = test::rowError(F.values.download<float>(n * n), exact);
            EXPECT_LE(error, F.report.claimedRowError) << strips << " " << asked;
            if (asked > 0) {
                EXPECT_LE(F.report.claimedRowError, asked) << strips << " " << F.report.why;
                EXPECT_LE(F.report.resolution * F.report.points, 256u) << strips; // 64 pixels, 4 points
            }
            EXPECT_LE(F.report.closureMax, 0.04) << strips; // one point alone: 0.07 and more
        }
        const FormFactorReport most =
            computeFormFactors(test::device(), mesh, asking("hemicube", 1e-5)).report;
        EXPECT_NE(most.why.find("remains"), std::string::npos) << most.why;
    }
}

TEST(FormFactors, hemicubes_claim_what_falls_between_their_pixels) {
    const double a = 0.01;
    const geometry::PatchMesh mesh = test::polygons(
        {{{0, 0, 0}, {a, 0, 0}, {a, a, 0}, {0, a, 0}}, {{0, 0, 1}, {0, a, 1}, {a, a, 1}, {a, 0, 1}}});
    for (double asked : {0.0, 1e-3, 1e-5}) {
        const FormFactors F = computeFormFactors(test::device(), mesh, asking("hemicube", asked));
        const double error =
            F.values.download<float>(4)[1] - a * a / std::numbers::pi; // Howell, C-11, far apart
        EXPECT_LE(std::abs(error), F.report.claimedRowError) << asked;
        EXPECT_LE(F.report.claimedRowError, 1e-3) << asked;
    }
}

// Half-way between two squares a screen ends: both their middles see as much of the other, and both wrong
// alike.
TEST(FormFactors, hemicubes_claim_what_both_ends_see_wrong_alike) {
    for (double edge : {-0.2, -0.1, 0.0, 0.1, 0.2, 0.25, 0.3, 0.4}) {
        const geometry::PatchMesh mesh =
            test::polygons({{{-0.5, 0, -0.5}, {-0.5, 0, 0.5}, {0.5, 0, 0.5}, {0.5, 0, -0.5}},
                            {{-0.5, 4, -0.5}, {0.5, 4, -0.5}, {0.5, 4, 0.5}, {-0.5, 4, 0.5}},
                            {{edge, 2, -3}, {edge, 2, 3}, {3, 2, 3}, {3, 2, -3}}});
        const std::vector<double> exact = reference::exactFormFactors(mesh);
        const FormFactors F = computeFormFactors(test::device(), mesh, asking("hemicube", 0));
        EXPECT_LE(test::rowError(F.values.download<float>(9), {exact.begin(), exact.end()}),
                  F.report.claimedRowError)
            << edge;
    }
}

TEST(FormFactors, tiles_make_up_the_matrix) {
    test::BoxRoom box;
    box.cells = {9, 7, 8}; // more rows than one block of a stream
    const geometry::PatchMesh mesh = test::boxRoom(box);
    const size_t n = mesh.patchCount();
    for (std::string_view kernel : formFactorKernels()) {
        FormFactorOptions options;
        options.kernel = kernel;
        options.resolution = 15;
        std::vector<float> values(n * n, -1.0f);
        const FormFactorReport report =
            streamFormFactors(test::device(), mesh, options, [&](const FormFactorTile& tile) {
                for (size_t i = 0; i < tile.rows; ++i)
                    for (size_t j = 0; j < tile.columns; ++j) {
                        float& place = values[(tile.firstRow + i) * n + tile.firstColumn + j];
                        EXPECT_EQ(place, -1.0f);
                        place = tile.values[i * tile.columns + j];
                    }
            });
        EXPECT_EQ(report.kernel, kernel);
        if (kernel == "hemicube") { // rounds up to even ones, and says so
            EXPECT_EQ(report.resolution, 16u);
            EXPECT_EQ(computeFormFactors(test::device(), mesh, options).report.resolution, 16u);
        }
        // The others' rows are not averaged with their columns.
        EXPECT_EQ(report.reciprocityRms.has_value(), kernel == "exact" || kernel == "hierarchical");
        if (report.reciprocityRms) {
            const FormFactors whole = computeFormFactors(test::device(), mesh, options);
            EXPECT_EQ(values, whole.values.download<float>(n * n));
            EXPECT_NEAR(*report.reciprocityRms, whole.report.reciprocityRms.value(), 1e-7);
        }
        for (size_t i = 0; i < n; ++i) {
            double sum = 0;
            for (size_t j = 0; j < n; ++j) sum += double{values[i * n + j]};
            EXPECT_NEAR(sum, 1, 0.05) << kernel;
        }
    }
}

TEST(FormFactors, a_stream_keeps_the_error_asked_or_refuses_it) {
    test::BoxRoom box;
    box.cells = {9, 7, 8};
    const geometry::PatchMesh mesh = test::boxRoom(box);
    const size_t n = mesh.patchCount();
    const auto exact =
        exactFormFactors(test::device(), mesh, {.maxError = 1e-5}).factors.values.download<float>(n * n);
    for (double asked : {2e-2, 5e-3}) {
        double squares = 0;
        const FormFactorReport report = streamFormFactors(
            test::device(), mesh, asking("montecarlo", asked), [&](const FormFactorTile& tile) {
                for (size_t k = 0; k < tile.values.size(); ++k) // rows as wide as the matrix
                    squares += std::pow(double{tile.values[k]} - double{exact[tile.firstRow * n + k]}, 2);
            });
        EXPECT_LE(report.claimedRowError, asked);
        EXPECT_LE(std::sqrt(squares / static_cast<double>(n)), asked);
        EXPECT_GE(report.claimedRowError, 0.3 * asked); // no more rays than it takes
    }
    box.cells = {1, 1, 1};
    const FormFactorReport most = streamFormFactors(test::device(), test::boxRoom(box),
                                                    asking("montecarlo", 1e-6), [](const FormFactorTile&) {});
    EXPECT_GT(most.claimedRowError, 1e-6);
    EXPECT_NE(most.why.find("the most there are"), std::string::npos) << most.why;
    EXPECT_THROW(
        streamFormFactors(test::device(), mesh, asking("hemicube", 1e-2), [](const FormFactorTile&) {}),
        geometry::InputError);
}

// Sheets that lean, without thickness, patches on both sides: depths of both agree up to rounding, and so do
// corners that one triangle shares with the one behind it.
TEST(FormFactors, of_leaning_sheets_the_front_is_seen_and_nothing_passes_to_the_back) {
    std::vector<std::vector<glm::dvec3>> faces;
    const auto sheet = [&](glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, int times) {
        test::addSheet(faces, corner, u, v, times);
    };
    const auto both = [&](glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v) {
        sheet(corner, u, v, 3);
        const size_t end = faces.size();
        for (size_t k = end - 18; k < end; ++k) faces.push_back({faces[k][2], faces[k][1], faces[k][0]});
    };
    sheet({-3, 0, -3}, {0, 0, 6}, {6, 0, 0}, 5);
    both({-1.3, 0.2, 0.4}, {1.9, 0, 0.77}, {0.31, 1.7, -0.23});
    both({-0.7, 0.3, -1.6}, {1.4, 0, -0.9}, {-0.27, 1.9, 0.41});
    const geometry::PatchMesh mesh = test::polygons(faces);
    const size_t n = mesh.patchCount();
    const auto exact =
        exactFormFactors(test::device(), mesh, {.maxError = 1e-4}).factors.values.download<float>(n * n);
    for (uint32_t resolution : {64u, 128u})
        for (uint32_t points : {1u, 4u}) {
            FormFactorOptions options;
            options.kernel = "hemicube", options.resolution = resolution, options.points = points;
            const FormFactors F = computeFormFactors(test::device(), mesh, options);
            const auto values = F.values.download<float>(n * n);
            EXPECT_LT(test::rowError(values, exact), F.report.claimedRowError);
            EXPECT_GT(test::rowError(values, exact), 0.12 * F.report.claimedRowError);
            EXPECT_LT(test::rowError(values, exact), 5e-3);
        }
}

} // namespace
} // namespace heliodon::compute
