// Models of which faces look the wrong way: read as if they looked as those about them.
#include "geometry/turned_faces.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/outline_area.h"
#include "geometry/shell_faces.h"
#include "tests/geometry/sheet_drawing.h"

namespace heliodon::geometry {

namespace {

constexpr uint32_t kGlass = 0, kWall = 1;

double sizeOf(const Building& building) {
    EXPECT_EQ(building.roomCount, 1u);
    return volume(meshBuilding(building, {300}));
}

std::vector<SoupFace> cube(dvec3 low, dvec3 size) { // looks in
    std::vector<SoupFace> out;
    for (const auto& [at, u, v] : Drawing::sidesOf(low, size))
        out.push_back({.loops = {{at, at + u, at + u + v, at + v}}, .material = kWall});
    return out;
}

// With a pane somewhere.
size_t turn(std::vector<SoupFace>& faces) {
    faces.push_back({.loops = {{{90, 0, 0}, {90, 1, 0}, {90, 0, 1}}}, .material = kGlass});
    const size_t count = turnAlike(
        faces, [](uint32_t material) { return material == kGlass; }, 1e-5);
    faces.pop_back();
    return count;
}

// Positive where faces look in.
double volumeOf(const std::vector<SoupFace>& faces) {
    double sum = 0;
    for (const SoupFace& face : faces) sum -= glm::dot(face.loops[0][0], areaVector(face.loops[0])) / 6;
    return sum;
}

} // namespace

TEST(TurnedFaces, rooms_of_boxes_with_furniture_turned_at_random) {
    for (uint32_t seed = 0; seed < 4; ++seed) {
        std::mt19937 random(seed);
        Drawing drawing(false);
        drawing.triangles = seed % 2 == 1;
        drawing.turnsFace = [&] { return random() % 2 == 0; };
        solidWalls(drawing);
        solid(drawing, {1, 0, 2}, {2, 2, 3}); // a block on the floor
        const Building made = drawing.read();
        EXPECT_NEAR(sizeOf(made), 50 + 2 * 1.2 * 0.1 - 12, 1e-4) << seed;
        EXPECT_TRUE(std::ranges::any_of(made.repairs, [](const std::string& repair) {
            return repair.ends_with(" faces were turned over");
        })) << seed;
    }
}

TEST(TurnedFaces, a_room_with_a_turned_floor_looks_in) {
    std::vector<SoupFace> faces = cube({0, 0, 0}, {10, 2.5, 10});
    turnOver(faces[0]);
    EXPECT_EQ(turn(faces), 1u);
    EXPECT_NEAR(volumeOf(faces), 250, 1e-9);
}

// Halves of the faces say nothing.
TEST(TurnedFaces, what_is_turned_at_random_looks_out_unless_something_stands_in_it) {
    std::vector<SoupFace> faces = cube({0, 0, 0}, {4, 2.5, 5});
    turnOver(faces[0]), turnOver(faces[2]);
    std::vector<SoupFace> alone = faces;
    EXPECT_EQ(turn(alone), 4u);
    EXPECT_NEAR(volumeOf(alone), -50, 1e-9);
    for (SoupFace& face : cube({1, 0, 1}, {1, 1, 1})) {
        turnOver(face);
        faces.push_back(face);
    }
    EXPECT_EQ(turn(faces), 2u);
    EXPECT_NEAR(volumeOf(faces), 50 - 1, 1e-9);
}

TEST(TurnedFaces, what_looks_one_way_stays_as_drawn) {
    std::vector<SoupFace> faces = cube({0, 0, 0}, {1, 1, 1}); // in
    EXPECT_EQ(turn(faces), 0u);
    EXPECT_NEAR(volumeOf(faces), 1, 1e-9);
}

} // namespace heliodon::geometry
