// Neighbours whose faces look into them are rooms by all that is drawn: told, never silent.
#include "geometry/dark_rooms.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "tests/geometry/sheet_drawing.h"

namespace heliodon::geometry {

namespace {

size_t told(Drawing& drawing, uint32_t rooms, const std::string& why) {
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, rooms) << why;
    return static_cast<size_t>(std::ranges::count_if(building.warnings, [&](const std::string& warning) {
        return warning.find(": " + why) < warning.npos &&
               warning.find("is it a neighbouring building") < warning.npos;
    }));
}

} // namespace

TEST(DarkRooms, neighbours_that_look_like_rooms_are_told) {
    for (const double gap : {0.0, 0.2, 6.0})
        for (const bool over : {false, true}) {
            Drawing turned(over); // all of it, but the neighbour once more
            turned.room(0, -1, true);
            solid(turned, {4 + gap, -0.2, -1}, {5, 2, 5}, !over);
            const char* why = over      ? "its faces look the other way"
                              : gap > 1 ? "it stands apart"
                                        : "a solid beside rooms with glass may be drawn just so";
            EXPECT_EQ(told(turned, 2, why), 1u) << gap << over;
        }
    for (const double gap : {0.0, 0.2}) {
        Drawing tall(false);
        tall.room(0, -1, true);
        solid(tall, {4 + gap, 0, -1}, {6, 9, 8}, true);
        EXPECT_EQ(told(tall, 2, "it is higher and larger"), 1u) << gap;
    }
}

// However near and low: nothing tells a block from a room that is drawn as it is.
TEST(DarkRooms, blocks_as_rooms_are_drawn_are_told) {
    for (const double gap : {0.1, 0.3})
        for (const double high : {1.2, 2.5, 3.0})
            for (const bool over : {false, true}) {
                Drawing drawing(over);
                drawing.room(0, -1, true);
                solid(drawing, {4 + gap, 0, 0}, {3, high, 5}, true);
                EXPECT_EQ(told(drawing, 2, "a solid beside"), 1u) << gap << high << over;
            }
}

// A floor of its own material tells a room, but not one face that goes on below both.
TEST(DarkRooms, blocks_on_the_ground_that_rooms_stand_on_are_told) {
    for (const double gap : {0.0, 0.3, 1.0}) {
        Drawing drawing(false);
        drawing.room(0, 0, true), drawing.room(4 + gap, 0, false);
        drawing.sheet({0, 0, 0}, {0, 0, 5}, {8 + gap, 0, 0}, "paint");
        EXPECT_EQ(told(drawing, 2, gap < 0.5 ? "a solid beside" : "it stands apart"), 1u) << gap;
    }
}

TEST(DarkRooms, rooms_without_windows_are_rooms) {
    for (const bool over : {false, true})
        for (const double gap : {0.0, 0.3})
            for (const bool named : {false, true}) {
                Drawing drawing(over);
                const auto room = [&](const char* name, double left, bool window) {
                    if (named) drawing.object(name);
                    drawing.room(left, -1, window);
                };
                if (!named) drawing.floor = "paint";
                room("hall", 0, true), room("Room 1", 4 + gap, false), room("room2", 8 + 2 * gap, false);
                EXPECT_EQ(told(drawing, 3, ""), 0u) << gap << over << named;
            }
}

TEST(DarkRooms, what_says_nothing_of_rooms_does_not_tell_them) {
    for (const bool named : {false, true}) {
        Drawing drawing(false);
        if (named) drawing.object("rooms"); // both
        drawing.room(0, -1, true);
        if (!named) drawing.floor = "paint"; // as no room with glass has it
        drawing.room(4.3, -1, false);
        EXPECT_EQ(told(drawing, 2, "a solid beside"), 1u) << named;
    }
}

// Walls with a thickness say which way all else is drawn.
TEST(DarkRooms, models_inside_out_with_thick_walls_keep_neighbours_outside) {
    for (const bool over : {false, true}) {
        Drawing drawing(over);
        drawing.room(0, -1, true);
        const double t = 0.3;
        const auto outer = Drawing::sidesOf(dvec3(-t), {4 + 2 * t, 2.5 + 2 * t, 5 + 2 * t});
        for (size_t k = 0; k < 5; ++k) drawing.sheet(outer[k][0], outer[k][2], outer[k][1]);
        const std::array<dvec3, 4> wall{
            dvec3(-t, -t, -t), {-t, 2.5 + t, -t}, {4 + t, 2.5 + t, -t}, {4 + t, -t, -t}},
            hole{dvec3(1, 0.8, -t), {1, 2, -t}, {3, 2, -t}, {3, 0.8, -t}};
        for (size_t k = 0; k < 4; ++k) {
            drawing.face("wall", {wall[k], wall[(k + 1) % 4], hole[(k + 1) % 4], hole[k]});
            drawing.sheet(hole[k], hole[(k + 1) % 4] - hole[k], {0, 0, t}); // reveal
        }
        solid(drawing, {4.5, 0, 0}, {3, 2, 4});
        EXPECT_EQ(told(drawing, 1, ""), 0u) << over;
    }
}

} // namespace heliodon::geometry
