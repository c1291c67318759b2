// Models of a 6 m x 5 m x 3 m room with things in it, by hand.
#include "geometry/room_measures.h"

#include <gtest/gtest.h>

#include "geometry/mesher.h"
#include "geometry/model_file.h"
#include "tests/geometry/box_model.h"

using namespace heliodon::geometry;
using heliodon::test::BoxModel;

TEST(RoomMeasures, an_empty_room) {
    const auto rooms = measureRooms(ownTriangles(BoxModel().building()));
    ASSERT_EQ(rooms.size(), 1u);
    EXPECT_NEAR(rooms[0].floorArea, 30, 1e-9);
    EXPECT_NEAR(rooms[0].volume, 90, 1e-9);
    EXPECT_NEAR(rooms[0].height, 3, 1e-12);
    EXPECT_EQ(rooms[0].euler, 2);
}

TEST(RoomMeasures, volumes_alone_are_the_same) {
    const PatchMesh mesh = ownTriangles(BoxModel().building());
    const RoomMeasures all = measureRooms(mesh)[0], some = measureVolumes(mesh)[0];
    EXPECT_EQ(some.volume, all.volume);
    EXPECT_EQ(some.surface, all.surface);
    EXPECT_EQ(some.openings, all.openings);
    EXPECT_EQ(some.floorArea, 0);
}

TEST(RoomMeasures, glass_is_part_of_the_surface) {
    Building building = BoxModel().building();
    building.materials.emplace_back().transmittance = glm::vec3(0.8f);
    building.faces[0].material = static_cast<uint32_t>(building.materials.size() - 1);
    const PatchMesh mesh = ownTriangles(building);
    const auto rooms = measureRooms(mesh);
    double glass = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        if (mesh.surface[i] == building.faces[0].surface) glass += patchArea(mesh, i);
    EXPECT_GT(glass, 0);
    EXPECT_NEAR(rooms[0].openings, glass, 1e-9);
    EXPECT_NEAR(rooms[0].surface, 126, 1e-9);
}

TEST(RoomMeasures, tops_of_furniture_are_no_floor) {
    BoxModel model;
    model.add({1, 0, 1}, {2, 0.75, 2});    // stands on the floor, which is not there below it
    model.add({3, 0.7, 3}, {4, 0.75, 4});  // a table without legs
    model.add({4.5, 0.1, 1}, {5, 0.2, 2}); // low, but one can not walk under it either
    const auto rooms = measureRooms(ownTriangles(model.building()));
    ASSERT_EQ(rooms.size(), 1u);
    EXPECT_NEAR(rooms[0].floorArea, 29, 1e-9);
    EXPECT_NEAR(rooms[0].volume, 90 - 0.75 - 0.05 - 0.05, 1e-9);
    EXPECT_EQ(rooms[0].euler, 6);
}

TEST(RoomMeasures, stairs_lead_to_more_floor) {
    BoxModel model;
    for (int k = 1; k <= 4; ++k) // steps of 0.2 m beside one another
        model.add({1 + 0.4 * k, 0, 0.5}, {1.39 + 0.4 * k, 0.2 * k, 1.5});
    model.add({3, 0, 0.5}, {4, 0.9, 2.5}); // a gallery 0.1 m above the last step
    EXPECT_NEAR(measureRooms(ownTriangles(model.building()))[0].floorArea, 30, 1e-9);
    EXPECT_NEAR(measureRooms(ownTriangles(model.building()), 0.6)[0].floorArea, 30 - 4 * 0.39 - 2, 1e-9);
}

