// Pictures in the plane of a wall without thickness between two rooms: only their winding tells whose they
// are.
#include <algorithm>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "geometry/mesher.h"
#include "tests/geometry/sheet_drawing.h"

using namespace heliodon::geometry;

namespace {

// Square metres that look along `way`.
double areaThatLooks(const PatchMesh& mesh, const char* material, dvec3 way) {
    double out = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        if (mesh.materials[mesh.material[i]].name == material)
            out += std::max(0.0, 0.5 * glm::dot(patchAreaVector(mesh, i), way));
    return out;
}

// The faces of a room from x = 4 to 12, without the wall at x = 4.
void nextRoom(Drawing& drawing) {
    const auto sides = Drawing::sidesOf({4, 0, 0}, {8, 2.5, 5});
    for (const size_t k : {0u, 1u, 3u, 4u, 5u}) drawing.sheet(sides[k][0], sides[k][1], sides[k][2]);
}

std::vector<dvec3> turnedIf(bool over, std::vector<dvec3> face) {
    if (over) std::ranges::reverse(face);
    return face;
}

TEST(WallPictures, are_seen_in_the_room_that_they_look_into) {
    for (const bool outwards : {false, true})
        for (const double gap : {-1e-5, 0.0, 1e-5})
            for (const bool wallOver : {false, true})
                for (const bool over : {false, true}) {
                    Drawing drawing(outwards);
                    drawing.room(0, 3, true);
                    nextRoom(drawing);
                    drawing.triangles = true; // the picture is larger than some of the wall's
                    drawing.face("wall",
                                 turnedIf(wallOver, {{4, 0, 0}, {4, 2.5, 0}, {4, 2.5, 1.5}, {4, 0, 1.5}}));
                    drawing.face("wall",
                                 turnedIf(wallOver, {{4, 0, 1.5}, {4, 2.5, 1.5}, {4, 2.5, 5}, {4, 0, 5}}));
                    const double x = 4 - gap;
                    drawing.face("paint", turnedIf(over, {{x, 1, 1}, {x, 2, 1}, {x, 2, 3}, {x, 1, 3}}));
                    const Building building = drawing.read();
                    EXPECT_EQ(building.roomCount, 2u);
                    const PatchMesh mesh = meshBuilding(building, {300});
                    const dvec3 x1(1, 0, 0);
                    EXPECT_NEAR(areaThatLooks(mesh, "paint", x1), over ? 0 : 2, 1e-3) << gap << wallOver;
                    EXPECT_NEAR(areaThatLooks(mesh, "paint", -x1), over ? 2 : 0, 1e-3) << gap << wallOver;
                }
}

// Which is wider than the room behind it, and not mostly that room's.
TEST(WallPictures, on_a_wall_of_several_rooms_are_not_seen_behind_it) {
    Drawing drawing(false);
    drawing.deep = 8;
    drawing.room(0, 3, true);
    for (const double z : {0.0, 5.0}) {
        const auto sides = Drawing::sidesOf({4, 0, z}, {4, 2.5, z > 0 ? 3.0 : 5.0});
        for (const size_t k : {0u, 1u, 3u, 4u, 5u})
            if (k != 5u || z == 0) drawing.sheet(sides[k][0], sides[k][1], sides[k][2]);
    }
    drawing.face("wall", {{4, 0, 0}, {4, 0, 8}, {4, 2.5, 8}, {4, 2.5, 0}}); // looks into the large room
    drawing.face("paint", {{4, 1, 6}, {4, 1, 7}, {4, 2, 7}, {4, 2, 6}});    // as it does
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 3u);
    const PatchMesh mesh = meshBuilding(building, {300});
    EXPECT_NEAR(areaThatLooks(mesh, "paint", {-1, 0, 0}), 1, 1e-3);
    EXPECT_NEAR(areaThatLooks(mesh, "paint", {1, 0, 0}), 0, 1e-3);
}

// The annexe's own wall, though it is turned as that of the hall behind it.
TEST(WallPictures, are_not_the_smaller_wall_of_a_smaller_room) {
    Drawing drawing(false);
    drawing.deep = 8;
    drawing.room(0, -1, true);
    const auto sides = Drawing::sidesOf({4, 0, 2}, {4, 2, 3});
    for (const size_t k : {0u, 1u, 3u, 4u, 5u}) drawing.sheet(sides[k][0], sides[k][1], sides[k][2]);
    drawing.face("paint", {{4, 0, 2}, {4, 0, 5}, {4, 2, 5}, {4, 2, 2}});
    const PatchMesh mesh = meshBuilding(drawing.read(), {300});
    EXPECT_NEAR(areaThatLooks(mesh, "paint", {1, 0, 0}), 6, 1e-3);
}

// Whose floors meet under it: the picture is no other side of it, as a body's.
TEST(WallPictures, hang_before_partitions_with_an_open_door) {
    for (const double gap : {0.005, 0.3})
        for (const bool triangles : {false, true}) {
            Drawing drawing(false);
            drawing.triangles = triangles;
            drawing.room(0, 3, true);
            nextRoom(drawing);
            drawing.sheet({4, 0, 0}, {0, 2.5, 0}, {0, 0, 3});
            drawing.sheet({4, 0, 3.9}, {0, 2.5, 0}, {0, 0, 1.1});
            drawing.sheet({4, 2, 3}, {0, 0.5, 0}, {0, 0, 0.9});
            const double x = 4 - gap;
            drawing.face("paint", {{x, 1, 1}, {x, 1, 2}, {x, 2, 2}, {x, 2, 1}});
            const Building building = drawing.read();
            EXPECT_EQ(building.roomCount, 1u);
            const PatchMesh mesh = meshBuilding(building, {300});
            EXPECT_NEAR(volume(mesh), 150, 0.02);
            EXPECT_NEAR(areaThatLooks(mesh, "paint", {-1, 0, 0}), 1, 1e-2);
        }
}

} // namespace
