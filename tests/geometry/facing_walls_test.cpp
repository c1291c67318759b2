// Houses side by side: windows in walls that touch, overlap or leave a crack between them see no sky. Walls
// laid in two layers are one wall: what is in one of them goes through both.
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "geometry/building.h"
#include "tests/geometry/drawn_pieces.h"
#include "tests/geometry/shuffled_closure.h"

using namespace heliodon::geometry;
using heliodon::test::wall;
using heliodon::test::window;

namespace {

// Two houses of 9 by 12 in, so much air between the walls w2 and w8; the right one so much farther up.
Sketch twoHouses(double gap, double up = 0, HeightClass right = HeightClass::red) {
    const double x = (gap + 0.375) / 2;
    Sketch s;
    s.walls = {wall("w1", {-9, -6}, {-x, -6}),
               wall("w2", {-x, -6}, {-x, 6}),
               wall("w3", {-x, 6}, {-9, 6}),
               wall("w4", {-9, 6}, {-9, -6}),
               wall("w5", {x, up - 6}, {9, up - 6}, right),
               wall("w6", {9, up - 6}, {9, up + 6}, right),
               wall("w7", {9, up + 6}, {x, up + 6}, right),
               wall("w8", {x, up - 6}, {x, up + 6}, right)};
    return s;
}

// Square inches of glass.
struct Glass {
    double outside = 0, between = 0;
};

Glass glassOf(const Closure& closure) {
    Glass out;
    for (const Face& face : closure.building->faces) {
        if (!closure.building->materials[face.material].isOpening()) continue;
        const auto& v = closure.building->vertices;
        const auto& loop = face.loops[0];
        glm::dvec3 twice(0);
        for (size_t i = 1; i + 1 < loop.size(); ++i)
            twice += glm::cross(v[loop[i]] - v[loop[0]], v[loop[i + 1]] - v[loop[0]]);
        (face.twin == kNoTwin ? out.outside : out.between) +=
            glm::length(twice) / 2 / (kMetresPerInch * kMetresPerInch);
    }
    return out;
}

void expectGlass(const Sketch& sketch, int windows, Glass expected) {
    const Closure closure = closeSketch(sketch);
    ASSERT_TRUE(closure.building) << closure.report.message;
    EXPECT_EQ(closure.report.rooms.size(), 2u);
    EXPECT_EQ(closure.report.windowCount, windows) << closure.report.message;
    const Glass glass = glassOf(closure);
    EXPECT_NEAR(glass.outside, expected.outside, 0.1);
    EXPECT_NEAR(glass.between, expected.between, 0.1);
}

void turn(Sketch& sketch, double degrees) {
    const double c = std::cos(degrees * std::numbers::pi / 180),
                 s = std::sin(degrees * std::numbers::pi / 180);
    for (Wall& w : sketch.walls)
        for (glm::dvec2* p : {&w.a, &w.b}) *p = {c * p->x - s * p->y, s * p->x + c * p->y};
}

} // namespace

TEST(FacingWalls, windows_opposite_one_another_join_the_rooms) {
    for (const double gap : {-0.075, 0.0, 0.125, 0.4, 0.9}) {
        SCOPED_TRACE(gap);
        Sketch s = twoHouses(gap);
        s.windows = {window("n1", "w2", 6, 3), window("n2", "w8", 6, 3)};
        for (int k = 0; k < 3; ++k, turn(s, 37)) {
            EXPECT_EQ(closeSketch(s).report.outcome, Outcome::ok) << closeSketch(s).report.message;
            expectGlass(s, 1, {0, 24});
            heliodon::test::expectSameInAnyOrder(s);
        }
        s.windows[1].pos = 7.5; // half of each
        EXPECT_EQ(closeSketch(s).report.code, "WINDOW_BEFORE_WALL");
        expectGlass(s, 1, {0, 12});
        s.windows[1].pos = 6.1; // by eye
        EXPECT_EQ(closeSketch(s).report.outcome, Outcome::ok);
        expectGlass(s, 1, {0, 23.2});
        s.windows[1].kind = WindowKind::picture;
        expectGlass(s, 1, {0, 23.2});
    }
    Sketch leaning = twoHouses(0.05); // the walls cross
    leaning.walls[7].a.x -= 0.1;
    leaning.walls[7].b.x += 0.1;
    leaning.windows = {window("n1", "w2", 6, 3), window("n2", "w8", 6, 3)};
    expectGlass(leaning, 1, {0, 24});
}

