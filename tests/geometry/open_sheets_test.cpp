// Sheets beside a room of 4 by 5 by 2.5 m with a window at z = 0: outside, or what is left of a room.
#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "geometry/input_error.h"
#include "geometry/mesher.h"
#include "geometry/model_file.h"
#include "tests/geometry/mesh_volume.h"

using namespace heliodon::geometry;
using glm::dvec3;

namespace {

class Drawing {
public:
    double deep = 5; // rooms are

    // All faces turned over: drawn to be seen from outside, as some programs do. In so many units a metre.
    explicit Drawing(bool over, double units = 1) : over_(over), units_(units) {
        std::ofstream(testing::TempDir() + "sheets.mtl")
            << "newmtl wall\nKd .6 .6 .6\nnewmtl paint\nKd .1 .2 .3\nnewmtl glass\nTf .8 .8 .8\nNi 1.52\n";
        out_ << "mtllib sheets.mtl\n";
    }

    void face(const char* material, std::vector<dvec3> corners) {
        if (over_) std::ranges::reverse(corners);
        out_ << "usemtl " << material << '\n';
        for (const dvec3& corner : corners) {
            const dvec3 p = units_ * corner;
            out_ << fmt::format("v {:.9g} {:.9g} {:.9g}\n", p.x, p.y, p.z);
        }
        out_ << "f";
        for (size_t k = 0; k < corners.size(); ++k) out_ << ' ' << next_++;
        out_ << '\n';
    }
    // Looks along u x v.
    void sheet(dvec3 o, dvec3 u, dvec3 v) { face("wall", {o, o + u, o + u + v, o + v}); }

    // Faces that look in, each smaller by `gap` all round, without that of number `without`: floor, ceiling,
    // left, right, back, front.
    void room(double left, int without, bool window, double gap = 0, double base = 0, double sill = 0.8) {
        const dvec3 o(left, base, 0), x(4, 0, 0), y(0, 2.5, 0), z(0, 0, deep);
        const std::array<std::array<dvec3, 3>, 6> sides{
            {{o, z, x}, {o + y, x, z}, {o, y, z}, {o + x, z, y}, {o + z, y, x}, {o, x, y}}};
        for (int k = 0; k < (window ? 5 : 6); ++k) {
            const auto [at, u, v] = sides[static_cast<size_t>(k)];
            const dvec3 du = gap * glm::normalize(u), dv = gap * glm::normalize(v);
            if (k != without) sheet(at + du + dv, u - 2.0 * du, v - 2.0 * dv);
        }
        if (!window) return;
        const std::array<dvec3, 4> wall{o, o + x, o + x + y, o + y},
            pane{o + dvec3(1, sill, 0), o + dvec3(3, sill, 0), o + dvec3(3, 2, 0), o + dvec3(1, 2, 0)};
        for (size_t k = 0; k < 4; ++k) face("wall", {wall[k], wall[(k + 1) % 4], pane[(k + 1) % 4], pane[k]});
        face("glass", {pane.begin(), pane.end()});
    }

