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
            EXPECT_EQ(told(turned, 2, over ? "its faces look the other way" : "it stands apart"),
                      over || gap > 1 ? 1u : 0u)
                << gap << over;
        }
    for (const double gap : {0.0, 0.2}) {
        Drawing tall(false);
        tall.room(0, -1, true);
        solid(tall, {4 + gap, 0, -1}, {6, 9, 8}, true);
        EXPECT_EQ(told(tall, 2, "it is higher and larger"), 1u) << gap;
    }
}

TEST(DarkRooms, rooms_without_windows_are_rooms) {
    for (const bool over : {false, true})
        for (const double gap : {0.0, 0.3}) {
            Drawing drawing(over);
            drawing.room(0, -1, true);
            drawing.room(4 + gap, -1, false), drawing.room(8 + 2 * gap, -1, false);
            EXPECT_EQ(told(drawing, 3, ""), 0u) << gap << over;
        }
}

} // namespace heliodon::geometry
