// What the report says of holes, skylights and what encloses nothing, and of ceilings that are as good as
// even.
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "geometry/building.h"
#include "tests/geometry/drawn_pieces.h"

using namespace heliodon::geometry;
using heliodon::test::turned;
using heliodon::test::wall;

namespace {

// A square with a hole in the middle of its lower side.
ClosureReport withHole(double width, double degrees = 0) {
    Sketch s;
    s.walls = {wall("w1", {-9, -6}, {-width / 2, -6}), wall("w2", {width / 2, -6}, {9, -6}),
               wall("w3", {9, -6}, {9, 6}), wall("w4", {9, 6}, {-9, 6}), wall("w5", {-9, 6}, {-9, -6})};
    return closeSketch(turned(s, degrees)).report;
}

Sketch square(double width, double height) {
    Sketch s;
    s.walls = {wall("s", {0, 0}, {width, 0}, HeightClass::red),
               wall("n", {0, height}, {width, height}, HeightClass::red),
               wall("w", {0, 0}, {0, height}, HeightClass::blue),
               wall("e", {width, 0}, {width, height}, HeightClass::blue)};
    return s;
}

} // namespace

TEST(ClosureWords, a_closed_hole_of_a_doors_size_is_named) {
    for (const double width : {2.0, 8.0}) {
        const ClosureReport report = withHole(width);
        EXPECT_EQ(report.code, "OK");
        EXPECT_NE(report.message.find(width == 2 ? "an opening 2.0 ft wide beside w1, w2 was closed"
                                                 : "an opening 8.0 ft wide beside w1, w2 was closed"),
                  std::string::npos)
            << report.message;
    }
    for (const double degrees : {17.0, 33.0, 137.0, 211.0})
        EXPECT_EQ(withHole(8, degrees).code, "OK") << degrees;
    EXPECT_EQ(withHole(1.8).message.find("opening"), std::string::npos);
    EXPECT_EQ(withHole(8.7).code, "WIDE_OPENING");
}

// Behind a hole in the lower side of a hall: a lobby by what it sees of that side, or a recess.
TEST(ClosureWords, what_is_nearly_a_lobby_is_named) {
    for (const double width : {2.3, 2.0, 3.0}) {
        SCOPED_TRACE(width);
        Sketch s;
        s.walls = {wall("f1", {-10, -7}, {-width / 2, -7}),
                   wall("f2", {width / 2, -7}, {10, -7}),
                   wall("e", {10, -7}, {10, 7}),
                   wall("n", {10, 7}, {-10, 7}),
                   wall("w", {-10, 7}, {-10, -7}),
                   wall("l1", {-1.6, -7}, {-1.6, -3}),
                   wall("l2", {1.6, -7}, {1.6, -3}),
                   wall("l3", {-1.6, -3}, {1.6, -3})};
        for (const double degrees : {0.0, 33.0}) {
            const ClosureReport report = closeSketch(turned(s, degrees)).report;
            EXPECT_EQ(report.code, "OK");
            EXPECT_EQ(report.rooms.size(), width == 2 ? 2u : 1u);
            EXPECT_EQ(report.message.find("; the space between l1, l2, l3, open by 2.3 ft, is outside") !=
                          std::string::npos,
                      width == 2.3)
                << report.message;
        }
    }
}

TEST(ClosureWords, a_skylight_of_no_size_is_too_small) {
    Sketch s = square(12, 10);
    s.skylights.emplace_back();
    s.skylights[0].id = "s1";
    s.skylights[0].center = {6, 5};
    s.skylights[0].size = {1e-9, 1e-9};
    ClosureReport report = closeSketch(s).report;
    EXPECT_EQ(report.code, "SKYLIGHT_TOO_SMALL");
    EXPECT_NE(report.message.find("skylight s1 is too small"), std::string::npos) << report.message;
    s.skylights[0].center = {-6, 5};
    EXPECT_EQ(closeSketch(s).report.code, "SKYLIGHT_OUTSIDE");
}

