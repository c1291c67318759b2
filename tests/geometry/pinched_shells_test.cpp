// Bodies that touch one another, or a wall, in an edge or a corner alone.
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tests/geometry/sheet_drawing.h"

namespace heliodon::geometry {

namespace {

// A room of 50 m3 less what stands there.
void expectCutOut(const std::string& what, double cubicMetres, const std::function<void(Drawing&)>& draw) {
    SCOPED_TRACE(what);
    for (const bool over : {false, true}) {
        Drawing drawing(over);
        drawing.room(0, -1, true);
        draw(drawing);
        const Building building = drawing.read();
        EXPECT_EQ(building.roomCount, 1u);
        EXPECT_NEAR(volume(meshBuilding(building, {300})), 50 - cubicMetres, 1e-5);
    }
}

// Upright, of a square of `side` turned by 45 degrees, from its corner at `o` on.
void diamond(Drawing& drawing, dvec3 o, double side, double height) {
    const double r = side * std::sqrt(0.5);
    const std::array<dvec3, 4> at{o, o + dvec3(-r, 0, r), o + dvec3(0, 0, 2 * r), o + dvec3(r, 0, r)};
    const dvec3 up(0, height, 0);
    drawing.face("wall", {at[3], at[2], at[1], at[0]});
    drawing.face("wall", {at[0] + up, at[1] + up, at[2] + up, at[3] + up});
    for (size_t k = 0; k < 4; ++k)
        drawing.face("wall", {at[k], at[(k + 1) % 4], at[(k + 1) % 4] + up, at[k] + up});
}

} // namespace

TEST(PinchedShells, boxes_that_touch_in_an_edge_or_a_corner) {
    for (const double y : {0.0, 0.7}) // on the floor and in the air
        for (const double high : {0.5, 0.8})
            expectCutOut(fmt::format("edge, {} {}", y, high), 0.25 * (0.5 + high), [&](Drawing& drawing) {
                solid(drawing, {1, y, 2}, dvec3(0.5));
                solid(drawing, {1.5, y, 2.5}, {0.5, high, 0.5});
            });
    expectCutOut("corner", 0.25, [](Drawing& drawing) {
        solid(drawing, {1, 0.7, 2}, dvec3(0.5));
        solid(drawing, {1.5, 1.2, 2.5}, dvec3(0.5));
    });
    expectCutOut("to the ceiling", 2 * 0.25 * 2.5, [](Drawing& drawing) {
        solid(drawing, {1, 0, 2}, {0.5, 2.5, 0.5});
        solid(drawing, {1.5, 0, 2.5}, {0.5, 2.5, 0.5});
    });
}

// Boxes of sheets: the edge has two faces of each, whichever way they look.
TEST(PinchedShells, rooms_that_touch_in_an_edge_alone) {
    for (const bool over : {false, true})
        for (const bool looksIn : {false, true}) {
            Drawing drawing(over);
            drawing.room(0, -1, true);
            solid(drawing, {4, 0, 5}, {3, 2.5, 3}, looksIn);
            const Building building = drawing.read();
            const bool isSolid = !over && !looksIn; // else it is told that it may be
            EXPECT_EQ(building.roomCount, isSolid ? 1u : 2u) << over << looksIn;
            EXPECT_EQ(building.warnings.size(), 1u) << over << looksIn;
            EXPECT_NEAR(volume(meshBuilding(building, {300})), 50 + (isSolid ? 0 : 22.5), 1e-4);
        }
}

TEST(PinchedShells, stairs_of_blocks) {
    expectCutOut("stairs", 5 * 0.3 * 0.2, [](Drawing& drawing) {
        for (int k = 0; k < 5; ++k) solid(drawing, {1 + 0.3 * k, 0.2 * k, 2}, {0.3, 0.2, 1});
    });
}

TEST(PinchedShells, an_edge_at_a_wall) {
    for (const double y : {0.0, 0.5})
        for (const double height : {1.0, 2.5 - y})
            expectCutOut(fmt::format("{} {}", y, height), 0.16 * height, [&](Drawing& drawing) {
                diamond(drawing, {3.5, y, 0}, 0.4, height);
            });
}

// Turned, of five decimals, walls and pane with a thickness. Where the triangles of the wall meet in that
// edge, it has a corner of theirs.
TEST(PinchedShells, an_edge_in_the_air_at_a_wall_of_triangles) {
    const std::vector<dvec3> at{{-5.18318, -0.2, -3.66695},
                                {-5.18318, 0.8, -3.66695},
                                {-7.57661, 0.8, -7.35903},
                                {-7.57661, -0.2, -7.35903},
                                {-6.92386, 0.8, -6.3521},
                                {-6.92386, 2.9, -6.3521},
                                {-7.57661, 2.9, -7.35903},
                                {-5.18318, 2.9, -3.66695},
                                {-5.83593, 2.9, -4.67388},
                                {-5.83593, 0.8, -4.67388},
                                {-5.83593, 2.2, -4.67388},
                                {-6.92386, 2.2, -6.3521},
                                {-0.08949, 0, -7.20734},
                                {-0.08949, 2.7, -7.20734},
                                {-2.26534, 2.7, -10.56378},
                                {-2.26534, 0, -10.56378},
                                {-7.3, 0, -7.3},
                                {-7.3, 0.8, -7.3},
                                {-5.12415, 0.8, -3.94356},
                                {-5.12415, 0, -3.94356},
                                {-7.3, 2.7, -7.3},
                                {-6.75604, 2.7, -6.46089},
                                {-6.75604, 0.8, -6.46089},
                                {-5.66811, 0.8, -4.78267},
                                {-5.66811, 2.7, -4.78267},
                                {-5.12415, 2.7, -3.94356},
                                {-6.75604, 2.2, -6.46089},
                                {-5.66811, 2.2, -4.78267},
                                {-2.20631, -0.2, -10.84039},
                                {-2.20631, 2.9, -10.84039},
                                {0.18712, 2.9, -7.14831},
                                {0.18712, -0.2, -7.14831},
                                {-5.76041, 0.8, -4.72284},
                                {-5.76041, 2.2, -4.72284},
                                {-6.84834, 2.2, -6.40105},
                                {-6.84834, 0.8, -6.40105},
                                {-6.83156, 0.8, -6.41193},
                                {-6.83156, 2.2, -6.41193},
                                {-5.74363, 2.2, -4.73372},
                                {-5.74363, 0.8, -4.73372},
                                {-4.74513, 0.5, -8.4333},
                                {-4.74513, 2, -8.4333},
                                {-4.78267, 2, -8.93189},
                                {-4.78267, 0.5, -8.93189},
                                {-4.18437, 0.5, -8.97694},
                                {-4.18437, 2, -8.97694},
                                {-4.14682, 2, -8.47835},
                                {-4.14682, 0.5, -8.47835}};
    const std::vector<std::array<size_t, 3>> wall{
        {1, 2, 3},    {1, 3, 4},    {5, 6, 7},    {5, 7, 3},    {2, 8, 9},    {2, 9, 10},   {11, 9, 6},
        {11, 6, 12},  {13, 14, 15}, {13, 15, 16}, {17, 18, 19}, {17, 19, 20}, {18, 21, 22}, {18, 22, 23},
        {24, 25, 26}, {24, 26, 19}, {27, 22, 25}, {27, 25, 28}, {29, 30, 31}, {29, 31, 32}, {29, 32, 1},
        {29, 1, 4},   {27, 28, 11}, {27, 11, 12}, {15, 14, 26}, {15, 26, 21}, {17, 20, 13}, {17, 13, 16},
        {5, 10, 24},  {5, 24, 23},  {7, 8, 31},   {7, 31, 30},  {7, 30, 29},  {7, 29, 4},   {11, 28, 24},
        {11, 24, 10}, {26, 14, 13}, {26, 13, 20}, {17, 16, 15}, {17, 15, 21}, {5, 23, 27},  {5, 27, 12},
        {1, 32, 31},  {1, 31, 8},   {41, 42, 43}, {41, 43, 44}, {45, 46, 47}, {45, 47, 48}, {45, 48, 41},
        {45, 41, 44}, {43, 42, 47}, {43, 47, 46}, {43, 46, 45}, {43, 45, 44}, {41, 48, 47}, {41, 47, 42}};
    const std::vector<std::array<size_t, 3>> pane{{33, 34, 35}, {33, 35, 36}, {37, 38, 39}, {37, 39, 40},
                                                  {37, 40, 33}, {37, 33, 36}, {35, 34, 39}, {35, 39, 38},
                                                  {35, 38, 37}, {35, 37, 36}, {33, 40, 39}, {33, 39, 34}};
    Drawing drawing(false);
    for (const auto& t : wall) drawing.face("wall", {at[t[0] - 1], at[t[1] - 1], at[t[2] - 1]});
    for (const auto& t : pane) drawing.face("glass", {at[t[0] - 1], at[t[1] - 1], at[t[2] - 1]});
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 1u);
    EXPECT_NEAR(volume(meshBuilding(building, {300})), 6 * 2.7 * 4 + 0.28 - 0.45, 0.1);
}

// Neither wall covers the other, and a corner of each lies on the other room.
TEST(PinchedShells, rooms_side_by_side_of_other_height_and_depth_are_none_within_the_other) {
    Drawing drawing(false);
    const auto low = Drawing::sidesOf({0, 0, 0}, {3, 2.5, 4}),
               high = Drawing::sidesOf({3, 0, 0}, {4, 3.2, 2.5});
    const auto draw = [&](const std::array<dvec3, 3>& side, const char* material = "wall") {
        drawing.sheet(side[0], side[1], side[2], material);
    };
    for (const size_t k : {0u, 1u, 2u, 4u}) draw(low[k]);
    for (const size_t k : {0u, 1u, 3u, 4u}) draw(high[k]);
    draw(low[5], "glass"), draw(high[5], "glass"), draw(low[3]);
    drawing.sheet(high[2][0], high[2][2], high[2][1]); // turned over
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 2u);
    EXPECT_NEAR(volume(meshBuilding(building, {300})), 30 + 32, 1e-4);
}

} // namespace heliodon::geometry