    Building read(std::optional<double> worldPerBuilding = {}) {
        std::ofstream(testing::TempDir() + "sheets.obj") << out_.str();
        return importModel(
            testing::TempDir() + "sheets.obj", UpAxis::y, [] {}, worldPerBuilding);
    }

private:
    std::ostringstream out_;
    bool over_;
    double units_;
    int next_ = 1;
};

void ground(Drawing& drawing, double y = 0) {
    drawing.sheet({-20, y, -20}, {0, 0, 45}, {44, 0, 0});
}

// With a gate, on the ground.
void fence(Drawing& drawing, double height) {
    ground(drawing);
    const dvec3 up(0, height, 0), x(1, 0, 0), z(0, 0, 1);
    drawing.sheet({-6, 0, -6}, 16.0 * x, up), drawing.sheet({-6, 0, 11}, 16.0 * x, up);
    drawing.sheet({-6, 0, -6}, 17.0 * z, up);
    drawing.sheet({10, 0, -6}, 7.0 * z, up), drawing.sheet({10, 0, 2}, 9.0 * z, up);
}

void solid(Drawing& drawing, dvec3 o, dvec3 size, bool looksIn = false) {
    const dvec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    for (const auto& [at, u, v] : {std::tuple(o, x, z), std::tuple(o + y, z, x), std::tuple(o, y, x),
                                   std::tuple(o, z, y), std::tuple(o + x, y, z), std::tuple(o + z, x, y)})
        looksIn ? drawing.sheet(at, v, u) : drawing.sheet(at, u, v);
}

void solidGround(Drawing& drawing, bool looksIn = false) { // up to y = 0
    solid(drawing, {-20, -3, -20}, {44, 3, 45}, looksIn);
}

void attic(Drawing& drawing) { // one gable is open
    drawing.sheet({0, 2.5, 0}, {4, 0, 0}, {0, 1.5, 2.5}),
        drawing.sheet({0, 2.5, 5}, {4, 0, 0}, {0, 1.5, -2.5});
    drawing.face("wall", {{0, 2.5, 0}, {0, 2.5, 5}, {0, 4, 2.5}});
}

void expectOutside(Drawing& drawing, const std::string& what, const std::string& count, bool shades = true) {
    SCOPED_TRACE(what);
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 1u);
    EXPECT_NEAR(volume(meshBuilding(building, {300})), 50, 1e-4);
    EXPECT_EQ(building.outside.triangles.empty(), !shades);
    EXPECT_TRUE(std::ranges::any_of(building.warnings, [&](const std::string& warning) {
        return warning.starts_with(count + " open face") &&
               warning.find("stand outside") != std::string::npos;
    }));
}

using Sheets = std::function<void(Drawing&)>;

} // namespace

TEST(OpenSheets, what_stands_outside_is_outside) {
    const dvec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    const Sheets overhang = [&](Drawing& d) { d.sheet({0, 2.5, -1}, 4.0 * x, z); };
    const Sheets tree = [&](Drawing& d) {
        d.sheet({1, 0, -3}, 2.0 * x, 4.0 * y);
        d.sheet({2, 0, -4}, 2.0 * z, 4.0 * y);
    };
    const Sheets parapet = [&](Drawing& d) {
        for (const auto& [o, u] : std::array{std::pair(dvec3(0), 4.0 * x), std::pair(dvec3(0), 5.0 * z),
                                             std::pair(4.0 * x, 5.0 * z), std::pair(5.0 * z, 4.0 * x)})
            d.sheet(o + 2.5 * y, u, y);
    };
    const Sheets canopy = [&](Drawing& d) { // with a border
        d.sheet({0, 2.3, -1.2}, 4.0 * x, z);
        d.sheet({0, 2.1, -1.2}, 4.0 * x, 0.2 * y);
        d.sheet({0, 2.1, -1.2}, z, 0.2 * y);
        d.sheet({4, 2.1, -1.2}, z, 0.2 * y);
    };
    const std::map<std::string, std::tuple<Sheets, std::string, bool>> cases{
        {"an overhang at the top of the wall", {overhang, "1", true}},
        {"one that hangs free",
         {[&](Drawing& d) {
              d.sheet({-1, 2.3, -1}, 6.0 * x, 0.9 * z);
          },
          "1", true}},
        {"the ground", {[](Drawing& d) { ground(d); }, "1", true}},
        {"the ground below", {[](Drawing& d) { ground(d, -0.2); }, "1", true}},
        {"a tree", {tree, "2", true}},
        {"all", {[&](Drawing& d) { overhang(d), tree(d), ground(d); }, "4", true}},
        {"a fin",
         {[&](Drawing& d) {
              d.sheet({3.2, 0, -1}, z, 2.5 * y);
          },
          "1", true}},
        {"a sheet on the wall's outside",
         {[&](Drawing& d) {
              d.sheet({4.02, 1, 1}, z, y);
          },
          "1", false}},
        {"a parapet", {parapet, "4", false}},
        {"a canopy", {canopy, "4", true}}};
    for (const auto& [what, expected] : cases)
        for (const bool over : {false, true}) {
            Drawing drawing(over);
            drawing.room(0, -1, true);
            std::get<0>(expected)(drawing);
            expectOutside(drawing, what, std::get<1>(expected), std::get<2>(expected));
        }
}

