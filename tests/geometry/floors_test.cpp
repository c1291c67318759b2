// Rooms of 6 m x 5 m by hand, with galleries in them and with things that only look like such.
#include "geometry/floors.h"

#include <cmath>

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

Areas areasOf(PatchMesh mesh, double worldPerBuilding = 1) {
    for (glm::dvec3& v : mesh.vertices) v *= worldPerBuilding;
    const Floors floors = findFloors(mesh, worldPerBuilding);
    Areas areas;
    const double square = worldPerBuilding * worldPerBuilding;
    for (const size_t i : floors.lowest) areas.lowest += patchArea(mesh, i) / square;
    for (const size_t i : floors.upper) areas.upper += patchArea(mesh, i) / square;
    areas.undecided = floors.undecided.size();
    return areas;
}

Areas areasOf(const BoxModel& model, double worldPerBuilding = 1) {
    return areasOf(ownTriangles(model.building()), worldPerBuilding);
}

// A room of 5 m whose outline this is, seen along it.
Areas withOutline(const std::vector<glm::dvec2>& outline) {
    const auto n = static_cast<uint32_t>(outline.size());
    PatchMesh mesh;
    mesh.materials.emplace_back();
    std::vector<uint32_t> front, back;
    for (const glm::dvec2 p : outline) {
        mesh.vertices.emplace_back(p.x, p.y, 0);
        mesh.vertices.emplace_back(p.x, p.y, 5);
    }
    for (uint32_t k = 0; k < n; ++k) {
        const uint32_t next = (k + 1) % n;
        mesh.addPatch(std::vector{2 * k, 2 * k + 1, 2 * next + 1, 2 * next}, 0, Role::projection, k, 0);
        front.push_back(2 * k), back.insert(back.begin(), 2 * k + 1);
    }
    mesh.addPatch(front, 0, Role::projection, n, 0);
    mesh.addPatch(back, 0, Role::projection, n + 1, 0);
    return areasOf(std::move(mesh));
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

// Over the ceiling of the storey below, and no higher than stairs may rise at their end.
TEST(Floors, furniture_on_upper_floors_is_none) {
    for (const auto& [high, stands] :
         {std::pair(glm::dvec3(2, 3.5, 2), 4.0), {{2, 3.45, 0.9}, 1.8}, {{1.8, 3.74, 1.8}, 3.24}}) {
        BoxModel model(6);
        model.add({0, 2.8, 0}, {6, 3, 4});
        model.add({0, 3, 0}, high);
        model.addStairs(0, 3, 0.5, 4.05);
        const Areas areas = areasOf(model);
        EXPECT_NEAR(areas.lowest, 30, 1e-6) << high.y;
        EXPECT_NEAR(areas.upper, 24 - stands, 1e-6) << high.y;
        EXPECT_EQ(areas.undecided, 0u) << high.y;
    }
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
             {3, {4, 0, 0}, {6, 0.5, 2.1}},     // a bed
             {3, {1, 0, 1.5}, {5, 0.75, 3}},    // a table
             {3, {2, 0, 2}, {5, 0.9, 3.2}},     // an island
             {3, {0, 0, 0}, {6, 0.9, 0.65}},    // a counter from wall to wall
             {3, {0, 0, 0}, {4, 0.5, 0.45}},    // the seat of a window
             {3, {1, 0, 1}, {2, 0.4, 4}},       // a planter
             {4, {1, 0, 1}, {5, 1.9, 2.1}},     // a rack
         }) {
        const Areas areas = withBox(height, low, high);
        EXPECT_EQ(areas.upper, 0) << high.x << " " << high.y << " " << high.z;
        EXPECT_EQ(areas.undecided, 0u) << high.x << " " << high.y << " " << high.z;
    }
}

