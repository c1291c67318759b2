// Sketches that lie another way on the table are the same building: turned_sketches.json has some in which
// cracks, bridges and walls are equal but for rounding.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/geometry/shuffled_closure.h"

using namespace heliodon::geometry;
using nlohmann::json;

namespace {

const json& sketches() {
    static const json all = json::parse(std::ifstream(HELIODON_TEST_DATA "/geometry/turned_sketches.json"));
    return all;
}

Sketch sketchOf(const json& entry) {
    const std::string file = testing::TempDir() + "turned_" + entry["id"].get<std::string>() + ".json";
    std::ofstream(file) << entry;
    return readSketch(file);
}

Sketch turned(Sketch sketch, double degrees, bool mirrored) {
    const double angle = degrees * std::numbers::pi / 180;
    // Quarter turns move no corner by a rounding error.
    const double c = std::fmod(degrees, 90) == 0 ? std::round(std::cos(angle)) : std::cos(angle),
                 s = std::fmod(degrees, 90) == 0 ? std::round(std::sin(angle)) : std::sin(angle);
    const auto turn = [&](glm::dvec2& p) {
        const double x = mirrored ? -p.x : p.x;
        p = {c * x - s * p.y, s * x + c * p.y};
    };
    for (Wall& wall : sketch.walls) {
        turn(wall.a);
        turn(wall.b);
    }
    for (Arc& arc : sketch.arcs) {
        turn(arc.center);
        if (mirrored) std::tie(arc.a0Deg, arc.a1Deg) = std::pair(180 - arc.a1Deg, 180 - arc.a0Deg);
        arc.a0Deg += degrees;
        arc.a1Deg += degrees;
    }
    for (Skylight& skylight : sketch.skylights) {
        turn(skylight.center);
        skylight.angleDeg = degrees + (mirrored ? -skylight.angleDeg : skylight.angleDeg);
    }
    return sketch;
}

ClosureReport reportOf(const Sketch& sketch) {
    ClosureReport report = closeSketch(sketch).report;
    std::ranges::sort(report.rooms, {}, [](const RoomReport& room) {
        return std::tuple(room.floorAreaFt2, room.ceilingFt, room.euler);
    });
    return report;
}

} // namespace

class TurnedSketch : public testing::TestWithParam<size_t> {};

TEST_P(TurnedSketch, is_the_same_building) {
    const Sketch sketch = sketchOf(sketches()[GetParam()]);
    const ClosureReport drawn = reportOf(sketch);
    ASSERT_FALSE(drawn.rooms.empty());
    // Where folds of curved walls come to lie is found in a few rounds.
    const double off = sketch.arcs.empty() ? 1e-9 : 1e-6;
    for (const bool mirrored : {false, true})
        for (const double degrees : {0.0, 17.0, 33.0, 90.0, 137.0, 180.0, 211.0, 270.0}) {
            SCOPED_TRACE(testing::Message() << degrees << " degrees, mirrored " << mirrored);
            const ClosureReport again = reportOf(turned(sketch, degrees, mirrored));
            EXPECT_EQ(again.code, drawn.code);
            EXPECT_EQ(again.windowCount, drawn.windowCount);
            EXPECT_EQ(again.skylightPaneCount, drawn.skylightPaneCount);
            ASSERT_EQ(again.rooms.size(), drawn.rooms.size());
            for (size_t r = 0; r < drawn.rooms.size(); ++r) {
                const RoomReport &room = again.rooms[r], &meant = drawn.rooms[r];
                EXPECT_NEAR(room.floorAreaFt2, meant.floorAreaFt2, off * meant.floorAreaFt2);
                EXPECT_EQ(room.ceilingFt, meant.ceilingFt);
                EXPECT_EQ(room.euler, meant.euler);
            }
        }
}

TEST_P(TurnedSketch, order_of_primitives_changes_nothing) {
    heliodon::test::expectSameInAnyOrder(sketchOf(sketches()[GetParam()]));
}

// Nor does it matter in how many pieces a wall was drawn that go on from one another.
TEST_P(TurnedSketch, in_pieces_it_is_the_same_building) {
    const Sketch sketch = sketchOf(sketches()[GetParam()]);
    Sketch pieces = sketch;
    for (const Wall& wall : sketch.walls) {
        Wall rest = wall;
        rest.id += "_rest";
        rest.a = glm::mix(wall.a, wall.b, 0.37);
        const double kept = glm::length(rest.a - wall.a);
        std::ranges::find(pieces.walls, wall.id, &Wall::id)->b = rest.a;
        for (WindowMarker& window : pieces.windows)
            if (window.wall == wall.id && window.pos > kept) {
                window.wall = rest.id;
                window.pos -= kept;
            }
        pieces.walls.push_back(rest);
    }
    const ClosureReport whole = reportOf(sketch), again = reportOf(pieces);
    ASSERT_EQ(again.rooms.size(), whole.rooms.size()) << again.message;
    for (size_t r = 0; r < whole.rooms.size(); ++r) {
        EXPECT_NEAR(again.rooms[r].floorAreaFt2, whole.rooms[r].floorAreaFt2,
                    1e-6 * whole.rooms[r].floorAreaFt2);
        EXPECT_EQ(again.rooms[r].ceilingFt, whole.rooms[r].ceilingFt);
    }
}

TEST(TurnedRing, arcs_that_end_where_others_begin_are_one) {
    Sketch sketch;
    for (const double from : {-120.255, -240.255, -360.255})
        sketch.arcs.push_back({.id = std::to_string(from), .radius = 5, .a0Deg = from, .a1Deg = from + 120});
    for (double degrees = 0; degrees < 360; degrees += 1.3)
        EXPECT_EQ(facetsOfArcs(turned(sketch, degrees, false)).size(), 1u) << degrees;
}

TEST(TurnedRing, gaps_between_arcs_have_as_many_facets_mirrored) {
    Sketch sketch;
    sketch.arcs = {{.id = "a", .radius = 9, .a0Deg = 5, .a1Deg = 234},
                   {.id = "b", .radius = 9, .a0Deg = 285, .a1Deg = 305}};
    const ClosureReport drawn = reportOf(sketch), mirrored = reportOf(turned(sketch, 0, true));
    ASSERT_EQ(drawn.rooms.size(), 1u) << drawn.message;
    ASSERT_EQ(mirrored.rooms.size(), 1u);
    EXPECT_NEAR(mirrored.rooms[0].floorAreaFt2, drawn.rooms[0].floorAreaFt2, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(All, TurnedSketch, testing::Range<size_t>(0, sketches().size()),
                         [](const auto& parameter) {
                             return sketches()[parameter.param]["id"].template get<std::string>();
                         });
