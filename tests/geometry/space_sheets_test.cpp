// Faces that lie on others, cut along one another however sharp the corners are that they make.
#include <gtest/gtest.h>

#include "tests/geometry/sheet_drawing.h"

namespace heliodon::geometry {

// Near the corner that they share, the diagonals of the floor and of the board's underside cross some
// micrometres from the board's edge.
TEST(SpaceSheets, skirtings_of_any_thickness_in_triangles_stand_on_a_floor_in_triangles) {
    for (const double deep : {5.0, 7.51})
        for (const double turned : {0.0, 0.3})
            for (int millimetres = 1; millimetres <= 14; ++millimetres) {
                SCOPED_TRACE(fmt::format("{} mm, {} m deep, turned by {}", millimetres, deep, turned));
                Drawing drawing(false);
                drawing.deep = deep, drawing.turned = turned, drawing.triangles = true;
                drawing.room(0, -1, true);
                const double thick = 1e-3 * millimetres;
                solid(drawing, {4, 0, deep - thick}, {-4, 0.1, thick}, true);
                const Building building = drawing.read();
                EXPECT_EQ(building.roomCount, 1u);
                EXPECT_NEAR(volume(meshBuilding(building, {300})), 10 * deep - 0.4 * thick, 1e-3);
            }
}

} // namespace heliodon::geometry
