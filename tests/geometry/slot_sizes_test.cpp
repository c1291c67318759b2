#include "geometry/slot_sizes.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "geometry/mesher.h"
#include "geometry/necks.h"
#include "tests/geometry/slotted_rooms.h"

using namespace heliodon::geometry;
namespace test = heliodon::test;
using test::SlottedRoom;

namespace {

// Glass 2 m long and 12 cm wide over walls 30 cm deep, one of the long ones in two parts and the other one
// `deep`; corners of the glass from the `first` on, faces in reverse order or not.
SlotSizes slotSizesOfWalls(double deep, size_t first, bool reversed) {
    const std::vector<glm::dvec2> outline{{0, 0}, {2, 0}, {2, 0.12}, {0.5, 0.12}, {0, 0.12}};
    const size_t n = outline.size();
    const auto at = [&](size_t k, double y) { return glm::dvec3(outline[k % n].x, y, outline[k % n].y); };
    Building building;
    building.materials.resize(2);
    building.materials[1].transmittance = glm::vec3(0.88F);
    building.roomCount = 1;
    const auto add = [&](const std::vector<glm::dvec3>& corners, uint32_t material) {
        test::addFace(building, {corners}, static_cast<uint32_t>(building.faces.size()), material);
    };
    std::vector<glm::dvec3> glass;
    for (size_t k = 0; k < n; ++k) glass.push_back(at(first + k, 0));
    add(glass, 1);
    for (size_t k = 0; k < n; ++k) {
        const double low = k == 0 ? -deep : -0.3;
        add({at(k + 1, 0), at(k, 0), at(k, low), at(k + 1, low)}, 0);
    }
    if (reversed) std::ranges::reverse(building.faces);
    const std::vector<MeshDomain> domains = findMeshDomains(building, 0.3);
    const SlotSizes sizes = slotSizes(building, domains, 0.3, 1e6);
    SlotSizes bySurface{std::vector<double>(n + 1), std::vector<std::vector<SizeSource>>(n + 1)};
    for (size_t d = 0; d < domains.size(); ++d) {
        const uint32_t surface = building.faces[domains[d].faces[0]].surface;
        bySurface.longest[surface] = sizes.longest[d], bySurface.parts[surface] = sizes.parts[d];
    }
    return bySurface;
}

size_t trianglesInSlot(const SlottedRoom& room, const PatchMesh& mesh) {
    size_t count = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) count += room.isInSlot(patchCentroid(mesh, i));
    return count;
}

} // namespace

TEST(SlotSizes, depend_on_no_order_and_end_on_larger_walls_where_their_opposite_does) {
    for (size_t first = 0; first < 5; ++first)
        for (const bool reversed : {false, true}) {
            const SlotSizes alike = slotSizesOfWalls(0.3, first, reversed);
            for (const double size : alike.longest) EXPECT_NEAR(size, 0.084, 1e-9);
            for (const auto& part : alike.parts) EXPECT_TRUE(part.empty());
            const SlotSizes sizes = slotSizesOfWalls(3.3, first, reversed);
            for (size_t s = 0; s < sizes.longest.size(); ++s)
                if (s == 1) // most of it faces something else
                    EXPECT_TRUE(std::isinf(sizes.longest[s]));
                else
                    EXPECT_NEAR(sizes.longest[s], 0.084, 1e-9);
            double low = 0, high = -4;
            for (const SizeSource& source : sizes.parts[1])
                low = std::min(low, source.at.y), high = std::max(high, source.at.y);
            EXPECT_NEAR(static_cast<double>(sizes.parts[1].size()), 24 * 4, 12)
                << first; // a source a triangle's edge
            EXPECT_NEAR(high - low, 0.3 - 0.084, 0.02);
        }
}

// Light falls off within the slot's width, which triangles as deep as the slot do not tell.
TEST(SlotSizes, slots_have_small_triangles_and_rooms_keep_most) {
    for (const auto kind : {SlottedRoom::Kind::straight, SlottedRoom::Kind::curved,
                            SlottedRoom::Kind::alongWall, SlottedRoom::Kind::betweenRooms})
        for (const uint32_t seed : {1u, 2u, 3u, 7u, 9u})
            for (const size_t wanted : {600u, 2000u}) {
                const SlottedRoom room(kind, seed);
                const PatchMesh mesh = meshBuilding(room.building, {wanted});
                const auto count = static_cast<double>(wanted),
                           inSlot = static_cast<double>(trianglesInSlot(room, mesh));
                EXPECT_NEAR(static_cast<double>(mesh.patchCount()), count, 0.03 * count) << room.name;
                EXPECT_GT(inSlot, 0.17 * count) << room.name << wanted;
                EXPECT_LT(inSlot, 0.4 * count) << room.name << wanted;
            }
}

TEST(SlotSizes, where_no_light_comes_in_triangles_are_as_large_as_elsewhere) {
    SlottedRoom room(SlottedRoom::Kind::straight, 7);
    room.building.materials[1].transmittance = glm::vec3(0);
    EXPECT_LT(trianglesInSlot(room, meshBuilding(room.building, {2000})), 80);
}

// Two rooms of 3 x 3 m and a way 0.2 m wide and 0.5 m long between them, seen from above.
TEST(Necks, lie_between_rooms_not_in_recesses_nor_beside_walls_that_stand_free) {
    using Loop = std::vector<glm::dvec2>;
    const auto necks = [](const std::vector<Loop>& loops, double widest) {
        MeshDomain domain;
        domain.frames.resize(1), domain.planar = loops;
        return necksOf(domain, widest);
    };
    const Loop rooms{{0, 0},   {3, 0},   {3, 1},     {3.5, 1}, {3.5, 0}, {6.5, 0},
                     {6.5, 3}, {3.5, 3}, {3.5, 1.2}, {3, 1.2}, {3, 3},   {0, 3}};
    const auto found = necks({rooms}, 0.3);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found[0].width, 0.2, 1e-9);
    EXPECT_NEAR(found[0].length, 0.5, 1e-9);
    EXPECT_TRUE(necks({rooms}, 0.19).empty());
    const Loop recess{{0, 0}, {3, 0}, {3, 1}, {3.5, 1}, {3.5, 1.2}, {3, 1.2}, {3, 3}, {0, 3}};
    EXPECT_TRUE(necks({recess}, 0.3).empty());
    const Loop room{{0, 0}, {3, 0}, {3, 3}, {0, 3}};
    EXPECT_TRUE(necks({room, {{0.2, 1}, {0.2, 2}, {0.3, 2}, {0.3, 1}}}, 0.3).empty());
    // A wall that stands in the way parts it in two, neither of which passes all light.
    EXPECT_TRUE(necks({rooms, {{3.1, 1.08}, {3.1, 1.12}, {3.4, 1.12}, {3.4, 1.08}}}, 0.3).empty());
}