// Whose middle lies on the edge between the two that cover it; and of one within another one the small one,
// wherever their middles lie.
TEST(ClosureWords, a_skylight_under_others_is_covered) {
    const auto skylight = [](const std::string& id, glm::dvec2 center, glm::dvec2 size) {
        Skylight out;
        out.id = id;
        out.center = center;
        out.size = size;
        return out;
    };
    Sketch s = square(12, 10);
    s.skylights = {skylight("a", {4, 5}, {4, 4}), skylight("b", {8, 5}, {4, 4}),
                   skylight("c", {6, 5}, {2, 2})};
    EXPECT_EQ(closeSketch(s).report.message, "1 room; skylight c lies under others and adds nothing");
    for (const double x : {3.0, 5.0}) {
        s.skylights = {skylight("big", {4, 5}, {4, 4}), skylight("small", {x, 5}, {1, 1})};
        const ClosureReport report = closeSketch(s).report;
        EXPECT_EQ(report.message, "1 room; skylight small lies under others and adds nothing");
        EXPECT_EQ(report.skylightPaneCount, 1);
    }
}

TEST(ClosureWords, a_window_that_is_left_out_is_not_said_to_be_cut) {
    Sketch s = square(12, 10);
    s.walls[0].b = {60, 0};
    s.windows = {heliodon::test::window("w1", "s", 30, 5)};
    EXPECT_EQ(closeSketch(s).report.message, "1 room; wall s reaches beyond the table; window w1 is where "
                                             "its wall encloses nothing and is ignored");
}

TEST(ClosureWords, of_classes_with_as_much_wall_the_higher_one_has_the_ceiling) {
    for (const double more : {0.0, 0.0005, -0.0005}) {
        const ClosureReport report = closeSketch(square(12, 12 + more)).report;
        ASSERT_EQ(report.rooms.size(), 1u);
        EXPECT_EQ(report.rooms[0].ceilingFt, 10);
    }
    EXPECT_EQ(closeSketch(square(12, 12.1)).report.rooms[0].ceilingFt, 8);
}

TEST(ClosureWords, a_refusal_names_the_opening_and_not_all_walls) {
    Sketch ell; // three sides of a room, and a wall elsewhere
    ell.walls = {wall("a", {-6, -9}, {-6, 9}), wall("b", {-6, -9}, {6, -9}), wall("c", {6, -9}, {6, -5}),
                 wall("far", {15, -3}, {15, 3})};
    const ClosureReport report = closeSketch(ell).report;
    EXPECT_EQ(report.code, "NOT_ENCLOSED");
    EXPECT_NE(report.message.find(" ft wide beside a, c"), std::string::npos) << report.message;
    EXPECT_EQ(report.message.find("far"), std::string::npos) << report.message;

    Sketch many; // one beside another
    for (int k = 0; k < 30; ++k)
        many.walls.push_back(wall("m" + std::to_string(10 + k), {-15, k - 15}, {-14.5, k - 15}));
    EXPECT_EQ(closeSketch(many).report.message,
              "the walls enclose no space: m10, m11, m12, m13, m14, m15, m16, m17 and 22 others");
}

// Most of the box's walls lie ahead of ends of others.
TEST(ClosureWords, a_closed_box_is_a_room_whatever_stands_in_it) {
    Sketch s;
    s.walls = {wall("S", {-10.1, -8}, {10.1, -8}), wall("E", {10, -8.1}, {10, 8.1}),
               wall("N", {10.1, 8}, {-10.1, 8}), wall("W", {-10, 8.1}, {-10, -8.1})};
    for (int k = 0; k < 44; ++k)
        s.walls.push_back(
            wall("g" + std::to_string(k), turned({-3, 0}, 180.0 * k / 44), turned({3, 0}, 180.0 * k / 44)));
    const ClosureReport report = closeSketch(s).report;
    ASSERT_EQ(report.rooms.size(), 1u) << report.message;
    EXPECT_EQ(report.rooms[0].euler, 0);
    EXPECT_NEAR(report.rooms[0].floorAreaFt2, 19.625 * 15.625 - std::numbers::pi * 9, 2);
}
