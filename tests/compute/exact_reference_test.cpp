#include "compute/reference/exact_form_factors.h"

#include <cmath>
#include <fstream>
#include <numeric>
#include <utility>

#include <gtest/gtest.h>

#include "compute/reference/form_factor_rows.h"
#include "geometry/model_file.h"
#include "tests/compute/form_factor_cases.h"
#include "tests/compute/rooms.h"

namespace heliodon::compute::reference {
namespace {

// 1e-12 is what the oracle must hold to judge kernels of 1e-6; the values themselves carry about 1e-15.
TEST(ExactReference, unoccluded_pairs_agree_with_closed_forms) {
    for (const auto& c : test::formFactorCases("unoccluded"))
        for (const auto& f : c.entries) {
            const double value =
                exchangeUnoccluded(c.polygons[f.i], c.polygons[f.j]) / polygonArea(c.polygons[f.i]);
            if (f.value == 0) {
                EXPECT_EQ(value, 0) << c.name;
            }
            EXPECT_NEAR(value, f.value, 1e-12) << c.name << " " << f.i << " " << f.j;
        }
}

TEST(ExactReference, elements_agree_with_closed_forms) {
    for (const auto& c : test::elementCases())
        EXPECT_NEAR(pointToPolygon(c.point, c.normal, c.polygon), c.value, 1e-14) << c.name;
}

TEST(ExactReference, occluded_pairs_agree_with_split_tensor_cubature) {
    for (const auto& c : test::formFactorCases("occluded")) {
        const geometry::PatchMesh mesh = test::meshOf(c.polygons);
        // Adaptive cubature across kinks: asked for 1e-6, its estimate is good to a factor of some tens.
        for (const auto& f : c.entries)
            EXPECT_NEAR(exchangeIn(mesh, f.i, f.j, 1e-6, 1000).value / polygonArea(c.polygons[f.i]), f.value,
                        5e-6)
                << c.name << " " << f.i << " " << f.j;
    }
}

TEST(ExactReference, enclosures_agree_and_close) {
    for (const auto& c : test::formFactorCases("enclosure")) {
        const size_t n = c.polygons.size();
        const std::vector<double> all = exactFormFactors(test::meshOf(c.polygons));
        for (const auto& f : c.entries) EXPECT_NEAR(all[f.i * n + f.j], f.value, 1e-12) << c.name;
        for (size_t i = 0; i < n; ++i) {
            double sum = 0;
            for (size_t j = 0; j < n; ++j) sum += all[i * n + j];
            EXPECT_NEAR(sum, 1, 1e-11) << c.name << " row " << i;
        }
    }
}

// Merged blockers give what single patches give: against exact visible polygons on nets of points, whose
// standard error is 7e-6 an entry, about 2e-5 a row of 672.
TEST(ExactReference, rows_of_a_room_with_partitions_agree_and_close) {
    const geometry::PatchMesh mesh =
        geometry::readPatches(HELIODON_TEST_DATA "/compute/formfactor/room3_672.obj");
    const size_t n = mesh.patchCount();
    const FormFactorRows rows(mesh);
    for (const size_t i : {0u, 203u, 609u}) {
        std::ifstream file(HELIODON_TEST_DATA "/formfactor/room3_672_rows.f32", std::ios::binary);
        file.seekg(static_cast<std::streamoff>(i / 7 * n * sizeof(float)));
        std::vector<float> expected(n);
        file.read(reinterpret_cast<char*>(expected.data()), static_cast<std::streamsize>(n * sizeof(float)));
        ASSERT_TRUE(file);
        const std::vector<double> row = rows.row(i, 1e-6).factors;
        double squares = 0, sum = 0;
        for (size_t j = 0; j < n; ++j) {
            squares += std::pow(row[j] - double{expected[j]}, 2);
            sum += row[j];
        }
        EXPECT_LT(std::sqrt(squares), 2e-5) << "row " << i;
        EXPECT_NEAR(sum, 1, 5e-5) << "row " << i;
    }
}

// The second slab of a pile hides the third from the first, though both its planes are those of their faces
// to within rounding: rows summed to two.
TEST(ExactReference, slabs_a_micrometre_apart_hide_one_another) {
    const geometry::PatchMesh mesh = test::pileOfSlabs(1e-6, 0.1, {0.37, 0.5, 0.21});
    const FormFactorRows rows(mesh);
    const size_t n = mesh.patchCount(), aSlab = 32;
    for (const auto& [first, side] : {std::pair(n - 3 * aSlab, -1.0), std::pair(n - aSlab, 1.0)}) {
        size_t i = first; // the uppermost slab comes first
        while (geometry::patchArea(mesh, i) < 0.05 || side * geometry::patchAreaVector(mesh, i).y < 0) ++i;
        const std::vector<double> row = rows.row(i, 1e-5, 100).factors;
        EXPECT_NEAR(std::accumulate(row.begin(), row.end(), 0.0), 1, 1e-3) << "row " << i;
    }
}

// Additivity: what is visible and what is in shadow make the whole. The blocker is seen as a light itself.
TEST(ExactReference, a_blocker_takes_away_what_it_shows) {
    const Polygon light{{-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}};
    const Polygon blocker{{-0.2, 1, -0.3}, {0.4, 1, -0.3}, {0.4, 1, 0.3}, {-0.2, 1, 0.3}};
    const glm::dvec3 point{0.1, 0, -0.05}, up{0, 1, 0};
    const double whole = pointToPolygon(point, up, light), hidden = pointToPolygon(point, up, blocker);
    ASSERT_GT(hidden, 0.05);
    EXPECT_NEAR(visiblePointToPolygon(point, up, light, std::vector<Polygon>{blocker}), whole - hidden,
                1e-14);
    // Two halves of a blocker hide what the whole hides, whatever their order and orientation.
    const Polygon left{{-0.2, 1, -0.3}, {0.1, 1, -0.3}, {0.1, 1, 0.3}, {-0.2, 1, 0.3}};
    const Polygon right{{0.4, 1, -0.3}, {0.1, 1, -0.3}, {0.1, 1, 0.3}, {0.4, 1, 0.3}};
    EXPECT_NEAR(visiblePointToPolygon(point, up, light, std::vector<Polygon>{right, left, blocker}),
                whole - hidden, 1e-14);
}

} // namespace
} // namespace heliodon::compute::reference
