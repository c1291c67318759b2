#include "geometry/board_rows.h"

#include <algorithm>
#include <array>
#include <map>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "geometry/mesher.h"
#include "tests/geometry/slotted_rooms.h"

using namespace heliodon::geometry;
namespace test = heliodon::test;

namespace {

struct Row {
    int boards = 3;
    double length = 2, depth = 0.2, thick = 0.01, spacing = 0.15; // metres
    double sill = -1;                                             // under the lowest board; negative: none
};

// Faces of a board: its top and its underside first.
void addBoard(Building& building, glm::dvec3 low, glm::dvec3 high) {
    const auto at = [&](int k) {
        return glm::dvec3(k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z);
    };
    for (const std::array<int, 4>& face :
         {std::array{2, 6, 7, 3}, {0, 1, 5, 4}, {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 4, 6, 2}, {1, 3, 7, 5}})
        test::addFace(building, {{at(face[0]), at(face[1]), at(face[2]), at(face[3])}},
                      static_cast<uint32_t>(building.faces.size()), 0);
}

// One over another beside a wall of 4 x 3 m.
Building boardsOf(const Row& row) {
    Building building;
    building.materials.resize(1);
    building.roomCount = 1;
    test::addFace(building, {{{-1, 0, -1}, {3, 0, -1}, {3, 3, -1}, {-1, 3, -1}}}, 0, 0);
    for (int k = 0; k < row.boards; ++k) {
        const double y = 1 + k * row.spacing;
        addBoard(building, {0, y, 0}, {row.length, y + row.thick, row.depth});
    }
    if (row.sill >= 0)
        test::addFace(building,
                      {{{0, 1 - row.sill, 0},
                        {0, 1 - row.sill, row.depth},
                        {row.length, 1 - row.sill, row.depth},
                        {row.length, 1 - row.sill, 0}}},
                      1000, 0);
    return building;
}

// Per face that has any: its rows.
std::map<uint32_t, uint32_t> rowsOf(const Building& building, double edge = 0.3, double triangles = 2000) {
    const std::vector<MeshDomain> domains = findMeshDomains(building, edge);
    const std::vector<uint32_t> rows = boardRows(building, domains, edge, triangles);
    std::map<uint32_t, uint32_t> byFace;
    for (size_t d = 0; d < domains.size(); ++d)
        if (rows[d] > 0) byFace[building.faces[domains[d].faces[0]].surface] = rows[d];
    return byFace;
}

} // namespace

TEST(BoardRows, are_of_boards_that_face_one_another_about_as_near_as_they_are_deep) {
    for (const auto& [surface, rows] : rowsOf(boardsOf({})))
        EXPECT_EQ(rows, (surface - 1) % 6 < 2 ? 6U : 1U) << surface; // the last four are rims
    EXPECT_EQ(rowsOf(boardsOf({})).size(), 18U);
    EXPECT_EQ(rowsOf(boardsOf({.sill = 0.1})).at(1000), 6U);
    EXPECT_EQ(rowsOf(boardsOf({.sill = 0.27})).count(1000), 0U);
    EXPECT_TRUE(rowsOf(boardsOf({.spacing = 0.28})).empty());
    EXPECT_TRUE(rowsOf(boardsOf({.boards = 1})).empty());
    EXPECT_TRUE(rowsOf(boardsOf({.length = 0.7})).empty());
    EXPECT_TRUE(rowsOf(boardsOf({.thick = 0.08})).empty()); // walls
}

TEST(BoardRows, are_as_many_as_the_mesh_has_room_for_and_none_where_it_is_as_fine) {
    EXPECT_EQ(rowsOf(boardsOf({}), 0.3, 250).begin()->second, 3U);
    EXPECT_EQ(rowsOf(boardsOf({}), 0.3, 190).begin()->second, 2U);
    EXPECT_TRUE(rowsOf(boardsOf({}), 0.3, 170).empty()); // with rims they would be over half
    EXPECT_TRUE(rowsOf(boardsOf({}), 0.3, 120).empty());
    EXPECT_TRUE(rowsOf(boardsOf({}), 0.04, 1e5).empty());
}

// As the back of a shelf.
TEST(BoardRows, what_joins_boards_across_more_than_a_third_of_their_depth_is_no_rim) {
    Building building = boardsOf({});
    const auto back = [&](double low, double high) {
        test::addFace(building, {{{0, low, 0}, {2, low, 0}, {2, high, 0}, {0, high, 0}}}, 1000, 0);
        return rowsOf(building).count(1000);
    };
    EXPECT_EQ(back(1.01, 1.15), 0U);
}

// Walls of sketches beside a corridor may be as close.
TEST(BoardRows, are_of_models_alone) {
    const PatchMesh mesh = meshBuilding(boardsOf({.boards = 5}), {800});
    for (size_t i = 0; i < mesh.patchCount(); ++i) EXPECT_EQ(mesh.patch(i).size(), 3U);
}

TEST(BoardRows, make_grids_that_meet_what_lies_beside_them_corner_to_corner) {
    constexpr std::array kAreas{0.4, 0.4, 0.02, 0.02, 0.002, 0.002};
    for (const size_t wanted : {300, 800, 2000}) {
        const PatchMesh mesh = meshBuilding(boardsOf({.boards = 5}), {.triangles = wanted, .ofModel = true});
        std::map<uint32_t, double> areas; // per surface, square metres
        std::map<std::pair<uint32_t, uint32_t>, int> sides;
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            const auto corner = mesh.patch(i);
            if (mesh.surface[i] == 0) continue; // the wall
            EXPECT_EQ(corner.size(), 4U);
            areas[mesh.surface[i]] += patchArea(mesh, i);
            for (size_t k = 0; k < corner.size(); ++k) ++sides[{corner[k], corner[(k + 1) % corner.size()]}];
        }
        EXPECT_EQ(areas.size(), 30U);
        for (const auto& [surface, area] : areas) EXPECT_NEAR(area, kAreas[(surface - 1) % 6], 1e-12);
        for (const auto& [side, count] : sides) {
            EXPECT_EQ(count, 1);
            EXPECT_EQ((sides.count({side.second, side.first})), 1U);
        }
        const auto count = static_cast<double>(wanted);
        EXPECT_NEAR(static_cast<double>(mesh.patchCount()), count, 0.03 * count);
    }
}
