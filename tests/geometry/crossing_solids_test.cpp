// Walls drawn as boxes that run into one another: rooms of the volume that is left between them.
#include "geometry/crossing_solids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/input_error.h"
#include "geometry/outline_area.h"
#include "tests/geometry/sheet_drawing.h"

namespace heliodon::geometry {

namespace {

using Box = std::pair<dvec3, dvec3>; // lowest and highest corner

// Turned about the upright through the origin.
void box(Drawing& drawing, const Box& corners, double turn, bool looksIn = false) {
    const auto turned = [&](dvec3 p) {
        return dvec3(std::cos(turn) * p.x + std::sin(turn) * p.z, p.y,
                     std::cos(turn) * p.z - std::sin(turn) * p.x);
    };
    const dvec3 size = corners.second - corners.first, o = turned(corners.first), x = turned({size.x, 0, 0}),
                y(0, size.y, 0), z = turned({0, 0, size.z});
    for (const auto& [at, u, v] : {std::tuple(o, x, z), std::tuple(o + y, z, x), std::tuple(o, y, x),
                                   std::tuple(o, z, y), std::tuple(o + x, y, z), std::tuple(o + z, x, y)})
        looksIn ? drawing.sheet(at, v, u) : drawing.sheet(at, u, v);
}

// Round 4 by 2.5 by 5 m, walls of 0.2 m that run into others by `into`, with a hole for a window at z < 0.
std::vector<Box> walls(double into) {
    const double t = 0.2, e = into;
    return {{{-t, -t, -t}, {4 + t, 0, 5 + t}},      {{-t, 2.5, -t}, {4 + t, 2.5 + t, 5 + t}},
            {{-t, -e, -t}, {0, 2.5 + e, 5 + t}},    {{4, -e, -t}, {4 + t, 2.5 + e, 5 + t}},
            {{-e, -e, 5}, {4 + e, 2.5 + e, 5 + t}}, {{-e, -e, -t}, {1, 2.5 + e, 0}},
            {{3, -e, -t}, {4 + e, 2.5 + e, 0}},     {{1 - e, -e, -t}, {3 + e, 0.8, 0}},
            {{1 - e, 2, -t}, {3 + e, 2.5 + e, 0}}};
}

constexpr double kNiche = 2 * 1.2 * 0.1; // of the window, up to its pane in the middle of the wall

void pane(Drawing& drawing, double turn) {
    const double c = std::cos(turn), s = std::sin(turn);
    const auto at = [&](double x, double y) { return dvec3(c * x - s * 0.1, y, -s * x - c * 0.1); };
    drawing.face("glass", {at(1, 0.8), at(3, 0.8), at(3, 2), at(1, 2)});
}

// The volume of the room, and how many solids it says run into one another.
std::pair<double, std::string> read(const std::vector<Box>& boxes, double turn) {
    Drawing drawing(false);
    for (const Box& one : boxes) box(drawing, one, turn);
    pane(drawing, turn);
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 1u);
    for (const std::string& warning : building.warnings)
        if (const size_t end = warning.find(" solids that run into one another"); end != std::string::npos)
            return {volume(meshBuilding(building, {300})), warning.substr(0, end)};
    return {0, "none: " + (building.warnings.empty() ? "" : building.warnings[0])};
}

} // namespace

TEST(CrossingSolids, walls_that_run_into_one_another_are_one) {
    for (const double into : {0.03, 0.2, 0.25}) // to the other's outside, and beyond
        for (const double turn : {0.0, 0.7}) {
            SCOPED_TRACE(testing::Message() << into << " " << turn);
            const auto [size, count] = read(walls(into), turn);
            EXPECT_EQ(count, "9");
            EXPECT_NEAR(size, 50 + kNiche, 1e-4);
        }
}

