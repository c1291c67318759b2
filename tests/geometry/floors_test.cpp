// Rooms of 6 m x 5 m by hand, with galleries in them and with things that only look like such.
#include "geometry/floors.h"

#include <gtest/gtest.h>

#include "geometry/room_measures.h"
#include "tests/geometry/box_model.h"

using namespace heliodon::geometry;
using heliodon::test::BoxModel;

namespace {

struct Areas {
    double lowest = 0, upper = 0;
    size_t undecided = 0;
};

Areas areasOf(const BoxModel& model, double worldPerBuilding = 1) {
    PatchMesh mesh = ownTriangles(model.building());
    for (glm::dvec3& v : mesh.vertices) v *= worldPerBuilding;
    const Floors floors = findFloors(mesh, worldPerBuilding);
    Areas areas;
    const double square = worldPerBuilding * worldPerBuilding;
    for (const size_t i : floors.lowest) areas.lowest += patchArea(mesh, i) / square;
    for (const size_t i : floors.upper) areas.upper += patchArea(mesh, i) / square;
    areas.undecided = floors.undecided.size();
    return areas;
}

// What stands against the wall at z = 0.
Areas withBox(double height, glm::dvec3 low, glm::dvec3 high) {
    BoxModel model(height);
    model.add(low, high);
    return areasOf(model);
}

} // namespace

TEST(Floors, a_gallery_is_floor_and_so_is_what_is_below_it) {
    BoxModel model(5);
    model.add({0, 2.2, 0}, {3, 2.5, 3});
    model.addStairs(0, 2.5, 1, 3.1);
    for (const double scale : {1.0, 1 / 12.0}) {
        const Areas areas = areasOf(model, scale);
        EXPECT_NEAR(areas.lowest, 30, 1e-9);
        EXPECT_NEAR(areas.upper, 9, 1e-9);
    }
    const RoomMeasures room = measureRooms(ownTriangles(model.building()))[0];
    EXPECT_NEAR(room.floorArea, 39, 1e-9);
    EXPECT_NEAR(room.upperFloor, 9, 1e-9);
    EXPECT_NEAR(room.height, 5, 1e-12);
}

TEST(Floors, three_storeys_round_a_well) {
    BoxModel model(9);
    model.add({0, 2.7, 0}, {6, 3, 4});
    model.add({0, 5.7, 0}, {6, 6, 4});
    model.add({4, 3, 1}, {5, 3.75, 3});  // a table, on the first
    model.add({2, 6, 0}, {4, 8.1, 0.6}); // a wardrobe, on the second
    model.addStairs(0, 3, 0.5, 4.05);
    model.addStairs(3, 6, 2, 4.05);
    const Areas areas = areasOf(model);
    EXPECT_NEAR(areas.lowest, 30, 1e-6);
    EXPECT_NEAR(areas.upper, 24 - 2 + 24 - 1.2, 1e-6);
    EXPECT_EQ(areas.undecided, 0u);
}

TEST(Floors, what_no_stairs_lead_to_is_none_and_said) {
    for (const auto& [low, high] : std::vector<std::pair<glm::dvec3, glm::dvec3>>{
             {{0, 2.2, 0}, {3, 2.5, 3}},       // a gallery without its stairs, or a booth's roof
             {{0, 2.3, 0.5}, {5, 2.35, 4}}}) { // a ceiling that hangs from a wall
        const Areas areas = withBox(5, low, high);
        EXPECT_NEAR(areas.lowest, 30, 1e-9);
        EXPECT_EQ(areas.upper, 0);
        EXPECT_EQ(areas.undecided, 1u);
    }
}

TEST(Floors, tops_of_what_stands_on_the_floor_are_none) {
    for (const auto& [height, low, high] : std::vector<std::tuple<double, glm::dvec3, glm::dvec3>>{
             {4.5, {1, 0, 0}, {2.2, 2.2, 0.6}}, // a wardrobe
             {4.5, {1, 0, 0}, {5, 2.2, 0.6}},   // a wall of them
             {4.5, {2, 0, 1}, {2.15, 2.5, 5}},  // a partition
             {4.5, {1, 0, 1}, {5, 0.75, 3}},    // a counter
             {3.5, {1, 0, 0}, {3, 2.2, 3}},     // a cubicle under a ceiling that is near
             {5, {1, 2.2, 0}, {5, 2.25, 0.4}},  // a shelf
             {5, {1, 2.2, 0}, {2, 2.25, 1}},    // a small board
             {5, {1, 0, 0}, {4, 1.9, 3}},       // a low block
         }) {
        const Areas areas = withBox(height, low, high);
        EXPECT_EQ(areas.upper, 0) << high.x << " " << high.y << " " << high.z;
        EXPECT_EQ(areas.undecided, 0u) << high.x << " " << high.y << " " << high.z;
    }
}

TEST(Floors, a_large_terrace_without_air_beneath_is_floor_and_so_is_a_step_up_from_it) {
    BoxModel model(6);
    model.add({0, 0, 0}, {4, 2.5, 2});
    model.add({0, 2.5, 0}, {1, 2.7, 1});
    EXPECT_EQ(areasOf(model).upper, 0);
    EXPECT_EQ(areasOf(model).undecided, 1u);
    model.addStairs(0, 2.5, 1, 2.1);
    EXPECT_NEAR(areasOf(model).upper, 8, 1e-9);
    EXPECT_EQ(areasOf(model).undecided, 0u);
}
