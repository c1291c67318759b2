#include "compute/closed_solid.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/compute/rooms.h"

namespace heliodon::compute {
namespace {

using glm::dvec3;

// A room of 4 x 3 x 5 m and solid boxes in it, faces looking outwards.
geometry::PatchMesh roomWith(const std::vector<std::array<dvec3, 2>>& boxes, bool meshed = true) {
    geometry::PatchMesh mesh = test::boxRoom({});
    const size_t room = mesh.corners.size();
    const uint32_t cells = meshed ? 2 : 1;
    for (const auto& [low, high] : boxes)
        test::addBox(mesh, {.low = low, .high = high, .cells = {cells, cells, cells}, .triangles = meshed});
    std::reverse(mesh.corners.begin() + static_cast<long>(room), mesh.corners.end());
    return mesh;
}

bool isClosed(const geometry::PatchMesh& mesh) {
    return isClosedSolid(mesh) && onlyFrontsBlock(mesh);
}

TEST(ClosedSolid, boxes_that_stand_free_in_a_room_leave_it_one) {
    EXPECT_TRUE(isClosed(test::boxRoom({})));
    EXPECT_TRUE(isClosed(roomWith({{{{1, 1, 1}, {2, 2, 2}}}, {{{2.5, 1e-4, 1}, {3, 1, 2}}}})));
}

TEST(ClosedSolid, what_a_box_stands_on_lies_inside_it) {
    EXPECT_FALSE(isClosed(roomWith({{{{1.1, 0, 1.1}, {2, 1, 2}}}}))); // on the floor
    EXPECT_FALSE(
        isClosed(roomWith({{{{1, 1, 1}, {2, 2, 2}}}, {{{1.5, 2, 1.5}, {3, 2.5, 2}}}}))); // on another
}

TEST(ClosedSolid, solids_in_solids_and_solids_that_cross_are_none) {
    EXPECT_FALSE(isClosed(roomWith({{{{1, 1, 1}, {3, 2, 3}}}, {{{1.5, 1.2, 1.5}, {2, 1.5, 2}}}})));
    EXPECT_FALSE(isClosed(roomWith({{{{1, 1, 1}, {2, 2, 2}}}, {{{1.5, 1.5, 1.2}, {3, 2.5, 1.7}}}})));
}

TEST(ClosedSolid, boxes_that_cross_without_an_edge_of_one_in_a_face_of_the_other_are_none) {
    EXPECT_FALSE(isClosed(roomWith({{{{1, 1, 1.4}, {3, 2, 1.6}}}, {{{1.2, 1, 1.3}, {1.4, 2, 2.3}}}}, false)));
    // Pushed into one another, of one width and height: nothing of one crosses the other.
    EXPECT_FALSE(isClosed(roomWith({{{{1, 1, 1}, {2, 2, 3}}}, {{{1, 1, 2}, {2, 2, 4}}}}, false)));
}

// A room with a box on its floor and two that cross: none of them is a solid; two that stand free are.
TEST(ClosedSolid, what_stands_free_is_a_solid_whatever_others_do) {
    geometry::PatchMesh mesh = roomWith({{{{0.5, 0, 0.5}, {1, 1, 1}}},
                                         {{{2, 1, 2}, {3, 2, 3}}},
                                         {{{2.5, 1.5, 2.2}, {3.5, 2.5, 2.7}}},
                                         {{{0.5, 1.5, 4}, {1, 2, 4.5}}},
                                         {{{1.5, 1.5, 4}, {2, 2, 4.5}}}});
    const std::vector<ConvexRegion> regions = blockingRegions(mesh, 8);
    const std::vector<bool> ofSolids = regionsOfSolids(mesh, regions);
    size_t solid = 0;
    for (size_t r = 0; r < regions.size(); ++r) {
        solid += ofSolids[r];
        EXPECT_EQ(ofSolids[r], regions[r].corners[0].z >= 4) << r;
    }
    EXPECT_EQ(solid, 12u);
}

TEST(ClosedSolid, both_sides_of_a_sheet_without_thickness_are_a_solid) {
    std::vector<std::vector<dvec3>> faces{{{1, 1, 1}, {2, 1, 1}, {2, 1.3, 2}, {1, 1.3, 2}}};
    EXPECT_FALSE(isClosed(test::polygons(faces)));
    faces.emplace_back(faces[0].rbegin(), faces[0].rend());
    EXPECT_TRUE(isClosed(test::polygons(faces)));
}

} // namespace
} // namespace heliodon::compute
