// What is left out of the rooms of a model is told: closed spaces too small for one, glass that bounds none.
#include "geometry/small_rooms.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "geometry/input_error.h"
#include "tests/geometry/sheet_drawing.h"

namespace heliodon::geometry {

namespace {

bool warns(const Building& building, const std::string& of) {
    return std::ranges::any_of(
        building.warnings, [&](const std::string& warning) { return warning.find(of) != std::string::npos; });
}

// Looks in; one side is glass.
void showcase(Drawing& drawing, dvec3 o, double size) {
    const auto sides = Drawing::sidesOf(o, dvec3(size));
    for (size_t k = 0; k < 6; ++k) {
        const auto [at, u, v] = sides[k];
        drawing.face(k == 5 ? "glass" : "wall", {at, at + u, at + u + v, at + v});
    }
}

// Of boxes, 4 by 2.5 by 5 m, with a pane in its front wall; the back may be open.
void house(Drawing& drawing, double left, bool isOpen) {
    const auto box = [&](dvec3 low, dvec3 high) { solid(drawing, low + dvec3(left, 0, 0), high - low); };
    const double t = 0.2;
    box({-t, -t, -t}, {4 + t, 0, 5 + t}), box({-t, 2.5, -t}, {4 + t, 2.5 + t, 5 + t});
    box({-t, 0, -t}, {0, 2.5, 5 + t}), box({4, 0, -t}, {4 + t, 2.5, 5 + t});
    if (!isOpen) box({0, 0, 5}, {4, 2.5, 5 + t});
    box({0, 0, -t}, {1, 2.5, 0}), box({3, 0, -t}, {4, 2.5, 0});
    box({1, 0, -t}, {3, 0.8, 0}), box({1, 2, -t}, {3, 2.5, 0});
    const dvec3 o(left + 1, 0.8, -0.1), x(2, 0, 0), y(0, 1.2, 0);
    drawing.face("glass", {o, o + x, o + x + y, o + y});
}

} // namespace

TEST(SmallRooms, a_showcase_beside_a_room_is_left_out_with_its_glass) {
    Drawing drawing(false);
    drawing.room(0, -1, true);
    showcase(drawing, {8, 0, 2}, 0.4);
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 1u);
    EXPECT_NEAR(volume(meshBuilding(building, {300})), 50, 1e-4);
    EXPECT_TRUE(warns(building, "1 closed space holds less than 0.1 m3"));
    EXPECT_TRUE(warns(building, "1 face of glass"));
}

// The back wall is missing: what lies between the panes is no room instead.
TEST(SmallRooms, a_house_of_which_only_double_glazing_is_closed_is_refused) {
    for (const bool isOpen : {false, true}) {
        Drawing drawing(false);
        house(drawing, 0, isOpen);
        const dvec3 o(1, 0.8, -0.12), x(2, 0, 0), y(0, 1.2, 0);
        drawing.face("glass", {o, o + x, o + x + y, o + y});
        if (isOpen)
            EXPECT_THROW(drawing.read(), InputError);
        else
            EXPECT_EQ(drawing.read().roomCount, 1u);
    }
}

TEST(SmallRooms, nothing_else_there_or_larger_ones_are_rooms) {
    Drawing alone(false);
    showcase(alone, {8, 0, 2}, 0.4);
    EXPECT_EQ(alone.read(1.0).roomCount, 1u);
    Drawing larger(false);
    larger.room(0, -1, true);
    showcase(larger, {8, 0, 2}, 0.5); // 0.125 m3
    EXPECT_EQ(larger.read().roomCount, 2u);
}

TEST(SmallRooms, what_is_between_two_panes_is_of_their_window) {
    Drawing drawing(false);
    drawing.room(0, -1, true);
    const double gap = -0.012;
    const std::array<dvec3, 4> pane{dvec3(1, 0.8, 0), dvec3(3, 0.8, 0), dvec3(3, 2, 0), dvec3(1, 2, 0)};
    std::vector<dvec3> outer;
    for (size_t k = 0; k < 4; ++k) {
        const dvec3 a = pane[k], b = pane[(k + 1) % 4], out(0, 0, gap);
        drawing.face("wall", {a, b, b + out, a + out});
        outer.push_back(a + out);
    }
    drawing.face("glass", outer);
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 1u);
    EXPECT_FALSE(warns(building, "closed space"));
    EXPECT_FALSE(warns(building, "of glass"));
}

TEST(SmallRooms, glass_of_a_house_that_is_open_is_told) {
    Drawing both(false);
    house(both, 0, false), house(both, 10, false);
    const Building building = both.read();
    EXPECT_EQ(building.roomCount, 2u);
    EXPECT_FALSE(warns(building, "of glass"));
    Drawing open(false);
    house(open, 0, false), house(open, 10, true);
    const Building one = open.read();
    EXPECT_EQ(one.roomCount, 1u);
    EXPECT_TRUE(warns(one, "1 face of glass (the first at "));
    EXPECT_TRUE(warns(one, "bounds no room"));
}

TEST(SmallRooms, a_house_that_is_open_is_no_showcase) {
    Drawing drawing(false);
    house(drawing, 0, true);
    showcase(drawing, {8, 0, 2}, 0.4);
    try {
        const Building building = drawing.read();
        FAIL() << building.roomCount;
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("encloses no room"), std::string::npos) << error.what();
    }
}

} // namespace heliodon::geometry
