// Ground and terrain, as sheets and solids, about rooms and through them.
#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include <glm/vec2.hpp>
#include <gtest/gtest.h>

#include "geometry/input_error.h"
#include "tests/geometry/sheet_drawing.h"

namespace heliodon::geometry {

using glm::dvec2;

// What corners are one, and what is flat, the glass says, not what stands around.
TEST(GroundOutside, ground_and_terrain_however_wide_leave_small_parts_of_rooms_as_they_are) {
    const auto twoPanes = [](const Sheets& around) { // 4 mm apart
        Drawing drawing(false);
        drawing.room(0, 5, false);
        for (const auto& [material, from, to] : {std::tuple("wall", dvec3(0, 0, 0), dvec3(4, 0.8, 0)),
                                                 std::tuple("wall", dvec3(0, 2, 0), dvec3(4, 2.5, 0)),
                                                 std::tuple("wall", dvec3(0, 0.8, 0), dvec3(1, 2, 0)),
                                                 std::tuple("glass", dvec3(1, 0.8, 0), dvec3(1.998, 2, 0)),
                                                 std::tuple("wall", dvec3(1.998, 0.8, 0), dvec3(2.002, 2, 0)),
                                                 std::tuple("glass", dvec3(2.002, 0.8, 0), dvec3(3, 2, 0)),
                                                 std::tuple("wall", dvec3(3, 0.8, 0), dvec3(4, 2, 0))})
            drawing.face(material, {from, {from.x, to.y, 0}, to, {to.x, from.y, 0}});
        around(drawing);
        return drawing.read();
    };
    const Building alone = twoPanes([](Drawing&) {});
    const auto isTheSame = [&](const Sheets& around) {
        const Building building = twoPanes(around);
        return building.roomCount == 1 && building.vertices == alone.vertices &&
               std::ranges::equal(building.faces, alone.faces, {}, &Face::loops, &Face::loops);
    };
    EXPECT_TRUE(isTheSame([](Drawing& d) { d.sheet({-1000, 0, -1000}, {0, 0, 2000}, {2000, 0, 0}); }));
    EXPECT_TRUE(isTheSame([](Drawing& d) {
        for (int k = 0; k < 400; ++k) {
            const double x = 200 * (k % 20) - 2000, z = 200 * (k / 20) - 2000;
            d.face("wall", {{x, -1, z}, {x, -1, z + 200}, {x + 200, -1 - k % 3, z}});
        }
    }));
}

// The window looks at it as if it were cut out: what is left of a hill that is higher than the sill is at the
// walls or outside of them.
TEST(GroundOutside, ground_that_runs_on_through_rooms_is_cut_at_their_walls) {
    const auto inRooms = [](Drawing& drawing, dvec3 back) {
        drawing.room(0, -1, true);
        drawing.sheet({-20, 0.3, -20}, {0, 0, 20}, {44, 0, 0});
        drawing.sheet({-20, 0.3, 0}, back, {44, 0, 0});
    };
    for (const double rise : {0.0, 10.0}) { // to 1.3 m at the back wall
        Drawing drawing(false);
        inRooms(drawing, {0, rise, 25});
        const Building building = drawing.read();
        EXPECT_EQ(building.roomCount, 1u);
        EXPECT_NEAR(volume(meshBuilding(building, {300})), 50, 1e-4);
        EXPECT_TRUE(std::ranges::any_of(building.warnings, [](const std::string& warning) {
            return warning.starts_with("the ground (") &&
                   warning.find("in them was left out") != std::string::npos;
        }));
        const std::vector<dvec3>& vertices = building.outside.vertices;
        const std::vector<uint32_t>& triangles = building.outside.triangles;
        for (size_t t = 0; t < triangles.size(); t += 3) {
            const dvec3 middle =
                (vertices[triangles[t]] + vertices[triangles[t + 1]] + vertices[triangles[t + 2]]) / 3.0;
            EXPECT_FALSE(middle.x > 0 && middle.x < 4 && middle.z > 0 && middle.z < 5);
        }
    }
    Drawing storeys(false); // of 6 m: its floor, or the ground
    storeys.room(0, 1, true);
    const dvec3 x(4, 0, 0), y(0, 3.5, 0), z(0, 0, 5), o(0, 2.5, 0);
    for (const auto& [at, u, v] : {std::tuple(o + y, x, z), std::tuple(o, y, z), std::tuple(o + x, z, y),
                                   std::tuple(o + z, y, x), std::tuple(o, x, y)})
        storeys.sheet(at, u, v);
    ground(storeys, 3);
    EXPECT_THROW(storeys.read(), InputError);
}

// What is not deeper than the house may be a hall that was drawn into it.
TEST(GroundOutside, ground_drawn_as_a_solid_is_cut_too) {
    for (const bool overhang : {false, true})
        for (const double deep : {-4.0, 0.0}) {
            Drawing drawing(false);
            drawing.room(0, -1, true);
            const dvec3 o(-20, deep, -20), x(44, 0, 0), y(0, 0.3 - deep, 0), z(0, 0, 45);
            for (const auto& [at, u, v] :
                 {std::tuple(o, x, z), std::tuple(o + y, z, x), std::tuple(o, z, y), std::tuple(o + x, y, z),
                  std::tuple(o, y, x), std::tuple(o + z, x, y)})
                drawing.sheet(at, u, v);
            if (overhang) drawing.sheet({0, 2.5, -1}, {4, 0, 0}, {0, 0, 1});
            if (deep == 0)
                EXPECT_THROW(drawing.read(), InputError);
            else
                expectOutside(drawing, "solid", overhang ? "2" : "1");
        }
}

// Where it rises by millimetres it is as near to the floor as what touches it.
TEST(GroundOutside, gentle_slopes_through_a_floor_are_cut) {
    for (const double slope : {0.0005, 0.002, 0.01})
        for (const dvec2 way : {dvec2(0.6, 0.8), dvec2(-0.28, 0.96), dvec2(1, 0)}) {
            Drawing drawing(false);
            drawing.room(0, -1, true);
            const auto at = [&](double x, double z) {
                return dvec3(x, slope * (way.x * (x - 1.3) + way.y * (z - 2.1)), z);
            };
            drawing.face("wall", {at(-20, -20), at(-20, 25), at(24, 25), at(24, -20)});
            expectOutside(drawing, "slope", "1");
        }
}

// The pane stands in the middle of its reveal, whose faces are not cut there.
TEST(GroundOutside, a_house_with_thick_walls_reaches_into_solid_ground) {
    constexpr double kThick = 0.3;
    const auto rectangle = [](double left, double low, double right, double high, double z) {
        return std::array<dvec3, 4>{{{left, low, z}, {right, low, z}, {right, high, z}, {left, high, z}}};
    };
    const auto hole = [&](double z) { return rectangle(1, 0.8, 3, 2, z); };
    for (const double top : {-0.1, 0.5}) {
        Drawing drawing(false);
        const dvec3 x(4, 0, 0), y(0, 2.5, 0), z(0, 0, 5), t(kThick);
        for (const bool outer : {false, true}) {
            const dvec3 o = outer ? -t : dvec3(0), u = x + (outer ? dvec3(2 * kThick, 0, 0) : dvec3(0)),
                        v = y + (outer ? dvec3(0, 2 * kThick, 0) : dvec3(0)),
                        w = z + (outer ? dvec3(0, 0, 2 * kThick) : dvec3(0));
            for (const auto& [at, a, b] : {std::tuple(o, w, u), std::tuple(o + v, u, w), std::tuple(o, v, w),
                                           std::tuple(o + u, w, v), std::tuple(o + w, v, u)})
                outer ? drawing.sheet(at, b, a) : drawing.sheet(at, a, b);
            const auto wall = rectangle(o.x, o.y, o.x + u.x, o.y + v.y, o.z), opening = hole(o.z);
            for (size_t k = 0; k < 4; ++k) {
                const size_t next = (k + 1) % 4;
                if (outer)
                    drawing.face("wall", {opening[k], opening[next], wall[next], wall[k]});
                else
                    drawing.face("wall", {wall[k], wall[next], opening[next], opening[k]});
            }
        }
        const auto inner = hole(0), outer = hole(-kThick), pane = hole(-kThick / 2);
        for (size_t k = 0; k < 4; ++k)
            drawing.face("wall", {inner[k], inner[(k + 1) % 4], outer[(k + 1) % 4], outer[k]});
        drawing.face("glass", {pane.begin(), pane.end()});
        solid(drawing, {-20, top - 3, -20}, {44, 3, 45});
        const Building building = drawing.read();
        EXPECT_EQ(building.roomCount, 1u) << top;
        EXPECT_NEAR(volume(meshBuilding(building, {300})), 50 + 2 * 1.2 * kThick / 2, 1e-4) << top;
    }
}

// As a grid of heights is drawn; one of a room's would make another room.
TEST(GroundOutside, terrain_may_be_of_bent_quads) {
    const auto quads = [](Drawing& drawing, double y) {
        for (int k = 0; k < 100; ++k) {
            const double x = 10 * (k % 10) - 50, z = 10 * (k / 10) - 50, bent = 0.5 * (k % 3);
            drawing.face("wall", {{x, y, z}, {x, y, z + 10}, {x + 10, y - bent, z + 10}, {x + 10, y, z}});
        }
    };
    Drawing terrain(false);
    terrain.room(0, -1, true);
    quads(terrain, -0.5);
    EXPECT_EQ(terrain.read().roomCount, 1u);
    Drawing floor(false);
    floor.room(0, 0, true);
    floor.face("wall", {{0, 0, 0}, {0, 0, 5}, {4, -0.3, 5}, {4, 0, 0}});
    EXPECT_THROW(floor.read(), InputError);
}

// Of terrain what is below the sill, which is at 0.8 m, is ground, not what hides it; fences stay.
TEST(GroundOutside, slopes_of_terrain_hide_the_sky_alone) {
    const auto lowestOf = [](dvec3 up,
                             int strips = 600) { // of what is before the window, seen from either side
        Drawing drawing(false);
        drawing.room(0, -1, true);
        for (int k = 0; k < strips; ++k)
            drawing.sheet({-5 + 14.0 * k / strips, -1, -2}, {14.0 / strips, 0, 0}, up);
        const Occluders outside = drawing.read().outside;
        double lowest = 1e300;
        for (const uint32_t v : outside.triangles) lowest = std::min(lowest, outside.vertices[v].y);
        return lowest;
    };
    EXPECT_EQ(lowestOf({0, -10, -10}), 1e300); // away from the house
    EXPECT_EQ(lowestOf({0, 1.7, -10}), 1e300);
    EXPECT_NEAR(lowestOf({0, 10, -10}), 0.8, 1e-9);
    EXPECT_NEAR(lowestOf({0, 10, -4}), 0.8, 1e-9);
    EXPECT_EQ(lowestOf({0, 1.5, 0}), -1);
    EXPECT_EQ(lowestOf({0, 1.7, -10}, 1), -1); // few triangles are as bright as they are
    EXPECT_EQ(lowestOf({0, 10, -10}, 1), -1);
}

// Parts of it are as low as gardens with fences; as a solid the ground is its floor.
TEST(GroundOutside, a_room_without_a_side_that_the_ground_divides_is_no_sheet) {
    const auto isRefused = [](int without, const Sheets& around) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        drawing.room(6, without, false);
        around(drawing);
        try {
            drawing.read();
        } catch (const InputError& error) {
            return std::string(error.what()).find("that lacks") != std::string::npos;
        }
        return false;
    };
    for (int without = 0; without < 6; ++without) {
        EXPECT_TRUE(isRefused(without, [](Drawing& d) { ground(d, 0.6); })) << without;
        EXPECT_TRUE(isRefused(without, [](Drawing& d) { // terrain
            for (int k = 0; k < 8; ++k)
                d.sheet({-20, 0.6 - 0.1 * (k % 2), 6.0 * k - 20}, {0, 0.1 * (k % 2 * 2 - 1), 6}, {44, 0, 0});
        })) << without;
    }
    EXPECT_TRUE(isRefused(3, [](Drawing& d) { d.sheet({6, 2, 0}, {4, 0, 0}, {0, 0, 5}); }));
    EXPECT_TRUE(isRefused(3, [](Drawing& d) { solidGround(d); }));
}