// Of a face that bounds a room and goes on, what does goes on outside.
TEST(OpenSheets, eaves_and_the_ground_as_floor_are_cut) {
    Drawing eaves(false);
    eaves.room(0, 1, true);
    eaves.sheet({-1, 2.5, -1}, {6, 0, 0}, {0, 0, 7});
    expectOutside(eaves, "eaves", "1");
    Drawing floor(false);
    ground(floor);
    floor.room(0, 0, true);
    expectOutside(floor, "ground", "1");
}

// What corners are one, and what is flat, the glass says, not what stands around.
TEST(OpenSheets, ground_and_terrain_however_wide_leave_small_parts_of_rooms_as_they_are) {
    const auto twoPanes = [](const Sheets& around) { // 4 mm apart
        Drawing drawing(false);
        drawing.room(0, 5, false);
        for (const auto& [material, from, to] : {std::tuple("wall", dvec3(0, 0, 0), dvec3(4, 0.8, 0)),
                                                 std::tuple("wall", dvec3(0, 2, 0), dvec3(4, 2.5, 0)),
                                                 std::tuple("wall", dvec3(0, 0.8, 0), dvec3(1, 2, 0)),
                                                 std::tuple("glass", dvec3(1, 0.8, 0), dvec3(1.998, 2, 0)),
                                                 std::tuple("wall", dvec3(1.998, 0.8, 0), dvec3(2.002, 2, 0)),
                                                 std::tuple("glass", dvec3(2.002, 0.8, 0), dvec3(3, 2, 0)),
                                                 std::tuple("wall", dvec3(3, 0.8, 0), dvec3(4, 2, 0))})
            drawing.face(material, {from, {from.x, to.y, 0}, to, {to.x, from.y, 0}});
        around(drawing);
        return drawing.read();
    };
    const Building alone = twoPanes([](Drawing&) {});
    const auto isTheSame = [&](const Sheets& around) {
        const Building building = twoPanes(around);
        return building.roomCount == 1 && building.vertices == alone.vertices &&
               std::ranges::equal(building.faces, alone.faces, {}, &Face::loops, &Face::loops);
    };
    EXPECT_TRUE(isTheSame([](Drawing& d) { d.sheet({-1000, 0, -1000}, {0, 0, 2000}, {2000, 0, 0}); }));
    EXPECT_TRUE(isTheSame([](Drawing& d) {
        for (int k = 0; k < 400; ++k) {
            const double x = 200 * (k % 20) - 2000, z = 200 * (k / 20) - 2000;
            d.face("wall", {{x, -1, z}, {x, -1, z + 200}, {x + 200, -1 - k % 3, z}});
        }
    }));
}

// The window looks at it as if it were cut out: what is left of a hill that is higher than the sill is at the
// walls or outside of them.
TEST(OpenSheets, ground_that_runs_on_through_rooms_is_cut_at_their_walls) {
    const auto inRooms = [](Drawing& drawing, dvec3 back) {
        drawing.room(0, -1, true);
        drawing.sheet({-20, 0.3, -20}, {0, 0, 20}, {44, 0, 0});
        drawing.sheet({-20, 0.3, 0}, back, {44, 0, 0});
    };
    for (const double rise : {0.0, 10.0}) { // to 1.3 m at the back wall
        Drawing drawing(false);
        inRooms(drawing, {0, rise, 25});
        const Building building = drawing.read();
        EXPECT_EQ(building.roomCount, 1u);
        EXPECT_NEAR(volume(meshBuilding(building, {300})), 50, 1e-4);
        EXPECT_TRUE(std::ranges::any_of(building.warnings, [](const std::string& warning) {
            return warning.starts_with("the ground (") &&
                   warning.find("in them was left out") != std::string::npos;
        }));
        const std::vector<dvec3>& vertices = building.outside.vertices;
        const std::vector<uint32_t>& triangles = building.outside.triangles;
        for (size_t t = 0; t < triangles.size(); t += 3) {
            const dvec3 middle =
                (vertices[triangles[t]] + vertices[triangles[t + 1]] + vertices[triangles[t + 2]]) / 3.0;
            EXPECT_FALSE(middle.x > 0 && middle.x < 4 && middle.z > 0 && middle.z < 5);
        }
    }
    Drawing storeys(false); // of 6 m: its floor, or the ground
    storeys.room(0, 1, true);
    const dvec3 x(4, 0, 0), y(0, 3.5, 0), z(0, 0, 5), o(0, 2.5, 0);
    for (const auto& [at, u, v] : {std::tuple(o + y, x, z), std::tuple(o, y, z), std::tuple(o + x, z, y),
                                   std::tuple(o + z, y, x), std::tuple(o, x, y)})
        storeys.sheet(at, u, v);
    ground(storeys, 3);
    EXPECT_THROW(storeys.read(), InputError);
}

