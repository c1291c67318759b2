// A wall laid twice that stops within a crack of the one before it: neither copy stands against a wall.
#include <gtest/gtest.h>

#include "geometry/building.h"
#include "tests/geometry/drawn_pieces.h"
#include "tests/geometry/shuffled_closure.h"

using namespace heliodon::geometry;
using heliodon::test::wall;

TEST(DoubledStub, closes_the_crack_before_it) {
    Sketch s;
    s.walls = {wall("s", {-8, -5}, {8, -5}), wall("n", {-8, 5}, {8, 5}), wall("w", {-8, -5}, {-8, 5}),
               wall("e", {8, -5}, {8, 5})};
    s.walls.push_back(wall("stub", {0, -5}, {0, 4.38})); // 0.43 in before the face of n
    EXPECT_EQ(closeSketch(s).report.rooms.size(), 2u);
    for (const double end : {4.37, 4.383, 4.385, 4.387, 4.4}) {
        s.walls.resize(5);
        s.walls.push_back(wall("copy", {0.35, 1.9}, {0.1, end}));
        EXPECT_EQ(closeSketch(s).report.rooms.size(), 2u) << end;
        heliodon::test::expectSameInAnyOrder(s);
    }
    s.walls[4].b.y = 2.5, s.walls.resize(5);
    EXPECT_EQ(closeSketch(s).report.rooms.size(), 1u);
}
