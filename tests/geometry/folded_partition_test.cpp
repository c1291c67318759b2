// Four rooms round an upright line, 2.5 m high: two of the walls between them have open doors, and fold where
// the other two end.
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/mesher.h"
#include "tests/geometry/sheet_drawing.h"

using namespace heliodon::geometry;

namespace {

struct Rectangle {
    dvec3 o, u, v; // looks along u x v
    const char* material = "wall";
};

// At this z, from x to x + 4.
void addWallWithWindow(std::vector<Rectangle>& all, double x, double z) {
    const auto add = [&](double from, double to, double low, double high, const char* material = "wall") {
        all.push_back({{x + from, low, z}, {to - from, 0, 0}, {0, high - low, 0}, material});
    };
    add(0, 1, 0, 2.5), add(1, 4, 0, 1), add(1, 2, 1, 2, "glass"), add(2, 4, 1, 2), add(1, 4, 2, 2.5);
}

// 4 m wide; in front 4 m deep, behind `depth`.
std::vector<Rectangle> fourRooms(double depth) {
    const dvec3 up(0, 2.5, 0), x4(4, 0, 0);
    std::vector<Rectangle> all;
    for (const auto& [z, deep] : {std::pair(0.0, dvec3(0, 0, 4)), {4.0, dvec3(0, 0, depth)}}) {
        for (const double x : {0.0, 4.0}) {
            all.push_back({{x, 0, z}, x4, deep}), all.push_back({{x, 2.5, z}, x4, deep});
            addWallWithWindow(all, x, z > 0 ? 4 + depth : 0);
        }
        for (const double x : {0.0, 8.0}) all.push_back({{x, 0, z}, up, deep});
    }
    all.push_back({{4, 0, 4}, x4, up}), all.push_back({{4, 0, 4}, up, {0, 0, depth}});
    for (const auto& [from, to, low, high] :
         {std::array{0.0, 2.0, 0.0, 2.5}, {2.9, 4, 0, 2.5}, {2, 2.9, 2, 2.5}}) {
        all.push_back({{4, low, from}, {0, high - low, 0}, {0, 0, to - from}});
        all.push_back({{from, low, 4}, {to - from, 0, 0}, {0, high - low, 0}});
    }
    return all;
}

// A depth of 4 m lets the diagonal of the room behind the fold run into the board's corner, others close by;
// in whatever order the file has them.
TEST(FoldedPartition, is_a_board_where_two_walls_end_on_its_fold) {
    for (const double depth : {4.0, 3.42, 4.7})
        for (const size_t step : {1u, 7u, 11u}) {
            SCOPED_TRACE(testing::Message() << depth << ' ' << step);
            const std::vector<Rectangle> all = fourRooms(depth);
            Drawing drawing(false);
            drawing.triangles = true;
            for (size_t k = 0; k < all.size(); ++k) {
                const Rectangle& one = all[k * step % all.size()];
                drawing.sheet(one.o, one.u, one.v, one.material);
            }
            const Building building = drawing.read();
            EXPECT_EQ(building.roomCount, 2u);
            EXPECT_NEAR(volume(meshBuilding(building, {300})), 20 * (4 + depth) - 2 * 8.2e-3, 1e-4);
        }
}

} // namespace
