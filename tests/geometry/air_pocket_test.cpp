// Walls with a thickness drawn as one shell: without glass in their hole they bound no room.
#include "geometry/air_pocket.h"

#include <array>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "geometry/input_error.h"
#include "tests/geometry/sheet_drawing.h"

namespace heliodon::geometry {

namespace {

using Corners = std::array<dvec3, 4>;

void ring(Drawing& drawing, const Corners& outer, const Corners& inner) {
    for (size_t k = 0; k < 4; ++k)
        drawing.face("wall", {outer[k], outer[(k + 1) % 4], inner[(k + 1) % 4], inner[k]});
}

// A room of 4 by 2.5 by 5 m in walls of 0.3 m, with a hole of 2 by 1.2 m in front; its faces look into these.
void thickRoom(Drawing& drawing, double turn, bool glass) {
    const auto at = [&](double x, double y, double z) {
        return dvec3(std::cos(turn) * x + std::sin(turn) * z, y, std::cos(turn) * z - std::sin(turn) * x);
    };
    const auto box = [&](double grow, bool over) {
        const double a = -grow, x = 4 + grow, y = 2.5 + grow, z = 5 + grow;
        for (Corners side : {Corners{at(a, a, a), at(x, a, a), at(x, a, z), at(a, a, z)},
                             Corners{at(a, y, a), at(a, y, z), at(x, y, z), at(x, y, a)},
                             Corners{at(a, a, a), at(a, a, z), at(a, y, z), at(a, y, a)},
                             Corners{at(x, a, a), at(x, y, a), at(x, y, z), at(x, a, z)},
                             Corners{at(a, a, z), at(x, a, z), at(x, y, z), at(a, y, z)}}) {
            if (over) std::ranges::reverse(side);
            drawing.face("wall", {side.begin(), side.end()});
        }
        return Corners{at(a, a, a), at(x, a, a), at(x, y, a), at(a, y, a)};
    };
    const Corners outer = box(0.3, true), inner = box(0, false);
    const auto hole = [&](double z) {
        return Corners{at(1, 0.8, z), at(3, 0.8, z), at(3, 2, z), at(1, 2, z)};
    };
    ring(drawing, outer, hole(-0.3)), ring(drawing, inner, hole(0)), ring(drawing, hole(-0.3), hole(0));
    const Corners pane = hole(0);
    if (glass) drawing.face("glass", {pane.begin(), pane.end()});
}

} // namespace

TEST(AirPocket, a_hole_in_thick_walls_needs_glass) {
    for (const double turn : {0.0, 0.5}) {
        Drawing drawing(false);
        thickRoom(drawing, turn, false);
        try {
            const Building building = drawing.read();
            FAIL() << building.roomCount;
        } catch (const InputError& error) {
            const std::string what = error.what();
            EXPECT_NE(what.find("the only closed space is the inside of the walls"), std::string::npos)
                << what;
            EXPECT_TRUE(turn > 0 || what.find("2 m wide and 1.2 m high, near x 1.99, y 1.40, z -0.30 m") !=
                                        std::string::npos)
                << what;
        }
    }
}

TEST(AirPocket, with_glass_it_is_a_room) {
    Drawing drawing(false);
    thickRoom(drawing, 0, true);
    EXPECT_NEAR(volume(meshBuilding(drawing.read(), {300})), 50, 1e-4);
}

// Without glass: about a yard, of 1 m all round, and with a column that takes a third of it.
TEST(AirPocket, rooms_about_yards_and_columns_are_rooms) {
    for (const double height : {2.5, 6.0}) {
        Drawing drawing(false);
        const auto plan = [&](double grow, double y) {
            return Corners{dvec3(-grow, y, -grow), dvec3(6 + grow, y, -grow), dvec3(6 + grow, y, 6 + grow),
                           dvec3(-grow, y, 6 + grow)};
        };
        for (const double y : {0.0, height}) ring(drawing, plan(1, y), plan(0, y));
        for (const double grow : {0.0, 1.0}) ring(drawing, plan(grow, 0), plan(grow, height));
        EXPECT_NEAR(volume(meshBuilding(drawing.read(), {300})), 28 * height, 1e-4);
    }
}

} // namespace heliodon::geometry