TEST(CrossingSolids, what_stands_in_the_room_may_run_into_its_walls_too) {
    std::vector<Box> boxes = walls(0.1);
    boxes.push_back({{1, -0.1, 2}, {1.3, 2.6, 2.3}});   // a column
    boxes.push_back({{3.5, 0.7, 4}, {4.1, 0.75, 5.1}}); // a shelf in a corner
    boxes.push_back({{1.2, 0, 2.1}, {2, 1, 2.2}});      // a board into the column
    for (const double turn : {0.0, 1.1}) {
        const auto [size, count] = read(boxes, turn);
        EXPECT_EQ(count, "12");
        EXPECT_NEAR(size, 50 + kNiche - 0.3 * 0.3 * 2.5 - 0.5 * 0.05 * 1 - 0.7 * 1 * 0.1, 1e-4);
    }
}

// A house whose cavity hangs together with its outside nowhere: the window leads to a second house within.
TEST(CrossingSolids, a_cavity_is_no_part_of_a_solid) {
    std::vector<SoupFace> faces;
    const auto add = [&](const Box& corners, bool looksIn, uint32_t material) {
        const auto [a, b] = corners;
        const dvec3 x(b.x - a.x, 0, 0), y(0, b.y - a.y, 0), z(0, 0, b.z - a.z);
        for (auto [o, u, v] : {std::tuple(a, x, z), std::tuple(a + y, z, x), std::tuple(a, y, x),
                               std::tuple(a, z, y), std::tuple(a + x, y, z), std::tuple(a + z, x, y)}) {
            if (looksIn) std::swap(u, v);
            faces.push_back({.loops = {{o, o + u, o + u + v, o + v}},
                             .material = material,
                             .surface = static_cast<uint32_t>(faces.size())});
        }
    };
    add({dvec3(0), dvec3(10)}, false, 0);
    add({dvec3(1), dvec3(9)}, true, 0);
    add({dvec3(4), dvec3(5)}, false, 0);             // stands free in the cavity
    add({{4.5, 4.2, 4.2}, {6, 4.4, 4.4}}, false, 0); // runs into that
    add({{8, 2, 2}, {12, 3, 3}}, false, 0);          // through the house's wall
    add({dvec3(20), dvec3(21)}, false, 1);           // glass somewhere
    const auto united = uniteSolids(
        faces, [](uint32_t material) { return material == 1; }, Solids::thatCross, 1e-5);
    ASSERT_TRUE(united);
    EXPECT_EQ(united->solids, 4u);
    double volumes = 0;
    for (const SoupFace& face : united->faces)
        for (size_t k = 2; k < face.loops[0].size(); ++k) {
            const auto& loop = face.loops[0];
            volumes += glm::dot(loop[0], glm::cross(loop[k - 1], loop[k])) / 6;
        }
    EXPECT_NEAR(volumes, 1000 - 512 + 1 + 0.04 * 1 + (1 + 2) + 1, 1e-9);
}

// Of a thin board let into a wall, whose corners are rounded: its end's two triangles lie in planes of their
// own, which part by millimetres up the wall.
TEST(CrossingSolids, walls_are_cut_once_along_ends_that_rounding_has_turned) {
    std::vector<SoupFace> faces;
    const auto add = [&](const std::vector<dvec3>& corners) {
        faces.push_back({.loops = {corners}, .surface = static_cast<uint32_t>(faces.size())});
    };
    for (const auto& [o, u, v] : Drawing::sidesOf({-0.2, 0, 0}, {0.2, 3, 5}))
        add({o, o + v, o + u + v, o + u});
    const std::vector<dvec3> corner{
        {-0.1, 1, 1}, {-0.1, 1, 1.002}, {0.5, 1 - 1e-6, 1.002}, {0.5, 1 + 1e-6, 1}};
    const dvec3 along(0, 1.5, 0);
    for (const auto& [a, b, c] : {std::array{0, 2, 1}, {0, 3, 2}}) {
        const auto at = [&](int k) { return corner[static_cast<size_t>(k)]; };
        add({at(a), at(b), at(c)});
        add({at(c) + along, at(b) + along, at(a) + along});
    }
    for (size_t k = 0; k < 4; ++k) {
        const dvec3 a = corner[k], b = corner[(k + 1) % 4];
        add({a, b, b + along, a + along});
    }
    add({{9, 0, 0}, {9, 1, 0}, {9, 0, 1}});
    faces.back().material = 1; // glass somewhere
    const auto united = uniteSolids(
        faces, [](uint32_t material) { return material == 1; }, Solids::thatCross, 2e-5);
    ASSERT_TRUE(united);
    for (const SoupFace& face : united->faces) {
        const auto& loop = face.loops[0];
        if (std::ranges::any_of(loop, [](dvec3 p) { return p.x != 0; })) continue;
        EXPECT_GT(glm::length(areaVector(loop)) / perimeter(loop), 0.1); // no needle of the wall
    }
}

