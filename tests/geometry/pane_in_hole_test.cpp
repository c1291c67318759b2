// Holes whose sides are drawn in pieces that meet but for rounding.
#include "geometry/pane_in_hole.h"

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "geometry/outline_area.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kTolerance = 2e-5;
constexpr uint32_t kGlass = 1;

// A hole of 2 by 1.2 m through a wall at |z| < 0.1. Each of its sides is in three pieces along it, each moved
// by up to `off` in the wall's plane.
std::vector<SoupFace> hole(double off, std::mt19937& random) {
    const std::array<dvec3, 4> corner{dvec3(0, 0, 0), dvec3(2, 0, 0), dvec3(2, 1.2, 0), dvec3(0, 1.2, 0)};
    const auto shift = [&] { return off * (2 * static_cast<double>(random()) / 4294967296.0 - 1); };
    const dvec3 deep(0, 0, 0.1);
    std::vector<SoupFace> out;
    for (size_t k = 0; k < 4; ++k)
        for (int part = 0; part < 3; ++part) {
            const dvec3 way = (corner[(k + 1) % 4] - corner[k]) / 3.0, moved(shift(), shift(), 0),
                        a = corner[k] + static_cast<double>(part) * way + moved, b = a + way;
            out.push_back({.loops = {{a - deep, b - deep, b + deep, a + deep}}});
        }
    return out;
}

} // namespace

TEST(PaneInHole, of_sides_in_pieces_that_pass_one_another_by) {
    std::mt19937 random(1);
    for (const double off : {0.0, 1e-12, 1e-9, 1e-7, 5e-6})
        for (int k = 0; k < 50; ++k) {
            std::vector<SoupFace> soup = hole(off, random);
            const auto pane = static_cast<uint32_t>(soup.size());
            soup.push_back(
                {.loops = {{{0.003, 0.003, 0}, {1.997, 0.003, 0}, {1.997, 1.197, 0}, {0.003, 1.197, 0}}},
                 .material = kGlass});
            const PaneFitter fitter(
                soup, [](uint32_t material) { return material == kGlass; }, kTolerance);
            double area = 0;
            for (const SoupFace& face : fitter.fit(std::array{pane}, dvec3(0)))
                area += 0.5 * glm::length(areaVector(face.loops[0]));
            EXPECT_NEAR(area, 2.4, 1e-4) << off << " " << k;
        }
}

} // namespace heliodon::geometry