// The floor goes on under it; its lowest shelf lies within a step of that.
TEST(Floors, the_lowest_shelf_of_a_bookcase_is_none) {
    BoxModel model(2.8);
    for (const double y : {0.05, 0.45, 0.85}) model.add({1, y, 0}, {2.2, y + 0.02, 0.4});
    EXPECT_NEAR(areasOf(model).lowest, 30, 1e-9);
    EXPECT_NEAR(areasOf(model, 1 / 12.0).lowest, 30, 1e-9);
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

TEST(Floors, a_pit_is_floor_and_so_is_what_is_round_it) {
    for (const double depth : {0.3, 0.5, 0.9, 1.5, 2.2, 4.0})
        for (const double scale : {1.0, 1 / 12.0}) {
            const Areas areas = areasOf(BoxModel(3, {2, -depth, 1}, {5, 0, 4}), scale);
            EXPECT_NEAR(areas.lowest, 30, 1e-9) << depth;
            EXPECT_EQ(areas.upper, 0);
            EXPECT_EQ(areas.undecided, 0u);
        }
}

// A pool is larger than what is round it.
TEST(Floors, a_large_pit_has_floor_all_round_it) {
    for (const double depth : {0.9, 2.2}) {
        const Areas areas = areasOf(BoxModel(4, {1, -depth, 1}, {5, 0, 4}));
        EXPECT_NEAR(areas.lowest, 30, 1e-9) << depth;
        EXPECT_EQ(areas.undecided, 0u) << depth;
    }
    BoxModel model(4, {0.5, -0.9, 0.5}, {5.5, 0, 4.5}); // round it runs a bench
    EXPECT_NEAR(areasOf(model).lowest, 20, 1e-9);
}

TEST(Floors, what_stands_in_a_pit_or_beside_it_is_none) {
    BoxModel model(3, {2, -0.9, 1}, {5, 0, 4});
    model.add({2, -0.9, 1}, {5, -0.45, 1.5});   // a bench
    model.add({0.2, 0, 0.2}, {1.8, 0.75, 0.9}); // a table
    const Areas areas = areasOf(model);
    EXPECT_NEAR(areas.lowest, 30 - 1.5 - 1.12, 1e-9);
    EXPECT_EQ(areas.undecided, 0u);
}

TEST(Floors, beds_beside_one_another_are_none_however_the_room_is_turned) {
    BoxModel model;
    for (int k = 0; k < 2; ++k) model.add({0.5 + 3 * k, 0, 0}, {2.5 + 3 * k, 0.5, 2.1});
    PatchMesh mesh = ownTriangles(model.building());
    for (const double turn : {0.0, 0.5, 0.8}) {
        PatchMesh turned = mesh;
        for (glm::dvec3& v : turned.vertices)
            v = {v.x * std::cos(turn) - v.z * std::sin(turn), v.y,
                 v.x * std::sin(turn) + v.z * std::cos(turn)};
        const Areas areas = areasOf(std::move(turned));
        EXPECT_NEAR(areas.lowest, 30 - 8.4, 1e-9) << turn;
        EXPECT_EQ(areas.undecided, 0u) << turn;
    }
}

TEST(Floors, gutters_and_what_is_too_low_to_stand_in_are_none) {
    EXPECT_NEAR(
        withOutline({{0, 3}, {0, 0}, {2, 0}, {2, -0.4}, {2.3, -0.4}, {2.3, 0}, {6, 0}, {6, 3}}).lowest, 28.5,
        1e-9);
    // A crawl space below a floor with a hatch.
    EXPECT_NEAR(withOutline({{0, 3},
                             {0, 0},
                             {4, 0},
                             {4, -0.2},
                             {0, -0.2},
                             {0, -1},
                             {6, -1},
                             {6, -0.2},
                             {4.25, -0.2},
                             {4.25, 0},
                             {6, 0},
                             {6, 3}})
                    .lowest,
                28.75, 1e-9);
}

TEST(Floors, a_narrow_room_along_a_deep_pit_is_floor_or_said) {
    const auto areas = [](double beside) {
        return withOutline({{-beside, 3},
                            {-beside, 0},
                            {0, 0},
                            {0, -1.5},
                            {0.9, -1.5},
                            {0.9, 0},
                            {0.9 + beside, 0},
                            {0.9 + beside, 3}});
    };
    EXPECT_NEAR(areas(1).lowest, 14.5, 1e-9);
    EXPECT_EQ(areas(1).undecided, 0u);
    EXPECT_NEAR(areas(0.58).lowest, 4.5, 1e-9);
    EXPECT_EQ(areas(0.58).undecided, 2u);
}

TEST(Floors, stages_are_floor) {
    for (const double h : {0.3, 0.4, 0.6, 0.8, 1.0, 1.2, 1.6}) { // beside a bar
        const Areas areas = withOutline(
            {{0, 4.5}, {0, h + 0.1}, {0.6, h + 0.1}, {0.6, 0}, {3.5, 0}, {3.5, h}, {6, h}, {6, 4.5}});
        EXPECT_NEAR(areas.lowest, 27, 1e-9) << h;
        EXPECT_EQ(areas.undecided, 0u) << h;
    }
}

TEST(Floors, what_is_a_stage_or_furniture_is_said) {
    for (const auto& [height, low, high] : std::vector<std::tuple<double, glm::dvec3, glm::dvec3>>{
             {3, {1, 0, 0}, {4, 0.8, 1.5}},    // a small stage, or a table at the wall
             {4, {1.5, 0, 1}, {4.5, 1, 4}},    // a ring, or a machine
             {5, {1, 0, 0}, {4, 1.9, 3}},      // a podium, or a block
             {4, {0, 0, 0}, {6, 0.45, 1}},     // one row of seats, or a bench
             {4, {0, 0.5, 0}, {3, 0.6, 5}}}) { // a stage on legs, or a counter
        const Areas areas = withBox(height, low, high);
        EXPECT_EQ(areas.undecided, 1u) << high.x << " " << high.y << " " << high.z;
        EXPECT_LE(areas.lowest, 30 + 1e-9);
    }
}

TEST(Floors, stairs_make_a_small_stage_floor) {
    BoxModel model(4);
    model.add({3, 0, 0}, {6, 0.8, 1.5});
    model.add({2.7, 0.16, 0.2}, {2.95, 0.2, 1.2});
    model.add({2.8, 0.36, 0.2}, {2.95, 0.4, 1.2});
    model.add({2.9, 0.56, 0.2}, {2.95, 0.6, 1.2});
    const Areas areas = areasOf(model);
    EXPECT_NEAR(areas.lowest, 30, 1e-9);
    EXPECT_EQ(areas.undecided, 0u);
}

TEST(Floors, terraces_are_floor) {
    for (const double rise : {0.3, 0.45, 0.9}) {
        std::vector<glm::dvec2> outline{{0, 6}, {0, 0}};
        for (int k = 0; k < 4; ++k) {
            outline.emplace_back(2 + 0.9 * k, rise * k);
            outline.emplace_back(2 + 0.9 * k, rise * (k + 1));
        }
        outline.emplace_back(6, 4 * rise), outline.emplace_back(6, 6);
        EXPECT_NEAR(withOutline(outline).lowest, 30, 1e-9) << rise;
        EXPECT_EQ(withOutline(outline).undecided, 0u) << rise;
    }
}

TEST(Floors, ramps_are_floor_and_lead_to_it) {
    for (const double rise : {0.5, 1.1, 1.45}) // up to 13.6 degrees
        EXPECT_NEAR(withOutline({{0, 5}, {0, 0}, {6, rise}, {6, 5}}).lowest, 5 * std::hypot(6, rise), 1e-9);
    EXPECT_NEAR(withOutline({{0, 5}, {0, 0}, {1, 0}, {5, 0.7}, {6, 0.7}, {6, 5}}).lowest,
                5 * (2 + std::hypot(4, 0.7)), 1e-9);
}

TEST(Floors, stairs_lead_to_what_is_beside_them_and_to_no_table_elsewhere) {
    BoxModel model(5);
    for (int k = 0; k < 10; ++k) model.add({0.25 * k, 0, 0}, {0.25 * (k + 1), 0.25 * (k + 1), 1});
    model.add({2.5, 2.3, 0}, {6, 2.5, 2});
    model.add({1, 0, 4}, {3, 0.75, 5}); // a table
    const Areas areas = areasOf(model);
    EXPECT_NEAR(areas.lowest, 30 - 2 - 0.25, 1e-9);
    EXPECT_NEAR(areas.upper, 7.25, 1e-9); // though one goes there by steps alone
}