// What is not deeper than the house may be a hall that was drawn into it.
TEST(OpenSheets, ground_drawn_as_a_solid_is_cut_too) {
    for (const bool overhang : {false, true})
        for (const double deep : {-4.0, 0.0}) {
            Drawing drawing(false);
            drawing.room(0, -1, true);
            const dvec3 o(-20, deep, -20), x(44, 0, 0), y(0, 0.3 - deep, 0), z(0, 0, 45);
            for (const auto& [at, u, v] :
                 {std::tuple(o, x, z), std::tuple(o + y, z, x), std::tuple(o, z, y), std::tuple(o + x, y, z),
                  std::tuple(o, y, x), std::tuple(o + z, x, y)})
                drawing.sheet(at, u, v);
            if (overhang) drawing.sheet({0, 2.5, -1}, {4, 0, 0}, {0, 0, 1});
            if (deep == 0)
                EXPECT_THROW(drawing.read(), InputError);
            else
                expectOutside(drawing, "solid", overhang ? "2" : "1");
        }
}

// As a grid of heights is drawn; one of a room's would make another room.
TEST(OpenSheets, terrain_may_be_of_bent_quads) {
    const auto quads = [](Drawing& drawing, double y) {
        for (int k = 0; k < 100; ++k) {
            const double x = 10 * (k % 10) - 50, z = 10 * (k / 10) - 50, bent = 0.5 * (k % 3);
            drawing.face("wall", {{x, y, z}, {x, y, z + 10}, {x + 10, y - bent, z + 10}, {x + 10, y, z}});
        }
    };
    Drawing terrain(false);
    terrain.room(0, -1, true);
    quads(terrain, -0.5);
    EXPECT_EQ(terrain.read().roomCount, 1u);
    Drawing floor(false);
    floor.room(0, 0, true);
    floor.face("wall", {{0, 0, 0}, {0, 0, 5}, {4, -0.3, 5}, {4, 0, 0}});
    EXPECT_THROW(floor.read(), InputError);
}

TEST(OpenSheets, a_neighbour_without_its_floor_stands_outside) {
    Drawing drawing(false);
    drawing.room(0, -1, true);
    const dvec3 o(0, 0, -10), x(4, 0, 0), y(0, 6, 0), z(0, 0, 4);
    for (const auto& [at, u, v] : {std::tuple(o + y, z, x), std::tuple(o, z, y), std::tuple(o + x, y, z),
                                   std::tuple(o, y, x), std::tuple(o + z, x, y)})
        drawing.sheet(at, u, v);
    expectOutside(drawing, "neighbour", "5");
}

// What of it lies in the solid has that all about it.
TEST(OpenSheets, a_wall_through_a_solid_neighbour_stands_outside) {
    Drawing drawing(false);
    drawing.room(0, -1, true);
    solid(drawing, {-5, 0, -12}, {14, 4, 4});
    drawing.sheet({-5, 0, -10}, {14, 0, 0}, {0, 9, 0});
    expectOutside(drawing, "wall", "1");
}

// Whichever way it is drawn, or for both sides, the one that the window sees hides the sky, once.
TEST(OpenSheets, both_sides_of_them_shade) {
    for (const int drawn : {1, 2, 3}) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        if (drawn & 1) drawing.sheet({0, 2.3, -1}, {0, 0, 0.9}, {4, 0, 0});
        if (drawn & 2) drawing.sheet({0, 2.3, -1}, {4, 0, 0}, {0, 0, 0.9});
        const Occluders outside = drawing.read().outside;
        ASSERT_EQ(outside.triangles.size(), 6u);
        for (size_t t = 0; t < 6; t += 3) {
            const dvec3 a = outside.vertices[outside.triangles[t]];
            EXPECT_LT(glm::cross(outside.vertices[outside.triangles[t + 1]] - a,
                                 outside.vertices[outside.triangles[t + 2]] - a)
                          .y,
                      0);
        }
    }
}