// One beside the other, on a common wall, its floor in the ground on which the other stands: whole.
TEST(GroundOutside, a_closed_room_in_solid_ground_is_not_lost) {
    for (const bool window : {true, false}) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        drawing.room(4, -1, window, 0, -1, 1.2);
        solidGround(drawing);
        const Building building = drawing.read();
        EXPECT_EQ(building.roomCount, 2u) << window;
        EXPECT_NEAR(volume(meshBuilding(building, {300})), 100, 1e-4);
        const auto isGlass = [&](const Face& face) { return building.materials[face.material].isOpening(); };
        EXPECT_EQ(std::ranges::count_if(building.faces, isGlass), window ? 2 : 1);
    }
}

// Also where the faces of a house say less: the floor of an attic looks out of the room below it. Where they
// say that it is air there is a word.
TEST(GroundOutside, solid_ground_that_is_a_floor_is_no_room) {
    for (const bool looksIn : {false, true}) {
        Drawing drawing(false);
        drawing.deep = 10;
        drawing.room(0, 1, true);
        drawing.room(0, -1, false, 0, 2.5);
        solidGround(drawing, looksIn);
        const Building building = drawing.read();
        EXPECT_EQ(building.roomCount, looksIn ? 3u : 2u);
        EXPECT_EQ(std::ranges::any_of(building.warnings,
                                      [](const std::string& warning) {
                                          return warning.find("is it the ground") != std::string::npos;
                                      }),
                  looksIn);
    }
}

// The pane is at 0.8 to 2 m.
TEST(GroundOutside, the_ground_through_glass_is_refused_by_name) {
    for (const double y : {0.6, 0.8, 0.9, 1.9, 2.0}) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        ground(drawing, y);
        std::string fault;
        try {
            drawing.read();
        } catch (const InputError& error) {
            fault = error.what();
        }
        EXPECT_EQ(fault.find("through the glass") != std::string::npos, y > 0.8 && y < 2) << y << fault;
        EXPECT_EQ(fault.empty(), y <= 0.8 || y >= 2) << y << fault;
    }
}

} // namespace heliodon::geometry
