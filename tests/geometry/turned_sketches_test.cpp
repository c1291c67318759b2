// Sketches that lie another way on the table are the same building: turned_sketches.json has some in which
// cracks, bridges and walls are equal but for rounding.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <tuple>

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
    for (Wall& wall : sketch.walls)
        for (glm::dvec2* p : {&wall.a, &wall.b}) {
            const double x = mirrored ? -p->x : p->x;
            *p = {c * x - s * p->y, s * x + c * p->y};
        }
    return sketch;
}

std::vector<std::tuple<double, double, int>> roomsOf(const Sketch& sketch) {
    std::vector<std::tuple<double, double, int>> rooms;
    for (const RoomReport& room : closeSketch(sketch).report.rooms)
        rooms.emplace_back(room.floorAreaFt2, room.ceilingFt, room.euler);
    std::ranges::sort(rooms);
    return rooms;
}

} // namespace

class TurnedSketch : public testing::TestWithParam<size_t> {};

TEST_P(TurnedSketch, is_the_same_building) {
    const Sketch sketch = sketchOf(sketches()[GetParam()]);
    ASSERT_TRUE(sketch.arcs.empty());
    const auto drawn = roomsOf(sketch);
    ASSERT_FALSE(drawn.empty());
    for (const bool mirrored : {false, true})
        for (const double degrees : {0.0, 90.0, 180.0, 270.0, 211.0}) {
            SCOPED_TRACE(testing::Message() << degrees << " degrees, mirrored " << mirrored);
            const auto again = roomsOf(turned(sketch, degrees, mirrored));
            ASSERT_EQ(again.size(), drawn.size());
            for (size_t r = 0; r < drawn.size(); ++r) {
                EXPECT_NEAR(std::get<0>(again[r]), std::get<0>(drawn[r]), 1e-9 * std::get<0>(drawn[r]));
                EXPECT_EQ(std::get<1>(again[r]), std::get<1>(drawn[r]));
                EXPECT_EQ(std::get<2>(again[r]), std::get<2>(drawn[r]));
            }
        }
}

TEST_P(TurnedSketch, order_of_primitives_changes_nothing) {
    heliodon::test::expectSameInAnyOrder(sketchOf(sketches()[GetParam()]));
}

INSTANTIATE_TEST_SUITE_P(All, TurnedSketch, testing::Range<size_t>(0, sketches().size()),
                         [](const auto& parameter) {
                             return sketches()[parameter.param]["id"].template get<std::string>();
                         });