TEST(OpenSheets, each_side_keeps_its_material) {
    const std::vector<dvec3> down{{0, 2.3, -1}, {4, 2.3, -1}, {4, 2.3, -0.1}, {0, 2.3, -0.1}},
        up(down.rbegin(), down.rend());
    for (const int painted : {1, 2, 3}) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        drawing.face(painted & 1 ? "paint" : "wall", down);
        if (painted != 3) drawing.face(painted & 2 ? "paint" : "wall", up);
        const Building building = drawing.read();
        ASSERT_EQ(building.outside.material.size(), 2u); // of those that the window sees, from below
        for (const uint32_t material : building.outside.material)
            EXPECT_EQ(building.materials[material].name, painted & 1 ? "paint" : "wall") << painted;
    }
}

// Of terrain what is below the sill, which is at 0.8 m, is ground, not what hides it; fences stay.
TEST(OpenSheets, slopes_of_terrain_hide_the_sky_alone) {
    const auto lowestOf = [](dvec3 up,
                             int strips = 600) { // of what is before the window, seen from either side
        Drawing drawing(false);
        drawing.room(0, -1, true);
        for (int k = 0; k < strips; ++k)
            drawing.sheet({-5 + 14.0 * k / strips, -1, -2}, {14.0 / strips, 0, 0}, up);
        const Occluders outside = drawing.read().outside;
        double lowest = 1e300;
        for (const uint32_t v : outside.triangles) lowest = std::min(lowest, outside.vertices[v].y);
        return lowest;
    };
    EXPECT_EQ(lowestOf({0, -10, -10}), 1e300); // away from the house
    EXPECT_EQ(lowestOf({0, 1.7, -10}), 1e300);
    EXPECT_NEAR(lowestOf({0, 10, -10}), 0.8, 1e-9);
    EXPECT_NEAR(lowestOf({0, 10, -4}), 0.8, 1e-9);
    EXPECT_EQ(lowestOf({0, 1.5, 0}), -1);
    EXPECT_EQ(lowestOf({0, 1.7, -10}, 1), -1); // few triangles are as bright as they are
    EXPECT_EQ(lowestOf({0, 10, -10}, 1), -1);
}

// Without a ceiling what is no higher than people is no room, and neither is what is low.
TEST(OpenSheets, fences_hedges_and_low_attics_are_no_rooms) {
    const dvec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    const Sheets hedges = [&](Drawing& d) {
        ground(d);
        d.sheet({-9, 0, -6}, 22.0 * x, 1.8 * y), d.sheet({-9, 0, -6.8}, 22.0 * x, 1.8 * y);
    };
    const auto lacksFront = [](Drawing& d, dvec3 o, dvec3 size) { // nor has it a floor
        const dvec3 right(size.x, 0, 0), up(0, size.y, 0), back(0, 0, size.z);
        for (const auto& [at, u, v] : {std::tuple(o + up, back, right), std::tuple(o, back, up),
                                       std::tuple(o + right, up, back), std::tuple(o + back, right, up)})
            d.sheet(at, u, v);
    };
    const Sheets kennel = [&](Drawing& d) { ground(d), lacksFront(d, {1, 0, -4}, {1.2, 1.1, 1.5}); };
    const Sheets dormer = [&](Drawing& d) { lacksFront(d, {1, 2.5, 1}, {2, 1.5, 2}); };
    const std::map<std::string, std::pair<Sheets, std::string>> cases{
        {"fence", {[&](Drawing& d) { fence(d, 1.8); }, "6"}},
        {"hedges", {hedges, "3"}},
        {"kennel", {kennel, "5"}},
        {"dormer", {dormer, "4"}},
        {"attic", {attic, "3"}}};
    for (const auto& [what, expected] : cases) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        expected.first(drawing);
        expectOutside(drawing, what, expected.second, what != "attic" && what != "dormer");
    }
    Drawing yard(false);
    yard.room(0, -1, true);
    fence(yard, 2.3);
    EXPECT_THROW(yard.read(), InputError);
}

