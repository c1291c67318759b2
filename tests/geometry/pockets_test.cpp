// What short walls part off beside longer ones: pockets behind and beside piers, passages past corners, and
// pilasters that lie flat on a wall.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "geometry/building.h"
#include "tests/geometry/drawn_pieces.h"

using namespace heliodon::geometry;
using heliodon::test::turned;
using heliodon::test::wall;

namespace {

constexpr double kHalf = 0.1875; // inches of a wall's thickness

Sketch box(double thickness = 2 * kHalf) {
    const double h = thickness / 2;
    Sketch s;
    s.walls = {wall("s", {-9 - h, -6}, {9 + h, -6}), wall("e", {9, -6 - h}, {9, 6 + h}),
               wall("n", {9 + h, 6}, {-9 - h, 6}), wall("w", {-9, 6 + h}, {-9, -6 - h})};
    for (Wall& w : s.walls) w.thickness = thickness;
    return s;
}

constexpr double kBox = 17.625 * 11.625; // square inches

void expectRooms(const Sketch& sketch, const std::vector<double>& areas, double off) {
    for (const double degrees : {0.0, 33.0, 90.0, 211.0}) {
        ClosureReport report = closeSketch(turned(sketch, degrees)).report;
        std::ranges::sort(report.rooms, std::greater(), &RoomReport::floorAreaFt2);
        ASSERT_EQ(report.rooms.size(), areas.size()) << report.message;
        for (size_t r = 0; r < areas.size(); ++r)
            EXPECT_NEAR(report.rooms[r].floorAreaFt2, areas[r], off) << degrees << " degrees";
    }
}

} // namespace

// A pier whose head stands so far from the wall, on a stem in its middle or at one end.
TEST(Pockets, behind_the_head_of_a_pier_are_room) {
    for (const double stem : {0.5, 0.8, 1.0, 1.3})
        for (const double head : {2.0, 4.0})
            for (const double at : {0.0, head / 2 - kHalf}) {
                SCOPED_TRACE(testing::Message() << stem << ", " << head << ", " << at);
                const double y = -6 + stem + 2 * kHalf;
                Sketch s = box();
                s.walls.push_back(wall("stem", {at, -6}, {at, y}));
                s.walls.push_back(wall("head", {-head / 2, y}, {head / 2, y}));
                const double pier = 2 * kHalf * (stem + head);
                expectRooms(s, {kBox - pier}, 1e-6);
                s.walls[4].b.y -= kHalf + 0.2; // the stem ends before the head
                s.walls[4].a.y += kHalf + 0.1;
                if (stem > 0.7) expectRooms(s, {kBox - pier}, 1e-6);
            }
}

TEST(Pockets, between_a_pilaster_and_a_corner_are_room) {
    for (const double air : {0.5, 0.8, 1.0, 1.1})
        for (const double length : {1.0, 3.0}) {
            SCOPED_TRACE(testing::Message() << air << ", " << length);
            const double x = -9 + air + 2 * kHalf;
            Sketch s = box();
            s.walls.push_back(wall("p", {x, -6}, {x, -6 + kHalf + length}));
            expectRooms(s, {kBox - 2 * kHalf * length}, 1e-6);
        }
}

// Where one end is a wall and the other one is shut as well, nobody gets in.
TEST(Pockets, between_walls_that_are_closed_at_both_ends_are_none) {
    Sketch s = box();
    s.walls.push_back(wall("lining", {-8, -6}, {-8, 6}));
    s.walls.push_back(wall("across", {-9, 0}, {-8, 0}));
    expectRooms(s, {(17.625 - 1) * 11.625}, 1e-6);
}

// A closet whose door is in its corner, where two walls end: open as elsewhere from 1.6 in on.
TEST(Pockets, passages_past_a_corner_are_open_from_where_doors_are) {
    for (const double clear : {1.4, 1.65, 1.8, 2.2}) {
        SCOPED_TRACE(clear);
        const double off = clear / std::sqrt(2.0) + kHalf; // from the crossing of the two walls to their ends
        Sketch s = box();
        s.walls.push_back(wall("d", {-3, 6}, {-3, off}));
        s.walls.push_back(wall("c", {-9, 0}, {-3 - off, 0}));
        const double closet = (6 - 2 * kHalf) * (6 - 2 * kHalf),
                     walls = 2 * kHalf * (12 - 2 * kHalf - 2 * off);
        if (clear < 1.5)
            expectRooms(s, {kBox - 6 * 6, closet}, 0.1);
        else
            expectRooms(s, {kBox - walls}, 1e-6);
    }
}

