#include "geometry/fold_leaning.h"

#include <cmath>

#include <gtest/gtest.h>

using namespace heliodon::geometry;

namespace {

// Upright, along the line in the plan, in one face each from place to place.
void addWall(Building& building, uint32_t surface, const std::vector<glm::dvec2>& line, double low,
             double high) {
    const auto first = static_cast<uint32_t>(building.vertices.size());
    for (uint32_t k = 0; k < line.size(); ++k) {
        building.vertices.emplace_back(line[k].x, low, line[k].y);
        building.vertices.emplace_back(line[k].x, high, line[k].y);
        if (k == 0) continue;
        const uint32_t v = first + 2 * k;
        Face face;
        face.loops = {{v - 2, v, v + 1, v - 1}};
        face.surface = surface;
        building.faces.push_back(face);
    }
}

// A band, 0.1 to 0.2 m up, of a wall that is curved by 2 m, with one from `low` to `high` close before it.
bool leans(double low, double high) {
    Building building;
    building.roomCount = 1;
    constexpr int kFacets = 12;
    constexpr double kFacet = 0.01, kRadius = 2;
    std::vector<glm::dvec2> band;
    for (int k = 0; k <= kFacets; ++k) {
        const double angle = (k - kFacets / 2) * kFacet / kRadius;
        band.emplace_back(kRadius * std::sin(angle), kRadius * (1 - std::cos(angle)));
    }
    addWall(building, 0, band, 0.1, 0.2);
    addWall(building, 1, {{-1, -0.0001}, {1, -0.0001}}, low, high);
    const std::vector<MeshDomain> domains = findMeshDomains(building, 0.03);
    EXPECT_EQ(domains.size(), 2u);
    const FoldLeaning leaning(building, domains);
    for (size_t d = 0; d < domains.size(); ++d)
        if (!domains[d].folds.empty()) return leaning.mayLean(d, 0.03);
    ADD_FAILURE() << "no folds";
    return false;
}

} // namespace

TEST(FoldLeaning, walls_that_begin_lower_and_end_higher_are_in_the_way) {
    EXPECT_TRUE(leans(0.2, 0.3)); // above the band
    EXPECT_TRUE(leans(0, 0.1));   // below
    EXPECT_FALSE(leans(0.1, 0.2));
    EXPECT_FALSE(leans(0.1, 0.3));
    EXPECT_FALSE(leans(0, 0.2));
    EXPECT_FALSE(leans(0, 0.3));
    EXPECT_FALSE(leans(0.13, 0.16));
}