// In centimetres, millimetres, feet and inches, at half its size, and on the table, said or not.
TEST(OpenSheets, a_model_in_another_unit_is_the_same_building) {
    const auto bentGround = [](Drawing& d) { // through the room
        for (int k = 0; k < 4; ++k) {
            const double left = k % 2 * 22 - 20, back = k / 2 * 22 - 20;
            d.face("wall", {{left, 0.4, back},
                            {left, 0.4, back + 22},
                            {left + 22, 0.7, back + 22},
                            {left + 22, 0.4, back}});
        }
    };
    const std::map<std::string, Sheets> cases{
        {"garden", [](Drawing& d) { fence(d, 1.8); }},
        {"yard", [](Drawing& d) { fence(d, 2.3); }},
        {"attic", attic},
        {"low garden and bent ground", [&](Drawing& d) {
             d.sheet({-6, 0, -6}, {16, 0, 0}, {0, 1.8, 0}), bentGround(d);
         }}};
    const auto told = [](const Sheets& around, double units, std::optional<double> worldPerBuilding) {
        Drawing drawing(false, units);
        drawing.room(0, -1, true);
        around(drawing);
        try {
            const Building building = drawing.read(worldPerBuilding);
            const double size = volume(meshBuilding(building, {300})) / (units * units * units);
            return fmt::format("{} {:.3f} {}", building.roomCount, size, fmt::join(building.warnings, "; "));
        } catch (const InputError& error) {
            return std::string(error.what());
        }
    };
    for (const auto& [what, around] : cases) {
        const std::string inMetres = told(around, 1, 1);
        EXPECT_EQ(inMetres.starts_with("1 50.000 "), what != "yard") << inMetres;
        for (const double units : {100.0, 1000.0, 1 / 0.3048, 1 / 0.0254, 0.5, 1.0 / 12})
            EXPECT_EQ(told(around, units, units), inMetres) << what << ' ' << units;
        EXPECT_EQ(told(around, 1.0 / 12, {}), inMetres) << what;
        EXPECT_EQ(told(around, 1, {}), inMetres) << what;
    }
}

// A balcony between walls and under a slab: the same without a window behind it is a room without its wall.
TEST(OpenSheets, loggias_are_taken_with_a_word) {
    for (const bool window : {true, false})
        for (const bool parapet : {false, true}) {
            Drawing drawing(false);
            drawing.room(0, -1, true);
            const dvec3 o(0, 0, window ? -1.5 : 5), x(4, 0, 0), y(0, 2.5, 0), z(0, 0, 1.5);
            for (const auto& [at, u, v] :
                 {std::tuple(o, z, x), std::tuple(o + y, x, z), std::tuple(o, y, z), std::tuple(o + x, z, y)})
                drawing.sheet(at, u, v);
            if (parapet) drawing.sheet(window ? o : o + z, x, 0.4 * y);
            if (!window) {
                EXPECT_THROW(drawing.read(), InputError) << parapet;
                continue;
            }
            expectOutside(drawing, "loggia", parapet ? "5" : "4");
            EXPECT_TRUE(std::ranges::any_of(drawing.read().warnings, [](const std::string& warning) {
                return warning.find("as a loggia") != std::string::npos;
            }));
        }
}

TEST(OpenSheets, crowns_of_leaves_enclose_no_room_and_hide_none) {
    for (const bool annex : {false, true}) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        if (annex) drawing.room(6, 1, false);
        std::mt19937 random(1);
        const auto place = [&] { return dvec3(random(), random(), random()) / 2147483648.0 - 1.0; };
        for (int k = 0; k < 1200;) {
            const dvec3 p = place(), u = 0.4 * glm::normalize(place());
            if (glm::length(p) > 1) continue;
            drawing.sheet(dvec3(2, 4, -5) + 2.0 * p, u, 0.6 * glm::cross(u, glm::normalize(place())));
            ++k;
        }
        if (annex)
            EXPECT_THROW(drawing.read(), InputError);
        else
            expectOutside(drawing, "crown", "1200");
    }
}

TEST(OpenSheets, in_rooms_and_through_their_walls_they_are_refused) {
    const dvec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    for (const auto& [o, u, v] :
         {std::tuple(dvec3(3.3, 0, -10), 14.0 * z, 2.5 * y), // from floor to ceiling
          std::tuple(dvec3(1, 1, -1), 2.0 * x, 1.1 * z),     // as wide as the pane
          std::tuple(dvec3(1, 1, 2), x, z), std::tuple(dvec3(1, 0, 2), x, y),
          std::tuple(dvec3(1, 1, 4), x, 3.0 * z), std::tuple(dvec3(-1, 0.3, -1), 7.0 * z, 6.0 * x)})
        for (const bool overhang : {false, true}) {
            Drawing drawing(false);
            drawing.room(0, -1, true);
            drawing.sheet(o, u, v);
            if (overhang) drawing.sheet({0, 2.5, -1}, 4.0 * x, z);
            EXPECT_THROW(drawing.read(), InputError) << o.x << ' ' << o.y << ' ' << o.z;
        }
}

