// Sensors over the storeys of one room.
#include "engine/app/work_plane.h"

#include <gtest/gtest.h>

#include "geometry/room_measures.h"
#include "tests/geometry/box_model.h"

using namespace heliodon;

TEST(WorkPlane, stands_over_each_storey_from_the_lowest) {
    test::BoxModel model(5);
    model.add({0, 2.5, 0}, {3, 2.8, 3});
    const app::SensorTable table = app::workPlaneSensors(geometry::ownTriangles(model.building()),
                                                         geometry::UpAxis::y, {.spacing = 0.5});
    ASSERT_EQ(table.points.size(), 120u + 36u);
    for (size_t s = 0; s < table.points.size(); ++s)
        EXPECT_NEAR(table.points[s].y, s < 120 ? 0.762 : 2.8 + 0.762, 1e-9);
    EXPECT_NEAR(table.points[120].x, 0.25, 1e-9);
    EXPECT_NEAR(table.points[155].z, 2.75, 1e-9);
}
