// Crowds of partitions and skylights.
#include <ctime>

#include <gtest/gtest.h>

#include "geometry/building.h"
#include "geometry/plan_overlay.h"
#include "tests/geometry/drawn_pieces.h"

using namespace heliodon::geometry;
using heliodon::test::turned;
using heliodon::test::wall;

namespace {

// `count` turned skylights over a room, each across those beside it.
Sketch underSkylights(int count) {
    Sketch s;
    s.walls = {wall("s", {-8, -6}, {8, -6}), wall("e", {8, -6}, {8, 6}), wall("n", {8, 6}, {-8, 6}),
               wall("w", {-8, 6}, {-8, -6})};
    for (int i = 0; i < count; ++i) {
        Skylight sky;
        sky.id = "sky" + std::to_string(i);
        sky.center = {-7 + 0.2 * (i % 70), -5 + 0.2 * (i / 70)};
        sky.size = {0.3, 0.3};
        sky.angleDeg = i;
        s.skylights.push_back(sky);
    }
    return s;
}

} // namespace

TEST(PlanOverlay, a_triangle_of_the_snapping_distance_does_not_multiply_its_edges) {
    RoomPlan room;
    room.loops = {{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, std::vector<OutlineEdge>(4)}};
    const std::vector<glm::dvec2> triangle{{0, 0}, {0.0055, 0}, {0.00275, 0.0044}};
    const PlanOverlay over = overlay({room}, {triangle}, Touching::joined);
    EXPECT_EQ(over.map.edgeCount(), 6u); // over the longest side lies the third corner
    size_t tags = 0;
    for (const auto& edge : over.map.tags) tags += edge.size();
    EXPECT_LE(tags, 8u);
}

TEST(PlanOverlay, a_thousand_skylights_take_a_second_and_more_are_refused) {
    const std::clock_t start = std::clock();
    const ClosureReport report = closeSketch(underSkylights(1000)).report;
    EXPECT_EQ(report.code, "OK") << report.message;
    EXPECT_EQ(report.skylightPaneCount, 1);
    EXPECT_LT(double(std::clock() - start) / CLOCKS_PER_SEC, 3); // under sanitizers, too
    const ClosureReport refused = closeSketch(underSkylights(1001)).report;
    EXPECT_EQ(refused.code, "TOO_MANY_SKYLIGHTS");
    EXPECT_EQ(refused.message, "the sketch has 1001 skylights, at most 1000 are taken");
}

// On its very face, which rounding puts on either side of the end.
TEST(PlanOverlay, a_partition_that_ends_at_a_thin_wall_does_not_reach_through_it) {
    Sketch s = underSkylights(0);
    s.walls.push_back(wall("thin", {0, -6}, {0, 2}));
    s.walls.back().thickness = 0.25;
    const double without = closeSketch(s).report.rooms[0].floorAreaFt2;
    s.walls.push_back(wall("low", {0.125, -1}, {4, -1}, HeightClass::green));
    for (double degrees = 0; degrees < 360; degrees += 7.3)
        EXPECT_NEAR(closeSketch(turned(s, degrees)).report.rooms[0].floorAreaFt2, without - 3.875 * 0.375,
                    1e-6)
            << degrees;
}
