// Screens that are drawn for both sides, each side divided in its own way.
#include <tuple>

#include <gtest/gtest.h>

#include "tests/geometry/sheet_drawing.h"

namespace heliodon::geometry {

TEST(DrawnOnce, screens_whose_sides_are_divided_in_other_ways_are_boards_with_both_materials) {
    const dvec3 a(1.5, 0, 2), b(2.1, 0, 3), up(0, 1.7, 0), c = b + up, d = a + up;
    const auto triangles = [&](Drawing& drawing, const char* material) {
        drawing.face(material, {a, b, c}), drawing.face(material, {a, c, d});
    };
    const auto otherDiagonal = [&](Drawing& drawing) {
        triangles(drawing, "wall");
        drawing.face("paint", {b, a, d}), drawing.face("paint", {b, d, c});
    };
    const auto whole = [&](Drawing& drawing) {
        triangles(drawing, "wall");
        drawing.face("paint", {d, c, b, a});
    };
    const auto halves = [&](Drawing& drawing) {
        triangles(drawing, "wall");
        const dvec3 e = 0.5 * (a + b), f = e + up;
        drawing.face("paint", {d, f, e, a}), drawing.face("paint", {f, c, b, e});
    };
    const auto larger = [&](Drawing& drawing) { // over the one by half
        triangles(drawing, "wall");
        const dvec3 e = 0.5 * (a + b), f = e + up;
        drawing.face("paint", {d, f, e, a});
    };
    for (const auto& [name, draw, painted] :
         {std::tuple<const char*, Sheets, double>{"other diagonal", otherDiagonal, 1},
          {"whole", whole, 1},
          {"halves", halves, 1},
          {"larger", larger, 0.5}}) {
        SCOPED_TRACE(name);
        Drawing drawing(false);
        drawing.room(0, -1, true);
        draw(drawing);
        const Building building = drawing.read();
        EXPECT_EQ(building.roomCount, 1u);
        const double side = glm::length(b - a) * 1.7;
        const PatchMesh mesh = meshBuilding(building, {300});
        EXPECT_NEAR(volume(mesh), 50 - 1e-3 * side, 1e-5);
        double paint = 0;
        for (size_t i = 0; i < mesh.patchCount(); ++i)
            if (mesh.materials[mesh.material[i]].name == "paint")
                paint += 0.5 * glm::length(patchAreaVector(mesh, i));
        EXPECT_NEAR(paint, painted * side, 0.01);
    }
}

// Over the hinge the leaf's upper rim and the lintel's lower one lie on one another for half a millimetre.
TEST(DrawnOnce, partitions_of_sheets_with_an_open_door_are_not_said_to_stand_outside) {
    Drawing drawing(false);
    drawing.room(0, -1, true);
    drawing.twoSided = true;
    const dvec3 up(0, 2.5, 0), door(0, 2.1, 0);
    drawing.sheet({2, 0, 0}, up, {0, 0, 2}), drawing.sheet({2, 0, 3}, up, {0, 0, 2});
    drawing.sheet({2, 2.1, 2}, up - door, {0, 0, 1});
    drawing.sheet({2, 0, 2}, door, {0.7, 0, 0.7}, "paint");
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 1u);
    EXPECT_TRUE(std::ranges::none_of(building.warnings, [](const std::string& warning) {
        return warning.find("stand outside") < warning.npos;
    }));
}

} // namespace heliodon::geometry
