#include "geometry/planar_mesher.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "geometry/angle_optimiser.h"
#include "geometry/even_areas.h"

using namespace heliodon::geometry;

namespace {

PlanarDomain rectangle(double width, double height, int across, int up) {
    PlanarDomain domain;
    for (int k = 0; k < across; ++k) domain.boundary.emplace_back(k * width / across, 0);
    for (int k = 0; k < up; ++k) domain.boundary.emplace_back(width, k * height / up);
    for (int k = across; k > 0; --k) domain.boundary.emplace_back(k * width / across, height);
    for (int k = up; k > 0; --k) domain.boundary.emplace_back(0, k * height / up);
    domain.loopStart.push_back(static_cast<uint32_t>(domain.boundary.size()));
    domain.size = SizeField({}, width / across, 1);
    return domain;
}

// Each edge once with its opposite, but for those of the boundary; all triangles the right way round.
void expectSound(const PlanarNet& net, double area) {
    double sum = 0;
    for (uint32_t t = 0; t < net.corner.size(); ++t) {
        EXPECT_GT(net.twiceArea(t), 0);
        sum += net.twiceArea(t) / 2;
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t other = net.neighbour[t][k];
            if (other == kNoTriangle) {
                EXPECT_TRUE(net.fixed[t][k]);
                continue;
            }
            ASSERT_LT(other, net.corner.size());
            const size_t m = static_cast<size_t>(std::ranges::find(net.neighbour[other], t) -
                                                 net.neighbour[other].begin());
            ASSERT_LT(m, 3u);
            EXPECT_EQ(net.corner[other][(m + 1) % 3], net.corner[t][(k + 2) % 3]);
            EXPECT_EQ(net.corner[other][(m + 2) % 3], net.corner[t][(k + 1) % 3]);
        }
    }
    EXPECT_NEAR(sum, area, 1e-12 * area);
}

} // namespace

// Steps of the sides as high as rows of the lattice: whether a row is inside must not hang on a rounding.
TEST(PlanarMesher, rows_through_points_of_the_sides_have_seeds) {
    for (const int rows : {4, 5, 6, 7, 12}) {
        // From 0.2032 m up, as in a wall of two heights: sums of such numbers are not exact.
        PlanarDomain domain = rectangle(0.370437, 0.0127 * rows, 27, rows);
        for (glm::dvec2& p : domain.boundary) p.y += 0.2032;
        const size_t seeds = latticeSeeds(domain, 0.0127 / 0.94).points.size();
        EXPECT_GE(seeds, 26u * static_cast<size_t>(rows - 1)) << rows;
    }
}

// Two points crowd the middle; and the mesh stays sound.
TEST(PlanarMesher, small_angles_grow_within_the_points_allowed) {
    const PlanarDomain domain = rectangle(12, 12, 12, 12);
    LatticeSeeds seeds = latticeSeeds(domain, 1);
    const glm::dvec2 middle = *std::ranges::min_element(
        seeds.points, {}, [](glm::dvec2 p) { return glm::length(p - glm::dvec2(6, 6)); });
    seeds.points.push_back(middle + glm::dvec2(0.1, 0.3));
    seeds.points.push_back(middle + glm::dvec2(-0.2, 0.2));
    const PlanarNet draft = *draftMesh(domain, seeds);
    const auto smallest = [](const PlanarNet& net) {
        double worst = 0;
        for (uint32_t t = 0; t < net.corner.size(); ++t) worst = std::max(worst, net.worstCosine(t));
        return std::acos(worst) * 180 / std::numbers::pi;
    };
    EXPECT_LT(smallest(draft), 30);
    for (const size_t most : {size_t{0}, size_t{10}}) {
        PlanarNet net = draft;
        const size_t added = raiseAngles(net, 1, most);
        EXPECT_LE(added, most);
        EXPECT_EQ(net.corner.size(), draft.corner.size() + 2 * added);
        EXPECT_GE(smallest(net), 36);
        expectSound(net, 144);
    }
}

// Every third point off the lattice, and two triangles with an angle of 45 degrees in each corner.
TEST(PlanarMesher, areas_become_even_while_angles_stay) {
    const PlanarDomain domain = rectangle(12, 12, 12, 12);
    PlanarNet net = *draftMesh(domain, latticeSeeds(domain, 1));
    for (uint32_t v = net.boundaryCount; v < net.points.size(); v += 3)
        net.points[v] += glm::dvec2(0.12, v % 2 == 0 ? 0.12 : -0.12);
    net.flipAll();
    raiseAngles(net, 1, 0);
    const auto deviation = [&] {
        double squares = 0;
        for (uint32_t t = 0; t < net.corner.size(); ++t) squares += net.twiceArea(t) * net.twiceArea(t);
        return std::sqrt(squares * static_cast<double>(net.corner.size()) / (288.0 * 288.0) - 1);
    };
    const double before = deviation();
    const PlanarNet uneven = net;
    evenAreas(net, false);
    expectSound(net, 144);
    EXPECT_EQ(net.corner, uneven.corner);
    EXPECT_LT(deviation(), 0.6 * before) << before;
    for (uint32_t t = 0; t < net.corner.size(); ++t)
        EXPECT_LE(net.worstCosine(t),
                  std::max(uneven.worstCosine(t), std::cos(37 * std::numbers::pi / 180)) + 1e-12);
    PlanarNet held = uneven;
    evenAreas(held, true); // no point is on a fold
    EXPECT_EQ(held.points, uneven.points);
}

