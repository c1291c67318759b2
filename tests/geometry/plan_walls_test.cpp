#include "geometry/plan_walls.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

using namespace heliodon::geometry;

// Whatever is told of an edge without dividing: a ray through its very end meets it, one a hair beside does
// not.
TEST(PlanWalls, rays_meet_solids_up_to_their_corners) {
    PlanSolid wedge;
    wedge.outline = {{5, 2}, {9, -1}, {9, 3}}; // its corner at (5, 2) ahead
    const std::vector<PlanSolid> solids{wedge};
    for (const double height : {2.0, -1.0, 3.0, 2.5})
        EXPECT_TRUE(std::isfinite(firstHit(solids, {0, height}, {1, 0}, -1))) << height;
    for (const double height : {-1 - 1e-6, 3 + 1e-6})
        EXPECT_TRUE(std::isinf(firstHit(solids, {0, height}, {1, 0}, -1))) << height;
    EXPECT_NEAR(firstHit(solids, {0, 2}, {1, 0}, -1), 5, 1e-8);
    EXPECT_NEAR(firstHit(solids, {0, 2.5}, {1, 0}, -1), 7, 1e-12);
    EXPECT_NEAR(firstHit(solids, {20, 0}, {-1, 0}, -1), 11, 1e-12);
    EXPECT_TRUE(std::isinf(firstHit(solids, {20, 0}, {1, 0}, -1)));
}