TEST(FacingWalls, a_window_before_a_blank_wall_is_walled_up_by_name) {
    for (const double gap : {-0.075, 0.0, 0.125, 0.9}) {
        SCOPED_TRACE(gap);
        Sketch s = twoHouses(gap);
        s.windows = {window("n1", "w2", 6, 3)};
        const ClosureReport report = closeSketch(s).report;
        EXPECT_EQ(report.code, "WINDOW_BEFORE_WALL");
        EXPECT_NE(report.message.find("window n1 looks straight at the wall w8"), std::string::npos)
            << report.message;
        expectGlass(s, 0, {0, 0});
        s.windows.push_back(window("n2", "w8", 10, 3)); // not opposite
        expectGlass(s, 0, {0, 0});
        s.windows = {window("n1", "w4", 6, 3)}; // out
        EXPECT_EQ(closeSketch(s).report.outcome, Outcome::ok);
        expectGlass(s, 1, {12, 0});
    }
    Sketch beside = twoHouses(1.2); // air
    beside.windows = {window("n1", "w2", 6, 3), window("n2", "w8", 6, 3)};
    EXPECT_EQ(closeSketch(beside).report.outcome, Outcome::ok);
    expectGlass(beside, 2, {24, 0});
    Sketch pieces = twoHouses(0);
    pieces.walls[7].b.y = -0.6; // a crack
    pieces.walls.push_back(wall("w9", {0.1875, 0.6}, {0.1875, 6}));
    pieces.windows = {window("n1", "w2", 6, 6)};
    expectGlass(pieces, 0, {0, 0});
    pieces.walls[7].b.y = -1.5; // a hole: the right house sees w2
    pieces.walls[8].a.y = 1.5;
    expectGlass(pieces, 1, {0, 24});
}

TEST(FacingWalls, what_reaches_beyond_the_wall_before_it_looks_outside) {
    Sketch s = twoHouses(0, 6.1875); // the right house begins at y = 0
    s.windows = {window("n1", "w2", 6, 3)};
    const ClosureReport report = closeSketch(s).report;
    EXPECT_EQ(report.code, "WINDOW_BEFORE_WALL");
    EXPECT_NE(report.message.find("is walled up there"), std::string::npos) << report.message;
    expectGlass(s, 1, {6, 0});
    Sketch low = twoHouses(0, 0, HeightClass::blue);
    low.windows = {window("n1", "w2", 6, 3)};
    expectGlass(low, 0, {0, 0});
    low.windows[0].kind = WindowKind::transom; // over the roof
    EXPECT_EQ(closeSketch(low).report.outcome, Outcome::ok);
    expectGlass(low, 1, {3, 0});
}

namespace {

// A second layer before the left wall w4 of the left house, so much air between.
Sketch doubledWall(double gap) {
    Sketch s = twoHouses(1.2);
    s.walls.push_back(wall("w9", {-9.375 - gap, -6.2}, {-9.375 - gap, 6.2}));
    return s;
}

void expectLeftGlass(const Sketch& sketch, const std::string& code, int windows, double area) {
    EXPECT_EQ(closeSketch(sketch).report.code, code) << closeSketch(sketch).report.message;
    expectGlass(sketch, windows, {area, 0});
}

} // namespace

TEST(DoubledWall, a_window_in_one_layer_or_both_goes_through_both) {
    for (const double gap : {-0.075, 0.0, 0.125, 0.4, 0.9}) {
        SCOPED_TRACE(gap);
        Sketch s = doubledWall(gap);
        for (int k = 0; k < 3; ++k, turn(s, 37)) {
            s.windows = {window("n1", "w4", 6, 3)};
            expectLeftGlass(s, "OK", 1, 12);
            s.windows = {window("n2", "w9", 6.2, 3)};
            expectLeftGlass(s, "OK", 1, 12);
            s.windows = {window("n1", "w4", 6, 3), window("n2", "w9", 6.2, 3)};
            expectLeftGlass(s, "OK", 1, 12);
            heliodon::test::expectSameInAnyOrder(s);
        }
        s.windows[1].pos = 6.3; // by eye
        expectLeftGlass(s, "OK", 1, 11.6);
        s.windows[1].pos = 7.7; // half of each
        expectLeftGlass(s, "WINDOW_BEFORE_WALL", 1, 6);
        s.windows[1].pos = 10.2; // another one
        expectLeftGlass(s, "OK", 2, 24);
        s = doubledWall(gap);
        s.walls.push_back(wall("w10", {-9.75 - 2 * gap, -6.2}, {-9.75 - 2 * gap, 6.2})); // a third layer
        s.windows = {window("n1", "w4", 6, 3)};
        expectLeftGlass(s, "OK", 1, 12);
    }
    Sketch pieces = doubledWall(0);
    pieces.walls.back().b.y = -0.3;
    pieces.walls.push_back(wall("w10", {-9.375, 0.3}, {-9.375, 6.2}));
    pieces.windows = {window("n1", "w4", 6, 3)};
    expectLeftGlass(pieces, "OK", 1, 12);
}