TEST(RoomMeasures, glass_is_one_pane_up_to_where_it_turns_changes_or_touches_in_a_point) {
    PatchMesh mesh;
    const auto material = [&](float transmittance) {
        mesh.materials.emplace_back().transmittance = glm::vec3(transmittance);
    };
    material(0.6f), material(0.9f), material(0);
    using Polygon = std::vector<uint32_t>;
    const auto count = [&](const std::vector<glm::dvec3>& vertices,
                           const std::vector<std::pair<uint32_t, Polygon>>& faces) {
        PatchMesh of;
        of.materials = mesh.materials, of.vertices = vertices;
        for (const auto& [m, corners] : faces) of.addPatch(corners, m, Role::projection, 0, 0);
        of.twin.assign(of.patchCount(), kNoTwin);
        const PaneCount panes = countPanes(of);
        return std::pair(panes.windows, panes.skylightPanes);
    };
    using Counts = std::pair<int, int>;
    const std::vector<glm::dvec3> box{{0, 0, 0}, {5, 0, 0}, {5, 3, 0}, {0, 3, 0},
                                      {0, 0, 4}, {5, 0, 4}, {5, 3, 4}, {0, 3, 4}};
    const Polygon south{4, 7, 6, 5}, north{0, 1, 2, 3}, east{1, 5, 6, 2}, top{3, 2, 6, 7}, bottom{0, 4, 5, 1};
    EXPECT_EQ(count(box, {{0, south}, {0, east}, {0, north}}), Counts(3, 0));
    EXPECT_EQ(count(box, {{0, south}, {0, top}}), Counts(1, 1));
    EXPECT_EQ(count(box, {{2, south}, {0, top}, {0, bottom}}), Counts(0, 2));
    // Squares of one wall, 3 x 3 vertices: side by side, cornerwise, of two kinds, and bent.
    std::vector<glm::dvec3> wall;
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 3; ++x) wall.emplace_back(x, y, 0);
    const auto square = [](uint32_t x, uint32_t y) {
        const uint32_t at = 3 * y + x;
        return Polygon{at, at + 1, at + 4, at + 3};
    };
    EXPECT_EQ(count(wall, {{0, square(0, 0)}, {0, square(1, 0)}}), Counts(1, 0));
    EXPECT_EQ(count(wall, {{0, square(0, 0)}, {0, square(1, 1)}}), Counts(2, 0));
    EXPECT_EQ(count(wall, {{0, square(0, 0)}, {1, square(1, 0)}}), Counts(2, 0));
    for (int y = 0; y < 3; ++y) wall[static_cast<size_t>(3 * y + 2)].z = 0.5; // 27 degrees: of a curved pane
    EXPECT_EQ(count(wall, {{0, square(0, 0)}, {0, square(1, 0)}}), Counts(1, 0));
}

// Profiles, along z by 5 m.
TEST(RoomMeasures, a_floor_and_walls_drawn_as_one_body_are_told_from_rooms) {
    const auto likeWalls = [](const std::vector<glm::dvec2>& profile) {
        const std::string file = testing::TempDir() + "room_measures_profile.obj";
        {
            std::ofstream out(file);
            const size_t n = profile.size();
            for (const double z : {0.0, 5.0})
                for (const glm::dvec2 p : profile) out << fmt::format("v {} {} {}\n", p.x, p.y, z);
            std::string front = "f", back = "f";
            for (size_t k = 0; k < n; ++k) {
                out << fmt::format("f {} {} {} {}\n", k + 1, (k + 1) % n + 1, (k + 1) % n + 1 + n, k + 1 + n);
                front += fmt::format(" {}", n - k), back += fmt::format(" {}", n + k + 1);
            }
            out << front << '\n' << back << '\n';
        }
        const std::vector<RoomMeasures> rooms = measureRooms(ownTriangles(importModel(file)));
        EXPECT_EQ(rooms.size(), 1u);
        return isLikeFloorAndWalls(rooms[0]);
    };
    EXPECT_TRUE(likeWalls({{0, 0}, {6, 0}, {6, 0.3}, {0.3, 0.3}, {0.3, 3}, {0, 3}}));
    EXPECT_TRUE(likeWalls({{0, 0}, {6, 0}, {6, 3}, {5.5, 3}, {5.5, 0.3}, {0.5, 0.3}, {0.5, 3}, {0, 3}}));
    EXPECT_FALSE(likeWalls({{0, 0}, {6, 0}, {6, 3}, {0, 3}}));
    EXPECT_FALSE(likeWalls({{0, 0}, {6, 0}, {3, 4}}));
    EXPECT_FALSE(likeWalls({{0, 0}, {6, 0}, {6, 3}, {3, 3}, {3, 5}, {0, 5}}));     // half of it higher
    EXPECT_FALSE(likeWalls({{0, 0}, {5, 0}, {5, -10}, {6, -10}, {6, 3}, {0, 3}})); // a shaft
}

TEST(RoomMeasures, panes_are_counted_by_pieces_of_glass) {
    const PatchMesh mesh = meshBuilding(importModel(
        HELIODON_TEST_DATA "/compute/daylight/d_skylight_partition_overcast_mar21_13_g0.2/model.obj",
        UpAxis::z));
    const PaneCount panes = countPanes(mesh);
    EXPECT_EQ(panes.skylightPanes, 1);
    Sketch sketch = readSketch(HELIODON_TEST_DATA "/geometry/sketches/p05_T_two_rooms.json");
    const Closure closure = closeSketch(sketch);
    const PaneCount of = countPanes(meshBuilding(*closure.building));
    EXPECT_EQ(of.windows, closure.report.windowCount);
    EXPECT_EQ(of.skylightPanes, closure.report.skylightPaneCount);
}
