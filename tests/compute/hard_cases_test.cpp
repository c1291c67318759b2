// Named cases on which form-factor programs fail; every kernel against closed forms or the double-precision
// oracle. With HELIODON_HARD_CASES=FILE in the environment the table of docs/accuracy.md is appended there.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "compute/exact_form_factors.h"
#include "compute/form_factors.h"
#include "tests/compute/form_factor_cases.h"
#include "tests/compute/rooms.h"
#include "tests/gpu/test_device.h"
#include "tests/sanitized.h"

namespace heliodon::compute {
namespace {

using reference::Polygon;
using Polygons = std::vector<Polygon>;

// Counter-clockwise about u x v.
Polygon rectangle(glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v) {
    return {corner, corner + u, corner + u + v, corner + v};
}

// Six faces; normals out of the box, or into it.
Polygons box(glm::dvec3 low, glm::dvec3 size, bool inward) {
    const glm::dvec3 x{size.x, 0, 0}, y{0, size.y, 0}, z{0, 0, size.z};
    Polygons faces{rectangle(low, y, x),     rectangle(low + z, x, y), rectangle(low, x, z),
                   rectangle(low + y, z, x), rectangle(low, z, y),     rectangle(low + x, y, z)};
    if (inward)
        for (Polygon& face : faces) std::reverse(face.begin(), face.end());
    return faces;
}

struct Case {
    std::string name;
    Polygons polygons;
    size_t i, j;
    double tolerance; // of F_ij, absolute
    double closed;    // closed form, or NaN: the oracle decides
};

const double kOracle = NAN;

std::vector<Case> hardCases() {
    const Polygon floor = rectangle({0, 0, 0}, {0, 0, 1}, {1, 0, 0}); // normal +y
    const Polygon lid = rectangle({0, 1, 0}, {1, 0, 0}, {0, 0, 1});   // normal -y, one above
    const double opposed = 0.19982489569838738, adjacent = 0.20004377607540316;
    std::vector<Case> cases;
    const auto add = [&](const std::string& name, Polygons polygons, double tolerance,
                         double closed = kOracle) {
        cases.push_back({name, std::move(polygons), 0, 1, tolerance, closed});
    };
    add("sliver 1e4 : 1 facing a square", {rectangle({0, 0, 0}, {0, 0, 1e-4}, {1, 0, 0}), lid}, 2e-6);
    add("shared edge, 90 degrees", {floor, rectangle({0, 0, 0}, {0, 1, 0}, {0, 0, 1})}, 1e-6, adjacent);
    add("edge nearly shared (1e-6)", {floor, rectangle({-1e-6, 0, 0}, {0, 1, 0}, {0, 0, 1})}, 2e-6);
    add("coplanar", {floor, rectangle({1, 0, 0}, {0, 0, 1}, {1, 0, 0})}, 0, 0);
    add("nearly coplanar (179.9 degrees)", {floor, rectangle({1, 0, 0}, {0, 0, 1}, {1, 0.0017453, 0})}, 1e-6);
    add("interpenetrating squares", {floor, rectangle({0.5, -0.5, 0}, {0, 0, 1}, {0, 1, 0})}, 1e-6);
    add("patch across another's plane", {floor, rectangle({1, -0.3, 0}, {0, 0, 1}, {0, 1, 0})}, 1e-6);
    add("blocker 1e-5 from the receiver",
        {floor, lid, rectangle({0.25, 1 - 1e-5, 0.25}, {0.5, 0, 0}, {0, 0, 0.5})}, 1e-5);
    add("blocker 1e-5 over half of the emitter, seen from behind",
        {floor, lid, rectangle({0, 1e-5, 0}, {0.5, 0, 0}, {0, 0, 1})}, 1e-5);
    // As much as their hull has beyond both.
    add("two blockers that overlap in a plane",
        {floor, lid, rectangle({0.2, 0.5, 0.2}, {0.4, 0, 0}, {0, 0, 0.4}),
         rectangle({0.4, 0.5, 0.4}, {0.4, 0, 0}, {0, 0, 0.4})},
        2e-5);
    add("blocker touching the emitter's edge", {floor, lid, rectangle({0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 1})},
        1e-5);
    Polygons louvres{floor, lid};
    for (int k = 0; k < 8; ++k)
        louvres.push_back(rectangle({0.0625 + 0.125 * k, 0.4, -1}, {0.05, 0.1, 0}, {0, 0, 3}));
    add("eight louvres", louvres, 2e-5);
    add("slot of 1 %",
        {floor, lid, rectangle({-1, 0.5, -1}, {1.495, 0, 0}, {0, 0, 3}),
         rectangle({0.505, 0.5, -1}, {1.495, 0, 0}, {0, 0, 3})},
        1e-5);
    add("size ratio 1e6",
        {rectangle({0, 0, 0}, {0, 0, 1e-3}, {1e-3, 0, 0}),
         rectangle({-500, 1, -500}, {1000, 0, 0}, {0, 0, 1000})},
        1e-6);
    Polygons far{floor, lid};
    for (Polygon& polygon : far)
        for (glm::dvec3& p : polygon) p += glm::dvec3(1e4, -1e4, 1e4);
    add("coordinates offset by 1e4", far, 1e-6, opposed);
    add("blocker listed twice",
        {floor, lid, rectangle({0.25, 0.5, 0.25}, {0.5, 0, 0}, {0, 0, 0.5}),
         rectangle({0.25, 0.5, 0.25}, {0.5, 0, 0}, {0, 0, 0.5})},
        1e-5, 0.099506294598984786);
    add("blocker seen from behind", {floor, lid, rectangle({0.25, 0.5, 0.25}, {0, 0, 0.5}, {0.5, 0, 0})},
        1e-5, 0.099506294598984786);
    add("blocker hides all", {floor, lid, rectangle({-1, 0.5, -1}, {3, 0, 0}, {0, 0, 3})}, 0, 0);
    add("blocker in two halves hides all",
        {floor, lid, rectangle({-1, 0.5, -1}, {1.5, 0, 0}, {0, 0, 3}),
         rectangle({0.5, 0.5, -1}, {1.5, 0, 0}, {0, 0, 3})},
        0, 0);
    add("blocker outside the shaft", {floor, lid, rectangle({1.001, 0, 0}, {0, 1, 0}, {0, 0, 1})}, 1e-6,
        opposed);
    add("emitter of 1e-6 of the area", {rectangle({0.5, 0, 0.5}, {0, 0, 1e-3}, {1e-3, 0, 0}), lid}, 1e-6);
    add("emitter of 1e-6 beside a slot of 0.1 %",
        {rectangle({0.7, 0, 0.6}, {0, 0, 1e-3}, {1e-3, 0, 0}), lid,
         rectangle({-1, 0.5, -1}, {1.4995, 0, 0}, {0, 0, 3}),
         rectangle({0.5005, 0.5, -1}, {1.4995, 0, 0}, {0, 0, 3})},
        1e-6);
    // No edge of one goes through a face of the other; what of the end lies within sees backs alone.
    Polygons boards = box({0, 0, 0}, {1, 1, 0.2}, false);
    for (Polygon& face : box({0.2, 0, -0.5}, {0.4, 1, 0.7}, false)) {
        for (glm::dvec3& p : face) {
            const double x = p.x - 0.4, z = p.z - 0.2;
            p = {0.4 + std::cos(0.5) * x + std::sin(0.5) * z, p.y,
                 0.2 - std::sin(0.5) * x + std::cos(0.5) * z};
        }
        boards.push_back(face);
    }
    boards.push_back(rectangle({0, 0, 1}, {0, 1, 0}, {1, 0, 0}));
    cases.push_back({"end of a board half inside another of its height", boards, 7, 12, 1e-5, kOracle});
    return cases;
}

// How each kernel is asked, and what it must keep besides the case's own tolerance. A hemicube sees slivers,
// contact and slots only as well as its points and pixels resolve them; rays have four standard errors of a
// row of 2^16 rays or so.
struct Judged {
    const char* kernel;
    FormFactorOptions options;
    double tolerance;
};

const std::vector<Judged>& judgedKernels() {
    static const std::vector<Judged> all{{"exact", {"exact", 64, 1, 2e-6}, 0},
                                         {"hemicube", {"hemicube", 128, 64}, 2e-2},
                                         {"hierarchical", {"hierarchical", 64, 1, 1e-3}, 5e-3},
                                         {"montecarlo", {"montecarlo", 64, 1, 2e-3}, 1e-2}};
    return all;
}

std::vector<float> matrixOf(const geometry::PatchMesh& mesh, const FormFactorOptions& options) {
    return computeFormFactors(test::device(), mesh, options)
        .values.download<float>(mesh.patchCount() * mesh.patchCount());
}

// One row of the table: error and verdict of every kernel.
class TableRow {
public:
    TableRow(const std::string& name, const std::string& truth)
        : text_(fmt::format("| {} | {} |", name, truth)) {}
    ~TableRow() {
        if (const char* file = std::getenv("HELIODON_HARD_CASES"))
            std::ofstream(file, std::ios::app) << text_ << "\n";
    }
    void add(double error, double tolerance) {
        text_ += fmt::format(" {:.1e} {} |", error, error <= tolerance ? "holds" : "**fails**");
    }

private:
    std::string text_;
};

class HardCases : public testing::TestWithParam<Case> {};

TEST_P(HardCases, agree) {
    const Case& c = GetParam();
    const geometry::PatchMesh mesh = test::meshOf(c.polygons);
    const size_t n = mesh.patchCount();
    const double truth = !std::isnan(c.closed) ? c.closed
                                               : reference::exchangeIn(mesh, c.i, c.j, 1e-6, 3000).value /
                                                     geometry::patchArea(mesh, c.i);
    TableRow row(c.name, fmt::format("{:.8g}", truth));
    for (const Judged& judged : judgedKernels()) {
        const double error = std::abs(double{matrixOf(mesh, judged.options)[c.i * n + c.j]} - truth);
        const double tolerance = std::max(c.tolerance, judged.tolerance);
        EXPECT_LE(error, tolerance) << judged.kernel;
        row.add(error, tolerance);
    }
}

INSTANTIATE_TEST_SUITE_P(Exact, HardCases, testing::ValuesIn(hardCases()), [](const auto& parameter) {
    std::string name = parameter.param.name;
    for (char& letter : name)
        if (!std::isalnum(static_cast<unsigned char>(letter))) letter = '_';
    return name;
});

// 1 : 1 : 0.001, seen from inside: rows must close without normalisation. Gaps of a thousandth sum many small
// cells.
TEST(HardCases, thin_slab_closes) {
    const geometry::PatchMesh mesh = test::meshOf(box({0, 0, 0}, {1, 0.001, 1}, true));
    const std::vector<float> F =
        exactFormFactors(test::device(), mesh, {1e-6}).factors.values.download<float>(36);
    for (size_t i = 0; i < 6; ++i) {
        double sum = 0;
        for (size_t j = 0; j < 6; ++j) sum += F[6 * i + j];
        EXPECT_NEAR(sum, 1, 1e-5) << i;
    }
}

// What counts as a wall's own plane must not take the next slab of a pile for it, or each face sees past its
// neighbour and rows sum to two. 1e-7 m are less than float32 tells apart across a room.
TEST(HardCases, slabs_a_micrometre_apart_close) {
    for (const auto& [gap, turn] : {std::pair(1e-6, 0.0), std::pair(1e-7, 0.1)}) {
        const geometry::PatchMesh mesh = test::pileOfSlabs(gap, turn, {turn, 2 * turn, 0});
        const ExactFormFactors F = exactFormFactors(test::device(), mesh, {1e-3});
        const size_t n = mesh.patchCount();
        const std::vector<float> values = F.factors.values.download<float>(n * n);
        for (size_t i = 0; i < n; ++i) {
            double sum = 0;
            for (size_t j = 0; j < n; ++j) {
                const double there = double{values[i * n + j]} * geometry::patchArea(mesh, i),
                             back = double{values[j * n + i]} * geometry::patchArea(mesh, j);
                EXPECT_NEAR(there, back, 1e-6 * std::max(there, back)) << i << " " << j;
                sum += double{values[i * n + j]};
            }
            EXPECT_NEAR(sum, 1, 5e-3) << "gap " << gap << ", turned by " << turn << ", row " << i;
        }
        EXPECT_LT(F.factors.report.claimedRowError, 2e-3);
        // Of patches, however many pieces what is covered leaves of them; rows behind crowds are claimed as
        // cautiously as their entries, up to 2.6 times.
        double squares = 0;
        for (float error : F.rowError) squares += std::pow(double{error}, 2);
        const double caution = std::sqrt(squares / static_cast<double>(n)) / F.factors.report.claimedRowError;
        EXPECT_GT(caution, 1.3 * 0.999);
        EXPECT_LT(caution, 1.3 * 2.6 * 1.001);
    }
}

// Heights of the patch over the wall are as small as what float32 rounds at places in the wall. Rays lose
// them.
TEST(HardCases, a_millimetre_at_the_foot_of_a_kilometre_keeps_its_light_or_claims_the_loss) {
    const geometry::PatchMesh mesh = test::meshOf({rectangle({0, 0, 500}, {0, 0, 1e-3}, {1e-3, 0, 0}),
                                                   rectangle({0, 0, 0}, {0, 1000, 0}, {0, 0, 1000})});
    for (const Judged& judged : judgedKernels()) {
        const FormFactors F = computeFormFactors(test::device(), mesh, judged.options);
        const double error = std::abs(double{F.values.download<float>(4)[1]} - 0.5); // of the half space
        if (F.report.kernel == "montecarlo")
            EXPECT_LT(error, std::sqrt(2.0) * F.report.claimedRowError); // RMS of two rows, one of them empty
        else
            EXPECT_LT(error, 1e-5) << judged.kernel;
    }
}

// What the floor gives the die covers a millionth of a millionth of it: no more of a row than one is off.
TEST(HardCases, a_die_over_a_floor_of_a_kilometre_claims_errors_of_its_size) {
    Polygons polygons = box({0, 0, 0}, {1000, 1000, 1000}, true);
    const Polygons die = box({500, 1e-3, 500}, {1e-3, 1e-3, 1e-3}, false);
    polygons.insert(polygons.end(), die.begin(), die.end());
    const FormFactors F = computeFormFactors(test::device(), test::meshOf(polygons),
                                             {.kernel = "hierarchical", .maxError = 5e-3});
    EXPECT_LT(F.report.closureMax, 5e-3);
    EXPECT_LT(F.report.claimedRowError, 5);
}

// What lies this near to a floor hides nothing of it, so the box's far side has to: seen from behind.
TEST(HardCases, boxes_that_float_or_sink_by_ten_micrometres_hide_the_floor_beneath) {
    for (const double height : {1e-5, -1e-5}) {
        Polygons polygons = box({0, 0, 0}, {2.7, 2.7, 2.7}, true);
        const Polygons cabinet = box({0.8, height, 0.9}, {1, 0.4, 0.8}, false);
        polygons.insert(polygons.end(), cabinet.begin(), cabinet.end());
        const geometry::PatchMesh mesh = test::meshOf(polygons);
        const size_t n = mesh.patchCount(), floor = 2, ceiling = 3;
        const double truth = reference::exchangeIn(mesh, floor, ceiling, 1e-5, 300).value / (2.7 * 2.7);
        TableRow row(fmt::format("cabinet {} a floor by 1e-5", height > 0 ? "above" : "sunk into"),
                     fmt::format("{:.8g}", truth));
        for (Judged judged : judgedKernels()) {
            judged.options.maxError = std::max(judged.options.maxError, 1e-4);
            const double error =
                std::abs(double{matrixOf(mesh, judged.options)[floor * n + ceiling]} - truth);
            const double tolerance = std::max(1e-4, judged.tolerance);
            EXPECT_LE(error, tolerance) << judged.kernel << " " << height;
            row.add(error, tolerance);
        }
    }
}

// 0.4 + 3 x 0.8 is not 1.2 + 2 x 0.8 in double precision: of such faces nothing lies before the other.
TEST(HardCases, furniture_pushed_together_exchanges_nothing_between_its_faces) {
    for (const double turn : {0.0, 0.3}) {
        Polygons polygons = box({0, 0, 0}, {4, 2.7, 3}, true);
        for (int k = 0; k < 4; ++k) {
            const double left = 0.4 + 0.8 * k, right = 1.2 + 0.8 * k;
            const Polygons cupboard = box({left, 0.3, 2.2}, {right - left, 0.9 + 0.2 * (k % 2), 0.6}, false);
            for (Polygon face : cupboard) {
                for (glm::dvec3& p : face) // its own right side, not left + size
                    if (std::abs(p.x - right) < 1e-9) p.x = right;
                polygons.push_back(std::move(face));
            }
        }
        for (Polygon& face : polygons)
            for (glm::dvec3& p : face)
                p = {std::cos(turn) * p.x + std::sin(turn) * p.z, p.y,
                     std::cos(turn) * p.z - std::sin(turn) * p.x};
        const geometry::PatchMesh mesh = test::meshOf(polygons);
        const size_t n = mesh.patchCount();
        for (Judged judged : judgedKernels()) {
            judged.options.maxError = 1e-2;
            const std::vector<float> F = matrixOf(mesh, judged.options);
            for (size_t k = 0; k < 3; ++k) {
                const size_t right = 6 + 6 * k + 5, left = 6 + 6 * (k + 1) + 4;
                EXPECT_LT(F[right * n + left], 1e-6) << judged.kernel << " " << turn << " " << k;
                EXPECT_LT(F[left * n + right], 1e-6) << judged.kernel << " " << turn << " " << k;
            }
        }
    }
}

// A cupboard 1e-5 m before a wall, on a floor that goes on beneath it: its back is no border of the room.
TEST(HardCases, what_stands_a_hair_from_a_wall_hides_it) {
    Polygons polygons = box({0, 0, 0}, {4, 2.7, 3}, true);
    for (Polygon& face : box({0.5, 0, 2.9}, {3, 2.2, 0.1 - 1e-5}, false))
        if (std::ranges::any_of(face, [](const glm::dvec3& p) { return p.y > 0; }))
            polygons.push_back(std::move(face));
    ASSERT_EQ(polygons.size(), 11u); // no bottom
    const geometry::PatchMesh mesh = test::meshOf(polygons);
    const size_t n = mesh.patchCount();
    for (Judged judged : judgedKernels()) {
        judged.options.maxError = 3e-3;
        const std::vector<float> F = matrixOf(mesh, judged.options);
        for (size_t i = 0; i < 6; ++i) {
            double sum = 0;
            for (size_t j = 0; j < n; ++j) sum += double{F[i * n + j]};
            EXPECT_LT(sum, 1 + 2 * judged.options.maxError) << judged.kernel << " " << i;
        }
    }
}

// Error of the rows of hemicubes, RMS over rows of the L2 distance from `truth`, over what they claim.
double hemicubeErrorOverClaim(const Polygons& polygons, const std::vector<double>& truth) {
    const geometry::PatchMesh mesh = test::meshOf(polygons);
    const size_t n = mesh.patchCount();
    const FormFactors F = computeFormFactors(test::device(), mesh, {.kernel = "hemicube"});
    const std::vector<float> values = F.values.download<float>(n * n);
    double squares = 0;
    for (size_t k = 0; k < n * n; ++k) squares += std::pow(double{values[k]} - truth[k], 2);
    return std::sqrt(squares / static_cast<double>(n)) / F.report.claimedRowError;
}

// All pairs are near, so that links alone say what may be missed; few of their rays find a slot.
TEST(HardCases, hemicubes_claim_what_rays_miss_of_slots) {
    const Polygon floor = rectangle({0, 0, 0}, {0, 0, 1}, {1, 0, 0}),
                  lid = rectangle({0, 1, 0}, {1, 0, 0}, {0, 0, 1});
    Polygons behind{floor, lid};
    for (const auto& [y, x] : {std::pair(0.3, 0.4), std::pair(0.7, 0.5)}) {
        behind.push_back(rectangle({-1, y, -1}, {0.995 + x, 0, 0}, {0, 0, 3}));
        behind.push_back(rectangle({x + 0.005, y, -1}, {2 - x, 0, 0}, {0, 0, 3}));
    }
    const Polygons diagonal{floor,
                            lid,
                            {{-1, 0.5, -1}, {1.993, 0.5, -1}, {-1, 0.5, 1.993}},
                            {{2.007, 0.5, -1}, {2.007, 0.5, 2}, {-1, 0.5, 2.007}}};
    for (const Polygons& polygons : {behind, diagonal})
        EXPECT_LT(
            hemicubeErrorOverClaim(polygons, reference::exactFormFactors(test::meshOf(polygons), 1e-5, 1000)),
            1)
            << polygons.size();
}

// An exchange of four links is one value, which luck moves farther than a sum of four squares: half of what
// passes behind fifty slats in step with the rays is off by 2e-3.
TEST(HardCases, hemicubes_claim_what_rays_in_step_with_slats_miss) {
    Polygons slats{rectangle({0, 0, 0}, {0, 0, 1}, {1, 0, 0}), rectangle({0, 1, 0}, {1, 0, 0}, {0, 0, 1})};
    for (int k = 0; k < 50; ++k)
        slats.push_back(rectangle({-1 + 0.06 * k, 0.5, -1}, {0.03, 0, 0}, {0, 0, 3}));
    EXPECT_LT(hemicubeErrorOverClaim(slats, reference::exactFormFactors(test::meshOf(slats), 1e-4, 1000)), 1);
}

// What rays that agreed have missed is taken off all triangles' links by one factor: of a polygon's 62
// triangles those errors add up.
TEST(HardCases, hemicubes_claim_what_is_taken_off_all_triangles_of_polygons) {
    const auto disc = [](double y, double radius, bool up) {
        Polygon corners;
        for (int k = 0; k < 64; ++k) {
            const double turn = (up ? -2 : 2) * std::numbers::pi * k / 64;
            corners.push_back({radius * std::cos(turn), y, radius * std::sin(turn)});
        }
        return corners;
    };
    const Polygons discs{disc(0, 1, true), disc(1, 1, false), disc(0.5, 0.3, true)};
    // Of the double-precision oracle at 1e-6, which takes 20 s; the last two in the open.
    constexpr double kOuter = 0.314674, kUp = 0.0708936, kDown = 0.787706;
    EXPECT_LT(hemicubeErrorOverClaim(discs, {0, kOuter, 0, kOuter, 0, kUp, 0, kDown, 0}), 1);
}

// Rays end on a slab's own face or miss the next one's: rows of zero, which the spread of rays does not show.
TEST(HardCases, light_that_rays_lose_in_narrow_gaps_is_claimed) {
    const geometry::PatchMesh mesh = test::pileOfSlabs(1e-6, 0, {0, 0, 0});
    const FormFactorOptions options{.kernel = "montecarlo", .maxError = 1e-2};
    const FormFactors F = computeFormFactors(test::device(), mesh, options);
    EXPECT_GE(F.report.claimedRowError, 0.9 * F.report.closureRms); // of each such row one entry is lost
    EXPECT_FALSE(F.report.warnings.empty());
    const FormFactorReport streamed =
        streamFormFactors(test::device(), mesh, options, [](const FormFactorTile&) {});
    EXPECT_GE(streamed.claimedRowError, 0.9 * streamed.closureRms);
}

// A ceiling that is listed twice gets the light of each patch twice, or once, by chance: told, whatever the
// kernel claims by itself.
TEST(HardCases, rows_above_one_are_within_the_claim) {
    Polygons polygons = box({0, 0, 0}, {1, 1, 1}, true);
    polygons.push_back(polygons[3]);
    const geometry::PatchMesh mesh = test::meshOf(polygons);
    for (const std::string kernel : {"exact", "hierarchical", "montecarlo"}) {
        const bool whole = kernel != "montecarlo";
        FormFactorReport report =
            computeFormFactors(test::device(), mesh, {.kernel = kernel, .maxError = whole ? 1e-3 : 1e-2})
                .report;
        EXPECT_GE(report.claimedRowError, whole ? 0.19 : 0.16) << kernel; // 0.2 of one entry in most rows
        EXPECT_FALSE(report.warnings.empty()) << kernel;
        if (!whole) continue;
        EXPECT_NEAR(report.closureMax, 0.2, 0.01) << kernel;
        EXPECT_GE(report.claimedRowSumError, report.closureMax) << kernel;
        report = streamFormFactors(test::device(), mesh, {.kernel = kernel, .maxError = 1e-3},
                                   [](const FormFactorTile&) {});
        EXPECT_GE(report.claimedRowSumError, 0.19) << kernel;
    }
}

TEST(HardCases, degenerate_patches_have_zero_rows_and_harm_nobody) {
    Polygons polygons{rectangle({0, 0, 0}, {0, 0, 1}, {1, 0, 0}),
                      rectangle({0, 1, 0}, {1, 0, 0}, {0, 0, 1}),
                      {{0, 0.5, 0}, {0.5, 0.5, 0.5}, {1, 0.5, 1}}};
    const geometry::PatchMesh mesh = test::meshOf(polygons);
    const std::vector<float> F =
        exactFormFactors(test::device(), mesh, {1e-6}).factors.values.download<float>(9);
    EXPECT_NEAR(F[1], 0.19982489569838738, 1e-6);
    for (size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(F[6 + k], 0.0f);
        EXPECT_EQ(F[3 * k + 2], 0.0f);
    }
}

struct Scene {
    std::string name;
    Polygons polygons;
};

Polygon regular(size_t corners, glm::dvec3 middle, double radius, bool up) {
    Polygon polygon;
    for (size_t k = 0; k < corners; ++k) {
        const double angle = 2 * M_PI * static_cast<double>(k) / static_cast<double>(corners) * (up ? -1 : 1);
        polygon.push_back(middle + radius * glm::dvec3(std::cos(angle), 0, std::sin(angle)));
    }
    return polygon;
}

// Rooms unlike boxes of triangles: convex polygons, openings in partitions without thickness (a patch on
// either side), a table top that hovers, walls that pass through one another.
std::vector<Scene> hardScenes() {
    Polygons halls = box({0, 0, 0}, {4, 2.5, 3}, true);
    const auto bothSides = [](Polygons& polygons, const Polygon& face) {
        polygons.push_back(face);
        polygons.emplace_back(face.rbegin(), face.rend());
    };
    bothSides(halls, rectangle({2, 0, 0}, {0, 2.5, 0}, {0, 0, 1})); // beside, beyond and above a door
    bothSides(halls, rectangle({2, 0, 2}, {0, 2.5, 0}, {0, 0, 1}));
    bothSides(halls, rectangle({2, 2, 1}, {0, 0.5, 0}, {0, 0, 1}));
    Polygons prism{regular(6, {0, 0, 0}, 2, true), regular(6, {0, 2, 0}, 2, false)};
    for (size_t k = 0; k < 6; ++k) {
        const Polygon& floor = prism[0];
        const glm::dvec3 a = floor[k], b = floor[(k + 1) % 6], up{0, 2, 0};
        prism.push_back({b, a, a + up, b + up});
    }
    bothSides(prism, regular(8, {0.2, 0.8, 0.1}, 0.7, true));
    return {{"door in a partition without thickness", halls}, {"hexagonal room, octagonal table", prism}};
}

// Largest error of all entries against the oracle (asked for 1e-7), and closure of the rows.
TEST(HardCases, rooms_of_odd_shapes_agree_with_the_oracle_and_close) {
    for (const Scene& scene : hardScenes()) {
        const geometry::PatchMesh mesh = test::meshOf(scene.polygons);
        const size_t n = mesh.patchCount();
        const std::vector<double> truth = reference::exactFormFactors(mesh, 1e-7, 1000);
        TableRow row(scene.name + ", largest of all entries", fmt::format("{} patches", n));
        for (const Judged& judged : judgedKernels()) {
            FormFactorOptions options = judged.options;
            options.maxError = std::max(options.maxError, options.kernel == "exact" ? 1e-5 : 0.0);
            const std::vector<float> F = matrixOf(mesh, options);
            double worst = 0, open = 0;
            for (size_t i = 0; i < n; ++i) {
                double sum = 0;
                for (size_t j = 0; j < n; ++j) {
                    worst = std::max(worst, std::abs(double{F[i * n + j]} - truth[i * n + j]));
                    sum += double{F[i * n + j]};
                }
                open = std::max(open, std::abs(sum - 1));
            }
            const double tolerance = std::max(3e-5, judged.tolerance);
            EXPECT_LE(worst, tolerance) << scene.name << " " << judged.kernel;
            if (judged.options.kernel == "exact") {
                EXPECT_LE(open, 3e-5) << scene.name;
            }
            row.add(worst, tolerance);
        }
        if (test::kSanitized) break;
    }
}

// All walls of reflectance 0.99 and equal emission: B = E / (1 - rho). Rows that do not close are amplified a
// hundredfold.
TEST(HardCases, white_closed_room_keeps_its_radiosity) {
    Polygons polygons;
    for (const Polygon& face : box({0, 0, 0}, {1, 2, 3}, true))
        for (int half : {0, 1}) {
            const glm::dvec3 a = 0.5 * (face[0] + face[1]), b = 0.5 * (face[2] + face[3]);
            polygons.push_back(half ? Polygon{face[0], a, b, face[3]} : Polygon{a, face[1], face[2], b});
        }
    const geometry::PatchMesh mesh = test::meshOf(polygons);
    const size_t n = mesh.patchCount();
    TableRow row("closed room, reflectance 0.99: radiosity", "100 E");
    for (const Judged& judged : judgedKernels()) {
        const std::vector<float> F = matrixOf(mesh, judged.options);
        std::vector<double> B(n, 1.0);
        for (int pass = 0; pass < 2000; ++pass)
            for (size_t i = 0; i < n; ++i) {
                double sum = 0;
                for (size_t j = 0; j < n; ++j) sum += double{F[i * n + j]} * B[j];
                B[i] = 1 + 0.99 * sum;
            }
        double worst = 0;
        for (double b : B) worst = std::max(worst, std::abs(b / 100 - 1));
        const double tolerance = 100 * std::max(1e-5, 2 * judged.tolerance);
        EXPECT_LE(worst, tolerance) << judged.kernel;
        row.add(worst, tolerance);
    }
}

} // namespace
} // namespace heliodon::compute