// An unrolled wall 6 high, its left end in seven steps and its right one in six, with facets as wide as
// edges, narrow ones, and one with room for points within; and a partition that ends in it beside a fold.
TEST(PlanarMesher, triangles_lie_within_the_folds_of_a_wall) {
    for (const double notch : {0.0, 0.03}) {
        PlanarDomain domain;
        domain.size = SizeField({}, 1, 1);
        domain.folds = {1, 2, 2.5, 3, 3.5, 4, 6.4, 7.3};
        const std::vector<double> corners{0, 1, 2, 2.5, 3, 3.5, 4, 4.8, 5.6, 6.4, 7.3, 8.2};
        std::vector<glm::dvec2>& outline = domain.boundary;
        for (const double x : corners) {
            outline.emplace_back(x, 0);
            if (notch == 0 || x != 4) continue;
            for (int k = 0; k <= 3; ++k) outline.emplace_back(4 + notch, k);
            for (int k = 3; k >= 0; --k) outline.emplace_back(4.4 + notch, k);
        }
        for (int k = 1; k < 6; ++k) outline.emplace_back(8.2, k);
        for (size_t k = corners.size(); k-- > 0;) outline.emplace_back(corners[k], 6);
        for (int k = 6; k > 0; --k) outline.emplace_back(0, 6 * k / 7.0);
        domain.loopStart.push_back(static_cast<uint32_t>(outline.size()));
        const PlanarMesh mesh = improvedMesh(*draftMesh(domain, latticeSeeds(domain, 1)), domain, 10);
        double area = 0;
        for (const auto& t : mesh.triangles) {
            const glm::dvec2 a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
            const auto [left, right] = std::minmax({a.x, b.x, c.x});
            for (const double fold : domain.folds)
                EXPECT_FALSE(left < fold - notch - 1e-12 && right > fold + notch + 1e-12) << fold;
            if (notch == 0) {
                EXPECT_LE(PlanarNet::worstCosine(a, b, c), std::cos(36 * std::numbers::pi / 180));
            }
            area += 0.5 * (b.x - a.x) * (c.y - a.y) - 0.5 * (b.y - a.y) * (c.x - a.x);
        }
        EXPECT_NEAR(area, 8.2 * 6 - (notch == 0 ? 0 : 3 * 0.4), 1e-12);
    }
}

// An odd number of narrow facets, whose folds go by turns, between ends that are level.
TEST(PlanarMesher, folds_go_by_turns_all_along_a_wall) {
    constexpr int kFacets = 21, kUp = 4;
    constexpr double kWidth = 0.687, kHeight = 4.75;
    PlanarDomain domain;
    domain.size = SizeField({}, 1, 1);
    for (int k = 0; k <= kFacets; ++k) domain.boundary.emplace_back(k * kWidth, 0);
    for (int k = 1; k < kUp; ++k) domain.boundary.emplace_back(kFacets * kWidth, kHeight * k / kUp);
    for (int k = kFacets; k >= 0; --k) domain.boundary.emplace_back(k * kWidth, kHeight);
    for (int k = kUp; --k > 0;) domain.boundary.emplace_back(0, kHeight * k / kUp);
    domain.loopStart.push_back(static_cast<uint32_t>(domain.boundary.size()));
    for (int k = 1; k < kFacets; ++k) domain.folds.push_back(k * kWidth);
    const PlanarMesh mesh = improvedMesh(*draftMesh(domain, latticeSeeds(domain, 1)), domain, 0);
    for (const auto& t : mesh.triangles)
        EXPECT_LE(PlanarNet::worstCosine(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]),
                  std::cos(35 * std::numbers::pi / 180));
}

// A slot ends in an angle of 20 degrees: what cannot be better does not make what is beside it worse.
TEST(PlanarMesher, triangles_at_sharp_corners_are_left_out_of_account) {
    PlanarDomain domain;
    const double slope = std::tan(20 * std::numbers::pi / 180);
    for (int k = 0; k < 12; ++k) domain.boundary.emplace_back(k, 0);
    for (int k = 0; k < 4; ++k) domain.boundary.emplace_back(12, k * 12 * slope / 4);
    for (int k = 12; k > 0; --k) domain.boundary.emplace_back(k, k * slope);
    domain.loopStart.push_back(static_cast<uint32_t>(domain.boundary.size()));
    domain.size = SizeField({}, 1, 1);
    PlanarNet net = *draftMesh(domain, latticeSeeds(domain, 1));
    EXPECT_EQ(std::ranges::count(net.kinds, PlanarNet::Kind::sharp), 2); // 20 and 70 degrees
    raiseAngles(net, 1, 10);
    expectSound(net, 72 * slope);
    for (uint32_t t = 0; t < net.corner.size(); ++t) {
        bool open = false; // off the wedge, which is narrower than half an edge there
        for (const uint32_t v : net.corner[t]) open = open || net.points[v].x > 4;
        if (!open || net.atSharpCorner(t)) continue;
        EXPECT_LE(net.worstCosine(t), std::cos(35 * std::numbers::pi / 180));
    }
}