// The corner of one wall is on two edges of a triangle of another, beside the corner in which these meet.
TEST(CrossingSolids, walls_whose_heights_differ_by_less_than_a_millimetre) {
    std::vector<SoupFace> faces;
    const auto add = [&](const std::vector<dvec3>& corners, uint32_t material) {
        faces.push_back(
            {.loops = {corners}, .material = material, .surface = static_cast<uint32_t>(faces.size())});
    };
    const auto inTriangles = [&](dvec3 low, dvec3 high) {
        for (const auto& [o, u, v] : Drawing::sidesOf(low, high - low)) {
            add({o, o + v, o + u + v}, 0);
            add({o, o + u + v, o + u}, 0);
        }
    };
    for (const double lower : {0.0, 8e-5}) {
        faces.clear();
        inTriangles({0, 0, 0}, {2, 3, 0.1});
        inTriangles({2, 0, 0}, {4, 3 - lower, 0.1});
        inTriangles({-1, -1, 0}, {0.1, 1, 0.1});   // runs into the first
        add({{9, 0, 0}, {9, 1, 0}, {9, 0, 1}}, 1); // glass somewhere
        const auto united = uniteSolids(
            faces, [](uint32_t material) { return material == 1; }, Solids::thatMeet, 2e-5);
        ASSERT_TRUE(united);
        EXPECT_EQ(united->solids, 3u) << lower;
    }
}

// The walls that it is let into close without it: it was dropped as what stands outside, and sunlight went
// on.
TEST(CrossingSolids, a_partition_let_into_walls_divides_the_room) {
    std::vector<Box> boxes = walls(0);
    boxes.push_back({{-0.1, -0.1, 2.5}, {4.1, 2.6, 2.6}});
    Drawing drawing(false);
    for (const Box& one : boxes) box(drawing, one, 0);
    pane(drawing, 0);
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 2u);
    EXPECT_NEAR(volume(meshBuilding(building, {300})), 50 + kNiche - 1, 1e-4);
}

// A slab of glass let into walls that touch: the insides of the walls came out as rooms, the slab as two
// panes.
TEST(CrossingSolids, walls_that_touch_are_one_where_they_would_be_rooms) {
    Drawing drawing(false);
    for (const Box& one : walls(0)) box(drawing, one, 0);
    const dvec3 low(0.96, 0.76, -0.11), size(2.08, 1.28, 0.02);
    const dvec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    for (const auto& [o, u, v] :
         {std::tuple(low, x, z), std::tuple(low + y, z, x), std::tuple(low, y, x), std::tuple(low, z, y),
          std::tuple(low + x, y, z), std::tuple(low + z, x, y)})
        drawing.face("glass", {o, o + u, o + u + v, o + v});
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 1u);
    EXPECT_NEAR(volume(meshBuilding(building, {300})), 50 + kNiche, 1e-4);
}

bool warns(const Building& building, const std::string& of) {
    return std::ranges::any_of(building.warnings,
                               [&](const std::string& warning) { return warning.find(of) < warning.npos; });
}