TEST(OpenSheets, a_window_behind_an_outer_skin_without_holes_is_told) {
    Drawing drawing(false);
    drawing.room(0, -1, true);
    const dvec3 o(-0.1, 0, -0.1), x(4.2, 0, 0), y(0, 2.6, 0), z(0, 0, 5.2);
    for (const auto& [at, u, v] : {std::tuple(o, y, x), std::tuple(o, z, y), std::tuple(o + x, y, z),
                                   std::tuple(o + z, x, y), std::tuple(o + y, z, x)})
        drawing.sheet(at, u, v);
    EXPECT_TRUE(std::ranges::any_of(drawing.read().warnings, [](const std::string& warning) {
        return warning.starts_with("1 window (the first at ") &&
               warning.find("looks at nothing but these") != std::string::npos;
    }));
}

// With a window or without, apart or behind a common wall, over the ground or not.
TEST(OpenSheets, a_room_without_one_of_its_walls_is_no_sheet) {
    for (int without = 0; without < 6; ++without)
        for (const double left : {4.0, 6.0})
            for (const bool over : {false, true}) {
                if (left == 4 && without == 2) continue; // drawn for the other room
                Drawing drawing(over);
                drawing.room(0, -1, true);
                drawing.room(left, without, without != 5 && left == 6);
                if (over) ground(drawing, -0.1);
                EXPECT_THROW(drawing.read(), InputError) << without << ' ' << left << ' ' << over;
            }
    Drawing alone(false);
    alone.room(0, 3, true);
    alone.sheet({0, 2.5, -1}, {4, 0, 0}, {0, 0, 1});
    EXPECT_THROW(alone.read(), InputError);
}

// Parts of it are as low as gardens with fences; as a solid the ground is its floor.
TEST(OpenSheets, a_room_without_a_side_that_the_ground_divides_is_no_sheet) {
    const auto isRefused = [](int without, const Sheets& around) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        drawing.room(6, without, false);
        around(drawing);
        try {
            drawing.read();
        } catch (const InputError& error) {
            return std::string(error.what()).find("but for a side") != std::string::npos;
        }
        return false;
    };
    for (int without = 0; without < 6; ++without) {
        EXPECT_TRUE(isRefused(without, [](Drawing& d) { ground(d, 0.6); })) << without;
        EXPECT_TRUE(isRefused(without, [](Drawing& d) { // terrain
            for (int k = 0; k < 8; ++k)
                d.sheet({-20, 0.6 - 0.1 * (k % 2), 6.0 * k - 20}, {0, 0.1 * (k % 2 * 2 - 1), 6}, {44, 0, 0});
        })) << without;
    }
    EXPECT_TRUE(isRefused(3, [](Drawing& d) { d.sheet({6, 2, 0}, {4, 0, 0}, {0, 0, 5}); }));
    EXPECT_TRUE(isRefused(3, [](Drawing& d) { solidGround(d); }));
}

// A garden between walls as high has no ceiling.
TEST(OpenSheets, a_low_room_without_a_wall_is_no_sheet) {
    for (const bool ceiling : {true, false}) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        const dvec3 o(6, 0, 0), x(4, 0, 0), y(0, 2, 0), z(0, 0, 5);
        for (const auto& [at, u, v] :
             {std::tuple(o, z, x), std::tuple(o, y, z), std::tuple(o + x, z, y), std::tuple(o + z, y, x)})
            drawing.sheet(at, u, v);
        if (ceiling) {
            drawing.sheet(o + y, x, z);
            EXPECT_THROW(drawing.read(), InputError);
        } else {
            drawing.sheet(o, x, y);
            expectOutside(drawing, "garden", "5", false);
        }
    }
}

