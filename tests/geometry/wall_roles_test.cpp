// Roles of walls whose drawn faces are covered, by the filling of a corner or by a copy off their line, and
// of short ones.
#include <algorithm>
#include <utility>

#include <gtest/gtest.h>

#include "geometry/building.h"
#include "tests/geometry/drawn_pieces.h"

using namespace heliodon::geometry;
using heliodon::test::turned;
using heliodon::test::wall;
using heliodon::test::window;

namespace {

std::string roleOf(const ClosureReport& report, const std::string& id) {
    return std::ranges::find(report.walls, id, &WallRole::id)->role;
}

} // namespace

// 0.01 in off the line of its neighbour: the filling between them lies that far before its face.
TEST(WallRoles, a_corner_piece_behind_a_filling_is_a_wall_of_its_room) {
    Sketch s;
    s.walls = {wall("m", {-6.9, -6}, {8.19, -6}), wall("c", {-8.56, -6.01}, {-7.19, -6.01}),
               wall("e", {8, -6.19}, {8, 6.19}), wall("n", {8.19, 6}, {-8.19, 6}),
               wall("w", {-8, 6.19}, {-8, -5.95})};
    s.windows = {window("q", "c", 0.75, 0.4)};
    const ClosureReport report = closeSketch(s).report;
    EXPECT_EQ(report.windowCount, 1);
    EXPECT_EQ(roleOf(report, "c"), "exterior") << report.message;
    EXPECT_EQ(report.message, "1 room");
}

// The copy is turned a little, and hides the face towards one side.
TEST(WallRoles, a_doubled_stub_within_a_room_is_an_interior_wall) {
    Sketch s;
    s.walls = {wall("s", {-9.5, -12}, {9.5, -12}),    wall("e", {9.5, -12}, {9.5, 4}),
               wall("n", {9.5, 4}, {-9.5, 4}),        wall("w", {-9.5, 4}, {-9.5, -12}),
               wall("a", {4.2, -5.4}, {-9.5, -5}),    wall("stub", {6.9, -5.3}, {9.6, -5.5}),
               wall("copy", {7.5, -5.4}, {9.3, -5.6})};
    const ClosureReport report = closeSketch(s).report;
    ASSERT_EQ(report.rooms.size(), 1u);
    for (const char* id : {"a", "stub", "copy"}) EXPECT_EQ(roleOf(report, id), "interior") << id;
    for (const char* id : {"s", "e", "n", "w"}) EXPECT_EQ(roleOf(report, id), "exterior") << id;
}

// It runs through the wall that it holds by little, and that end is no wall of the room.
TEST(WallRoles, a_buttress_whose_end_stands_in_the_room_is_outside) {
    for (const double end : {0.0, 0.19, 0.3, 0.5, 0.58}) {
        Sketch s;
        s.walls = {wall("s", {-8.1875, -6}, {8.1875, -6}), wall("e", {8, -6.1875}, {8, 6.1875}),
                   wall("n", {8.1875, 6}, {-8.1875, 6}), wall("w", {-8, 6.1875}, {-8, -6.1875}),
                   wall("buttress", {2, -6 + end}, {2, -8})};
        const ClosureReport report = closeSketch(s).report;
        EXPECT_NEAR(report.rooms[0].floorAreaFt2, 15.625 * 11.625, 1e-6) << end;
        EXPECT_EQ(roleOf(report, "buttress"), "outside_extra") << end;
        EXPECT_EQ(roleOf(report, "s"), "exterior") << end;
    }
}

// Lengths along which rooms see them are about as long as what does not count.
TEST(WallRoles, of_short_slanted_walls_do_not_turn_with_the_sketch) {
    for (const double slant : {15.0, 20.0, 45.0, 60.0, 80.0, 135.0})
        for (const double length : {0.3, 0.4, 0.5, 0.6, 0.8, 1.0})
            for (const glm::dvec2 foot : {glm::dvec2(-2, -6), glm::dvec2(3, -5.9), glm::dvec2(8, 6)}) {
                Sketch s;
                s.walls = {wall("s", {-8.1875, -6}, {8.1875, -6}), wall("e", {8, -6.1875}, {8, 6.1875}),
                           wall("n", {8.1875, 6}, {-8.1875, 6}), wall("w", {-8, 6.1875}, {-8, -6.1875}),
                           wall("stub", foot, foot + turned({length, 0}, slant))};
                const std::string drawn = roleOf(closeSketch(s).report, "stub");
                for (const double degrees : {17.0, 45.0, 90.0, 133.0, 211.0}) {
                    SCOPED_TRACE(testing::Message()
                                 << slant << ' ' << length << ' ' << foot.x << ' ' << degrees);
                    EXPECT_EQ(roleOf(closeSketch(turned(s, degrees)).report, "stub"), drawn);
                    for (Wall& w : s.walls) std::swap(w.a, w.b);
                }
            }
}