// Of rooms drawn without thickness: legs 1 cm below the floor, what stands 2 cm in walls.
TEST(CrossingSolids, furniture_may_be_sunk_into_the_sheets_of_a_room) {
    struct Case {
        std::vector<Box> boxes;
        double size; // within the room
        const char* through;
        bool muchOutside;
    };
    const Box top{{1, 0.72, 2}, {2.2, 0.75, 2.7}}, leg{{1.1, -0.01, 2.1}, {1.15, 0.73, 2.15}},
        other{{2.1, -0.01, 2.1}, {2.15, 0.72, 2.15}};
    for (const auto& [boxes, size, through, muchOutside] :
         {Case{{{{-0.02, -0.01, 1}, {0.58, 2, 1.6}}}, 0.58 * 2 * 0.6, "1 solid (", false},
          Case{{{{3.5, -0.01, 4.42}, {4.02, 2.6, 5.02}}}, 0.5 * 2.5 * 0.58, "1 solid (", false}, // a corner
          Case{{{{1.2, 0.1, -0.01}, {2.8, 0.7, 0.1}}}, 1.6 * 0.6 * 0.1, "1 solid (", false},
          Case{{{{1, 0.77, -0.05}, {3, 0.8, 0.2}}}, 2 * 0.03 * 0.2, "1 solid (", false}, // under the pane
          Case{{top, leg, other}, 1.2 * 0.7 * 0.03 + 2 * 0.05 * 0.05 * 0.72, "2 solids (", false},
          Case{{{{-2, 0, 1}, {0.3, 1, 1.6}}}, 0.3 * 1 * 0.6, "1 solid (", true}}) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        for (const Box& one : boxes) box(drawing, one, 0);
        const Building building = drawing.read();
        EXPECT_EQ(building.roomCount, 1u);
        EXPECT_NEAR(volume(meshBuilding(building, {300})), 50 - size, 1e-4);
        EXPECT_TRUE(warns(building, through));
        EXPECT_EQ(warns(building, "lies outside of the rooms"), muchOutside);
    }
}

// The block was taken for the ground, as the cupboard is small, and for walls of the room, whose floor has
// its middle under it.
TEST(CrossingSolids, a_block_beside_furniture_is_no_ground_and_no_wall_round_the_room) {
    Drawing drawing(false);
    drawing.room(0, -1, true);
    box(drawing, {{-0.02, -0.01, 1}, {0.58, 2, 1.6}}, 0);
    box(drawing, {{1, 0, 2}, {3, 2, 5}}, 0);
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 1u);
    EXPECT_NEAR(volume(meshBuilding(building, {300})), 50 - 0.58 * 2 * 0.6 - 12, 1e-4);
}

// A wall without thickness between two rooms, and a cupboard that stands in both.
TEST(CrossingSolids, furniture_may_run_through_a_common_wall) {
    Drawing drawing(false);
    drawing.room(0, -1, true);
    drawing.room(4, 2, false); // has the other's right wall
    box(drawing, {{3.5, -0.01, 1}, {4.02, 2, 2}}, 0);
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 2u);
    EXPECT_NEAR(volume(meshBuilding(building, {300})), 100 - 0.52 * 2, 1e-4);
}

// A house of boxes beside a room of sheets, into which one of its walls runs.
TEST(CrossingSolids, what_runs_through_a_wall_may_bound_a_room_outside) {
    Drawing drawing(false);
    drawing.room(0, -1, true);
    for (Box one : walls(0.1)) {
        one.first.x += 4, one.second.x += 4;
        box(drawing, one, 0);
    }
    drawing.face("glass", {{5, 0.8, -0.1}, {7, 0.8, -0.1}, {7, 2, -0.1}, {5, 2, -0.1}});
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 2u);
    EXPECT_NEAR(volume(meshBuilding(building, {300})), 100 + kNiche - 0.2 * 2.5 * 5, 1e-4);
}