TEST(DoubledWall, what_is_no_layer_is_told) {
    Sketch s = doubledWall(0);
    s.windows = {window("n1", "w4", 6, 3)};
    s.walls.back().b.y = 0; // ends before the window's middle
    expectLeftGlass(s, "WINDOW_BEFORE_WALL", 1, 6);
    s = doubledWall(1.2); // air
    s.windows = {window("n2", "w9", 6.2, 3)};
    expectLeftGlass(s, "WINDOW_OUTSIDE", 0, 0);
    Sketch slab = twoHouses(0.375); // between the houses
    slab.walls.push_back(wall("w9", {0, -6.2}, {0, 6.2}));
    for (const char* on : {"w2", "w8"}) {
        slab.windows = {window("n1", on, 6, 3)};
        expectLeftGlass(slab, "WINDOW_BEFORE_WALL", 0, 0);
    }
    slab.windows = {window("n1", "w9", 6.2, 3)};
    expectLeftGlass(slab, "WINDOW_OUTSIDE", 0, 0);
}

namespace {

// A house of 18 by 12 in and a wall at so many degrees to its south wall, from so far within the house to so
// far outside.
Sketch leaningWall(double degrees, double within, double outside) {
    const double a = degrees * std::numbers::pi / 180;
    const glm::dvec2 foot(0, -6), d(std::cos(a), -std::sin(a));
    Sketch s;
    s.walls = {wall("s", {-9, -6}, {9, -6}), wall("e", {9, -6}, {9, 6}), wall("n", {9, 6}, {-9, 6}),
               wall("w", {-9, 6}, {-9, -6}), wall("g", foot - within * d, foot + outside * d)};
    return s;
}

} // namespace

// What of the window lies behind the wall, and no more than 0.45 in from it, has no light.
TEST(FacingWalls, a_window_is_walled_up_as_far_as_a_slanted_wall_stands_before_it) {
    for (const double within : {0.0, 4.0})
        for (const double degrees : {5.0, 8.0, 10.0}) {
            SCOPED_TRACE(testing::Message() << within << ' ' << degrees);
            Sketch s = leaningWall(degrees, within, 7);
            s.windows = {window("q", "s", 13, 7)}; // from 0.5 in beyond the foot
            const double slope = std::tan(degrees * std::numbers::pi / 180),
                         dark = std::min(7.0, (0.45 + 0.375) / slope); // from the foot
            const Closure closure = closeSketch(s);
            EXPECT_EQ(closure.report.code, "WINDOW_BEFORE_WALL") << closure.report.message;
            EXPECT_NEAR(glassOf(closure).outside, 4 * (7.5 - dark), 0.3);
            s.windows = {window("q", "g", within + 4, 2)}; // outside
            EXPECT_EQ(closeSketch(s).report.code, "WINDOW_OUTSIDE");
        }
}

// Two walls part two rooms and cross: where they do, and beside that, they are one wall.
TEST(FacingWalls, a_window_in_one_of_two_walls_that_cross_does_not_open_into_the_other) {
    for (const double degrees : {2.0, 3.0, 5.0, 8.0, 10.0})
        for (const double pos : {7.5, 9.0, 10.5}) {
            SCOPED_TRACE(testing::Message() << degrees << ' ' << pos);
            const double up = 9 * std::tan(degrees * std::numbers::pi / 180);
            Sketch s = leaningWall(90, 0, 0.01);
            s.walls.pop_back();
            s.walls.push_back(wall("a", {-9, 0}, {9, 0}));
            s.walls.push_back(wall("b", {-9, up}, {9, -up}));
            s.windows = {window("q", "a", pos, 2.5)};
            EXPECT_EQ(closeSketch(s).report.code, "WINDOW_BEFORE_WALL");
            expectGlass(s, 0, {0, 0});
        }
}

TEST(FacingWalls, walls_that_go_on_at_a_small_angle_leave_windows_at_their_corner_whole) {
    for (const int sides : {24, 36, 40, 60}) {
        Sketch s;
        const auto corner = [&](int k) {
            const double a = 2 * std::numbers::pi * k / sides;
            return 18.0 * glm::dvec2(std::cos(a), std::sin(a));
        };
        for (int k = 0; k < sides; ++k) {
            s.walls.push_back(wall("w" + std::to_string(k), corner(k), corner(k + 1)));
            const double length = glm::length(corner(1) - corner(0));
            s.windows.push_back(window("n" + std::to_string(k), s.walls.back().id, length / 2, length));
        }
        const ClosureReport report = closeSketch(s).report;
        EXPECT_EQ(report.code, "OK") << report.message;
        EXPECT_EQ(report.windowCount, sides);
    }
}
