// A window in a partition beside an open door: the room runs round it.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/geometry/sheet_drawing.h"

namespace heliodon::geometry {

namespace {

constexpr double kNear = 2.5, kFar = 2.6; // the partition's sides
constexpr double kPartition = 0.1 * (2.5 * 3 - 1.2 * 1.5);

// From x = 1 on, with a hole of 1.5 by 1.2 m.
void partition(Drawing& drawing) {
    for (const auto& [low, high] : {std::pair(dvec3(1, 0, kNear), dvec3(2, 2.5, kFar)),
                                    {{2, 0, kNear}, {3.5, 0.8, kFar}},
                                    {{2, 2, kNear}, {3.5, 2.5, kFar}},
                                    {{3.5, 0, kNear}, {4, 2.5, kFar}}})
        solid(drawing, low, high - low);
}

std::vector<dvec3> pane(double z, double wider = 0) {
    return {{2 - wider, 0.8 - wider, z},
            {3.5 + wider, 0.8 - wider, z},
            {3.5 + wider, 2 + wider, z},
            {2 - wider, 2 + wider, z}};
}

void slab(Drawing& drawing, double z, double wider) {
    const auto one = pane(z - 0.005, wider), other = pane(z + 0.005, wider);
    drawing.face("glass", {one.rbegin(), one.rend()});
    drawing.face("glass", other);
    for (size_t k = 0; k < 4; ++k)
        drawing.face("glass", {one[k], one[(k + 1) % 4], other[(k + 1) % 4], other[k]});
}

// One room, and glass between it and itself.
void expectSeenThrough(Drawing& drawing, const std::string& what) {
    SCOPED_TRACE(what);
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 1u);
    // Less the glass: 1e-4 of the model's extent, which ground makes wider, thick.
    EXPECT_NEAR(volume(meshBuilding(building, {300})), 50 - kPartition, 0.012);
    size_t sides = 0;
    for (size_t f = 0; f < building.faces.size(); ++f) {
        const Face& face = building.faces[f];
        if (face.twin == kNoTwin) continue;
        ++sides;
        EXPECT_EQ(building.faces[static_cast<size_t>(face.twin)].twin, static_cast<int32_t>(f));
        EXPECT_TRUE(building.materials[face.material].isOpening());
    }
    EXPECT_EQ(sides, 2u);
}

} // namespace

TEST(PanesWithinRoom, are_seen_through) {
    for (const bool over : {false, true}) {
        for (const double z : {kNear, 0.5 * (kNear + kFar), kFar}) { // in the wall's faces, too
            Drawing flat(over);
            flat.room(0, -1, true);
            partition(flat);
            flat.face("glass", pane(z));
            expectSeenThrough(flat, fmt::format("flat at {}, {}", z, over));
        }
        for (const double wider : {0.0, 0.05, -0.003}) { // let into the wall; with a joint
            Drawing drawing(over);
            drawing.room(0, -1, true);
            partition(drawing);
            slab(drawing, 0.5 * (kNear + kFar), wider);
            expectSeenThrough(drawing, fmt::format("slab {} wider, {}", wider, over));
        }
    }
}

TEST(PanesWithinRoom, in_triangles_and_beside_the_ground) {
    Drawing drawing(false);
    drawing.room(0, -1, true);
    partition(drawing);
    ground(drawing, -0.1);
    const auto corners = pane(kFar - 0.02);
    drawing.face("glass", {corners[0], corners[1], corners[2]});
    drawing.face("glass", {corners[2], corners[0], corners[3]}); // turned over
    expectSeenThrough(drawing, "triangles");
}

TEST(PanesWithinRoom, with_the_door_closed_part_two_rooms) {
    Drawing drawing(false);
    drawing.room(0, -1, true);
    partition(drawing);
    solid(drawing, {0, 0, kNear}, {1, 2.5, kFar - kNear});
    drawing.face("glass", pane(0.5 * (kNear + kFar)));
    EXPECT_EQ(drawing.read().roomCount, 2u);
}

} // namespace heliodon::geometry