// Much larger than the cupboard that is sunk into it, as the ground would be; the pane stands in its wall.
TEST(CrossingSolids, a_house_of_one_piece_is_not_the_ground) {
    Drawing drawing(false);
    const double t = 0.2;
    const std::array<dvec3, 4> in{dvec3(1, 0.8, 0), {3, 0.8, 0}, {3, 2, 0}, {1, 2, 0}};
    for (const double e : {0.0, t}) { // the inner faces, and the outer ones
        const dvec3 o(-e, -e, -e), size(4 + 2 * e, 2.5 + 2 * e, 5 + 2 * e);
        const auto sides = Drawing::sidesOf(o, size);
        for (size_t k = 0; k < 5; ++k) {
            const auto& [at, u, v] = sides[k];
            e > 0 ? drawing.sheet(at, v, u) : drawing.sheet(at, u, v);
        }
        const std::array<dvec3, 4> wall{o, o + dvec3(size.x, 0, 0), o + dvec3(size.x, size.y, 0),
                                        o + dvec3(0, size.y, 0)};
        for (size_t k = 0; k < 4; ++k) {
            const dvec3 a = in[k] - dvec3(0, 0, e), b = in[(k + 1) % 4] - dvec3(0, 0, e);
            std::vector<dvec3> corners{wall[k], wall[(k + 1) % 4], b, a};
            if (e > 0) std::ranges::reverse(corners);
            drawing.face("wall", corners);
        }
    }
    for (size_t k = 0; k < 4; ++k) drawing.sheet(in[k], in[(k + 1) % 4] - in[k], {0, 0, -t});
    pane(drawing, 0);
    box(drawing, {{-0.02, -0.01, 1}, {0.58, 2, 1.6}}, 0);
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 1u);
    EXPECT_NEAR(volume(meshBuilding(building, {300})), 50 + kNiche - 0.58 * 2 * 0.6, 1e-4);
}

// The ends of treads, a little farther out than the flat sides of the column, leave these at small angles.
TEST(CrossingSolids, a_spiral_stair_in_triangles_is_as_in_polygons) {
    const double quarter = 0.5 * 3.141592653589793;
    const auto prism = [](Drawing& drawing, const std::vector<std::pair<double, double>>& polar, double low,
                          double high) {
        std::vector<dvec3> base, top;
        for (const auto& [radius, angle] : polar) {
            base.emplace_back(2 + radius * std::cos(angle), low, 3 + radius * std::sin(angle));
            top.push_back(base.back() + dvec3(0, high - low, 0));
        }
        drawing.face("wall", base), drawing.face("wall", {top.rbegin(), top.rend()});
        for (size_t k = 0; k < base.size(); ++k) {
            const size_t next = (k + 1) % base.size();
            drawing.face("wall", {base[next], base[k], top[k], top[next]});
        }
    };
    for (const double turn : {0.0, 0.1, 0.2, 0.3}) {
        double size[2] = {};
        for (const bool triangles : {false, true}) {
            Drawing drawing(false);
            drawing.triangles = triangles;
            drawing.room(0, -1, true);
            std::vector<std::pair<double, double>> ring;
            for (int k = 0; k < 12; ++k) ring.emplace_back(0.08, k * quarter / 3);
            prism(drawing, ring, 0.1, 2.4);
            for (int k = 0; k < 14; ++k) {
                const double from = turn + k * quarter / 4, to = from + 1.15 * quarter / 4,
                             y = 0.15 * (k + 1);
                prism(drawing, {{0.0784, from}, {1, from}, {1, 0.5 * (from + to)}, {1, to}, {0.0784, to}}, y,
                      y + 0.04);
            }
            size[triangles] = volume(meshBuilding(drawing.read(), {300}));
        }
        EXPECT_NEAR(size[0], size[1], 1e-6) << turn;
        EXPECT_NEAR(size[1], 49.83124, 1e-4);
    }
}

TEST(CrossingSolids, without_glass_they_may_be_rooms) {
    Drawing drawing(false);
    for (const Box& one : walls(0.1)) box(drawing, one, 0);
    EXPECT_THROW(drawing.read(), InputError);
}

} // namespace heliodon::geometry