// One beside the other, on a common wall, its floor in the ground on which the other stands: whole.
TEST(OpenSheets, a_closed_room_in_solid_ground_is_not_lost) {
    for (const bool window : {true, false}) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        drawing.room(4, -1, window, 0, -1, 1.2);
        solidGround(drawing);
        const Building building = drawing.read();
        EXPECT_EQ(building.roomCount, 2u) << window;
        EXPECT_NEAR(volume(meshBuilding(building, {300})), 100, 1e-4);
        const auto isGlass = [&](const Face& face) { return building.materials[face.material].isOpening(); };
        EXPECT_EQ(std::ranges::count_if(building.faces, isGlass), window ? 2 : 1);
    }
}

// Also where the faces of a house say less: the floor of an attic looks out of the room below it. Where they
// say that it is air there is a word.
TEST(OpenSheets, solid_ground_that_is_a_floor_is_no_room) {
    for (const bool looksIn : {false, true}) {
        Drawing drawing(false);
        drawing.deep = 10;
        drawing.room(0, 1, true);
        drawing.room(0, -1, false, 0, 2.5);
        solidGround(drawing, looksIn);
        const Building building = drawing.read();
        EXPECT_EQ(building.roomCount, looksIn ? 3u : 2u);
        EXPECT_EQ(std::ranges::any_of(building.warnings,
                                      [](const std::string& warning) {
                                          return warning.find("is it the ground") != std::string::npos;
                                      }),
                  looksIn);
    }
}

// The pane is at 0.8 to 2 m.
TEST(OpenSheets, the_ground_through_glass_is_refused_by_name) {
    for (const double y : {0.6, 0.8, 0.9, 1.9, 2.0}) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        ground(drawing, y);
        std::string fault;
        try {
            drawing.read();
        } catch (const InputError& error) {
            fault = error.what();
        }
        EXPECT_EQ(fault.find("through the glass") != std::string::npos, y > 0.8 && y < 2) << y << fault;
        EXPECT_EQ(fault.empty(), y <= 0.8 || y >= 2) << y << fault;
    }
}

// However much larger than the closed one; three walls of four are a yard.
TEST(OpenSheets, a_hall_without_its_ceiling_is_no_sheet) {
    for (const bool yard : {false, true}) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        const dvec3 o(6, 0, 0), x(20, 0, 0), y(0, 3, 0), z(0, 0, 20);
        for (const auto& [at, u, v] :
             {std::tuple(o, z, x), std::tuple(o, y, z), std::tuple(o + x, z, y), std::tuple(o + z, y, x)})
            drawing.sheet(at, u, v);
        if (yard) {
            expectOutside(drawing, "a yard", "4", false);
            continue;
        }
        drawing.sheet(o, x, y);
        EXPECT_THROW(drawing.read(), InputError);
    }
}

TEST(OpenSheets, a_room_whose_walls_do_not_meet_is_no_sheet) {
    Drawing drawing(false);
    drawing.room(0, -1, true);
    drawing.room(6, -1, false, 0.02);
    EXPECT_THROW(drawing.read(), InputError);
}

// What a room is, neither a hall nor an attic beside it says.
TEST(OpenSheets, high_and_low_rooms_are_no_measure) {
    const auto box = [](Drawing& d, dvec3 o, dvec3 size, bool closed) {
        const dvec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
        for (const auto& [at, u, v] : {std::tuple(o, z, x), std::tuple(o, y, z), std::tuple(o + x, z, y),
                                       std::tuple(o + z, y, x), std::tuple(o, x, y)})
            d.sheet(at, u, v);
        if (closed) d.sheet(o + y, x, z);
    };
    Drawing hall(false);
    box(hall, {0, 0, 0}, {10, 8, 10}, true);
    box(hall, {12, 0, 0}, {3, 2.6, 3}, false);
    EXPECT_THROW(hall.read(), InputError);

    Drawing house(false);
    house.room(0, -1, true);
    box(house, {0, 2.6, 0}, {4, 1.5, 5}, true);
    const dvec3 o(0, 0, -1.2), x(4, 0, 0), y(0, 1, 0), z(0, 0, 1.2); // a balcony and its parapet
    for (const auto& [at, u, v] :
         {std::tuple(o, x, z), std::tuple(o, x, y), std::tuple(o, z, y), std::tuple(o + x, z, y)})
        house.sheet(at, u, v);
    EXPECT_EQ(house.read().roomCount, 2u);
}
