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

} // namespace heliodon::geometry