// A wall before the facade that stands for itself, though the facade has a hole there. One that ends where
// the facade does is the front of a porch; a corridor has holes at its ends.
TEST(Pockets, the_path_along_a_garden_wall_is_none) {
    for (const double off : {2.5, 4.0})
        for (const bool porch : {false, true}) {
            SCOPED_TRACE(testing::Message() << off << ", porch " << porch);
            Sketch s = box();
            s.walls[0].b.x = -2;
            s.walls.push_back(wall("s2", {2, -6}, {9 + kHalf, -6}));
            const double end = porch ? 9 + kHalf : 5;
            s.walls.push_back(wall("garden", {-end, -6 - off}, {end, -6 - off}));
            const ClosureReport report = closeSketch(s).report;
            ASSERT_EQ(report.rooms.size(), 1u) << report.message;
            EXPECT_NEAR(report.rooms[0].floorAreaFt2, porch ? kBox + 17.625 * off : kBox, porch ? 5 : 1e-6);
            EXPECT_EQ(std::ranges::find(report.walls, "garden", &WallRole::id)->role,
                      porch ? "exterior" : "outside_extra");
        }
    Sketch s = box();
    for (const size_t i : {1, 3}) { // a corridor from hole to hole
        const Wall side = s.walls[i];
        const double end = side.b.y > side.a.y ? 1.6 : -1.6;
        s.walls.push_back(wall(side.id + "2", {side.a.x, end}, side.b));
        s.walls[i].b.y = -end;
    }
    s.walls.push_back(wall("c", {-9, 1.7}, {9, 1.7}));
    s.walls.push_back(wall("d1", {-9, -1.7}, {-1, -1.7}));
    s.walls.push_back(wall("d2", {2, -1.7}, {9, -1.7}));
    EXPECT_EQ(closeSketch(s).report.rooms.size(), 2u);
}

TEST(Pockets, a_wall_that_stops_short_of_a_hole_in_the_facade_parts_two_rooms) {
    for (const double off : {0.0, 0.1, 0.3, 0.5}) {
        SCOPED_TRACE(off);
        Sketch s = box();
        s.walls[0].b.x = -2.5;
        s.walls.push_back(wall("s2", {3, -6}, {9 + kHalf, -6}));
        s.walls.push_back(wall("across", {0, 6 - kHalf}, {0, -6 + kHalf + off}));
        expectRooms(s, {8.625 * 11.625, 8.625 * 11.625}, 1e-2);
    }
}

TEST(Pockets, the_alley_between_two_houses_is_none) {
    Sketch s = box();
    s.walls[1].b.y = -1; // a hole of 3 in on to the alley, which is 1.2 in wide
    s.walls.push_back(wall("e2", {9, 2}, {9, 6 + kHalf}));
    for (const Wall& w : box().walls) { // farther back
        s.walls.push_back(w);
        s.walls.back().id += "3";
        for (glm::dvec2* p : {&s.walls.back().a, &s.walls.back().b}) *p += glm::dvec2(19.575, 2);
    }
    for (Wall& w : s.walls)
        for (glm::dvec2* p : {&w.a, &w.b}) p->x -= 10;
    expectRooms(s, {kBox, kBox}, 1e-6);
}

// Thin ones, whose middle is as near to that of the wall as a copy's would be.
TEST(Pockets, flat_pilasters_stand_out) {
    for (const double thickness : {0.2, 0.25})
        for (const double length : {1.0, 4.0, 8.0})
            for (const bool inside : {true, false}) {
                SCOPED_TRACE(testing::Message() << thickness << ", " << length << ", inside " << inside);
                const double y = -6 + (inside ? 1 : -1) * (0.125 + thickness / 2);
                Sketch s = box(0.25);
                s.walls.push_back(wall("p", {-2, y}, {-2 + length, y}));
                s.walls.back().thickness = thickness;
                expectRooms(s, {17.75 * 11.75 - (inside ? thickness * length : 0)}, 1e-6);
            }
    Sketch s = box(0.25); // a copy, off by what a hand errs
    s.walls.push_back(wall("p", {-2, -5.9}, {2, -5.9}));
    s.walls.back().thickness = 0.25;
    EXPECT_NE(closeSketch(s).report.message.find("p repeats s"), std::string::npos);
}
