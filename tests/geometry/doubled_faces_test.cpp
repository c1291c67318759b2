// Models that have each face for both its sides: read as if they had it once.
#include "geometry/doubled_faces.h"

#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/outline_area.h"
#include "tests/geometry/sheet_drawing.h"

namespace heliodon::geometry {

namespace {

double sizeOf(const Building& building) {
    EXPECT_EQ(building.roomCount, 1u);
    return volume(meshBuilding(building, {300}));
}

} // namespace

TEST(DoubledFaces, rooms_of_boxes_and_of_sheets_with_what_stands_in_them) {
    for (const bool looksIn : {false, true}) { // which of the two sides comes first
        Drawing boxes(looksIn);
        boxes.twoSided = true;
        solidWalls(boxes);
        EXPECT_NEAR(sizeOf(boxes.read()), 50 + 2 * 1.2 * 0.1, 1e-4);
        Drawing sheets(looksIn);
        sheets.twoSided = true;
        sheets.room(0, -1, true);
        solid(sheets, {-0.02, -0.01, 1}, {0.6, 2.01, 0.6}); // a cupboard sunk into wall and floor
        solid(sheets, {1, 0, 2}, {2, 2, 3});                // a block, far from thin, on floor and wall
        EXPECT_NEAR(sizeOf(sheets.read()), 50 - 0.58 * 2 * 0.6 - 12, 1e-4);
    }
}

// Each side has the material that it is drawn with; faces of which the back is lost are turned as the others.
TEST(DoubledFaces, the_side_that_is_seen_stays) {
    std::vector<SoupFace> faces;
    const auto add = [&](std::vector<dvec3> corners, uint32_t material) {
        faces.push_back({.loops = {std::move(corners)},
                         .material = material,
                         .surface = static_cast<uint32_t>(faces.size())});
    };
    const auto cube = [&](dvec3 o, uint32_t in, uint32_t out) { // of 24 faces
        for (const auto& [at, u, v] : Drawing::sidesOf(o, dvec3(1)))
            for (const double a : {0.0, 0.5})
                for (const double b : {0.0, 0.5}) {
                    const dvec3 p = at + a * u + b * v, x = 0.5 * u, y = 0.5 * v;
                    add({p, p + x, p + x + y, p + y}, in);
                    add({p + y, p + x + y, p + x, p}, out);
                }
    };
    cube({0, 0, 0}, 1, 2);
    cube({5, 0, 0}, 1, 2);
    add({{9, 0, 0}, {9, 1, 0}, {9, 0, 1}}, 0); // glass somewhere
    faces.erase(faces.begin() + 1);            // looks out
    EXPECT_EQ(dropDoubledFaces(
                  faces, [](uint32_t material) { return material == 0; }, 1e-5),
              47u);
    ASSERT_EQ(faces.size(), 49u);
    std::multiset<uint32_t> materials;
    double volumes = 0;
    for (const SoupFace& face : faces) {
        materials.insert(face.material);
        if (face.material != 0) volumes += glm::dot(face.loops[0][0], areaVector(face.loops[0])) / 6;
    }
    EXPECT_NEAR(volumes, 2, 1e-9);
    EXPECT_EQ(materials.count(2), 47u);
    EXPECT_EQ(materials.count(1), 1u);
}

// Bodies that touch have faces of one another there; sheets enclose nothing that they could look out of.
TEST(DoubledFaces, what_touches_or_is_open_stays_as_drawn) {
    std::vector<SoupFace> faces;
    const auto add = [&](std::vector<dvec3> corners, uint32_t material) {
        faces.push_back({.loops = {std::move(corners)}, .material = material});
    };
    for (const double x : {0.0, 1.0})
        for (const auto& [at, u, v] : Drawing::sidesOf({x, 0, 0}, dvec3(1)))
            add({at, at + v, at + u + v, at + u}, 1);
    add({{0, 0, 3}, {1, 0, 3}, {1, 1, 3}}, 1);
    add({{1, 1, 3}, {1, 0, 3}, {0, 0, 3}}, 1);
    add({{9, 0, 0}, {9, 1, 0}, {9, 0, 1}}, 0);
    EXPECT_EQ(dropDoubledFaces(
                  faces, [](uint32_t material) { return material == 0; }, 1e-5),
              0u);
    EXPECT_EQ(faces.size(), 15u);
}

} // namespace heliodon::geometry
