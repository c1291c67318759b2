// Sensors over the storeys of one room.
#include "engine/app/work_plane.h"

#include <gtest/gtest.h>

#include "geometry/room_measures.h"
#include "tests/geometry/box_model.h"

using namespace heliodon;

TEST(WorkPlane, stands_over_pits_and_stages_and_what_is_round_them) {
    test::BoxModel model(4, {1, -1.5, 1}, {3.5, 0, 4});
    model.add({4, 0, 0}, {6, 0.9, 5});
    model.add({0, 0, 0}, {0.6, 0.9, 5}); // a counter
    const app::SensorTable table = app::workPlaneSensors(geometry::ownTriangles(model.building()),
                                                         geometry::UpAxis::y, {.spacing = 0.25});
    size_t inPit = 0;
    for (const glm::dvec3 p : table.points) {
        const bool isPit = p.x > 1 && p.x < 3.5 && p.z > 1 && p.z < 4;
        EXPECT_NEAR(p.y, 0.762 + (isPit ? -1.5 : p.x > 4 ? 0.9 : 0), 1e-9) << p.x << " " << p.z;
        inPit += isPit;
    }
    EXPECT_EQ(inPit, 120u);
    EXPECT_EQ(table.points.size(), 22u * 20u); // none on the counter
}

TEST(WorkPlane, stands_over_each_storey_from_the_lowest) {
    test::BoxModel model(5);
    model.add({0, 2.5, 0}, {3, 2.8, 3});
    model.addStairs(0, 2.8, 0.5, 3.1);
    const app::SensorTable table = app::workPlaneSensors(geometry::ownTriangles(model.building()),
                                                         geometry::UpAxis::y, {.spacing = 0.5});
    ASSERT_GT(table.points.size(), 36u + 110u);
    const size_t lower = table.points.size() - 36; // but for some in the treads
    for (size_t s = 0; s < table.points.size(); ++s)
        EXPECT_NEAR(table.points[s].y, s < lower ? 0.762 : 2.8 + 0.762, 1e-9);
    EXPECT_NEAR(table.points[lower].x, 0.25, 1e-9);
    EXPECT_NEAR(table.points.back().z, 2.75, 1e-9);
}
