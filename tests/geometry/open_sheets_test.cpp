// Sheets beside a room: outside, or what is left of a room.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/input_error.h"
#include "geometry/space_sheets.h"
#include "tests/geometry/sheet_drawing.h"

namespace heliodon::geometry {

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
            const std::string what = error.what();
            return what.substr(what.find(':')); // after the file
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

TEST(OpenSheets, through_windows_and_for_the_most_part_outside_they_are_refused) {
    const dvec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    for (const auto& [o, u, v] :
         {std::tuple(dvec3(3.3, 0, -10), 14.0 * z, 2.5 * y), // from floor to ceiling
          std::tuple(dvec3(1, 1, -1), 2.0 * x, 1.1 * z),     // as wide as the pane
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
// What closes a hole is not what they lack.
TEST(OpenSheets, a_facade_alone_encloses_no_room) {
    const auto refusal = [](const std::string& without) {
        Drawing drawing(false);
        const auto sides = Drawing::sidesOf({0, 0, 0}, {4, 2.5, 5});
        for (size_t k = 0; k < 6; ++k) // floor, ceiling, left, right, back, front
            if (without.find("fclrbw"[k]) == without.npos) {
                const auto [at, u, v] = sides[k];
                drawing.sheet(at, u, 0.5 * v), drawing.sheet(at + 0.5 * v, u, 0.5 * v);
            }
        try {
            drawing.read();
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    for (const std::string without : {"fclrb", "fclb", "fcrb"})
        EXPECT_NE(refusal(without).find("encloses no room"), std::string::npos)
            << without << refusal(without);
    for (const std::string without : {"c", "f", "cl", "w"})
        EXPECT_NE(refusal(without).find("close the hole"), std::string::npos) << without << refusal(without);
}

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

namespace {

// Without sides by number.
void box(Drawing& drawing, dvec3 o, dvec3 size, const std::vector<int>& without) {
    const auto sides = Drawing::sidesOf(o, size);
    for (int k = 0; k < 6; ++k)
        if (const auto [at, u, v] = sides[static_cast<size_t>(k)];
            std::ranges::find(without, k) == without.end())
            drawing.sheet(at, u, v);
}

bool tellsOfLowSpace(Drawing& drawing) {
    return std::ranges::any_of(drawing.read().warnings, [](const std::string& warning) {
        return warning.starts_with("a low space that lacks its ");
    });
}

} // namespace

// Deep and narrow ones, too. The same without a window on it is a room without its ceiling.
TEST(OpenSheets, courts_are_taken_with_a_word) {
    for (const double height : {2.5, 9.0})
        for (const bool window : {true, false}) {
            Drawing drawing(false);
            drawing.room(0, -1, true);
            drawing.sheet({0, 2.5, 0}, {4, 0, 0}, {0, height - 2.4, 0});
            drawing.sheet({0, 2.5, 5}, {4, 0, 0}, {0, height - 2.4, 0});
            box(drawing, {0, 0, window ? -3.0 : 5.0}, {4, height, 3}, {1, window ? 4 : 5});
            if (!window) {
                EXPECT_THROW(drawing.read(), InputError) << height;
                continue;
            }
            expectOutside(drawing, "court", "6");
            EXPECT_TRUE(std::ranges::any_of(drawing.read().warnings, [](const std::string& warning) {
                return warning.find("lacks its ceiling") != std::string::npos &&
                       warning.find("as a courtyard") != std::string::npos;
            })) << height;
        }
}

// No edge of its floor is open. Before a window it is a court, else one room less in silence.
TEST(OpenSheets, a_room_without_ceiling_or_floor_between_four_others_is_none) {
    for (const bool window : {true, false})
        for (const double level : {0.0, 0.1, 2.5}) {
            Drawing drawing(false);
            drawing.room(0, -1, window);
            for (const double left : {-3.0, 4.0}) box(drawing, {left, 0, -7}, {3, 2.5, 12}, {});
            box(drawing, {0, 0, -7}, {4, 2.5, 3}, {});
            drawing.sheet({0, level, -4}, {0, 0, 4}, {4, 0, 0});
            if (!window || level == 2.5) {
                EXPECT_THROW(drawing.read(), InputError) << level;
                continue;
            }
            const Building building = drawing.read();
            EXPECT_EQ(building.roomCount, 4u);
            EXPECT_TRUE(std::ranges::any_of(building.warnings, [](const std::string& warning) {
                return warning.find("as a courtyard") != std::string::npos;
            })) << level;
        }
}

// By a gallery or by boards: each part is low, together they are a room.
TEST(OpenSheets, a_room_without_a_wall_that_sheets_divide_is_none) {
    const std::vector<std::vector<double>> divided{{0, 1.2, 2.7}, {0, 1.35, 2.7}, {0, 0.7, 1.4, 2.1, 2.7}};
    for (const auto& levels : divided)
        for (const int lower : {3, 4, 5})
            for (const int upper : {3, 5}) {
                Drawing drawing(false);
                drawing.room(0, -1, true);
                for (size_t k = 0; k + 1 < levels.size(); ++k)
                    box(drawing, {6, levels[k], 0}, {4, levels[k + 1] - levels[k], 5},
                        k == 0 ? std::vector{lower} : std::vector{0, upper});
                EXPECT_THROW(drawing.read(), InputError) << levels.size() << ' ' << lower << ' ' << upper;
            }
}

TEST(OpenSheets, low_spaces_that_lack_a_side_are_told) {
    for (const auto& [height, without] : {std::pair(1.1, 5), {1.5, 3}, {1.5, 1}, {1.4, 0}, {2.0, 1}}) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        box(drawing, {6, 0, 0}, {4, height, 5}, {without});
        SCOPED_TRACE(height);
        expectOutside(drawing, "low", "5", false);
        EXPECT_TRUE(tellsOfLowSpace(drawing)) << height << ' ' << without;
    }
    Drawing dormer(false);
    dormer.room(0, -1, true);
    box(dormer, {1, 2.5, 1}, {2, 1.5, 2}, {0, 5});
    EXPECT_TRUE(tellsOfLowSpace(dormer));
    for (const bool hole : {false, true}) { // above it what has no ceiling is closed about
        Drawing drawing(false);
        drawing.room(0, -1, true);
        box(drawing, {6, 0, 0}, {4, 2, 5}, {1, 5});
        for (const double left : {6.0, 9.0}) drawing.sheet({left, 0, 0}, {1, 0, 0}, {0, 2, 0});
        drawing.sheet({7, 1.5, 0}, {2, 0, 0}, {0, 0.5, 0});
        if (!hole) drawing.sheet({7, 0, 0}, {2, 0, 0}, {0, 1.5, 0});
        EXPECT_TRUE(tellsOfLowSpace(drawing)) << hole;
    }
}

// Balustrades, and gardens that are wide or have a gate.
TEST(OpenSheets, terraces_and_gardens_are_not_told_as_rooms) {
    const std::vector<Sheets> cases{[](Drawing& d) {
                                        box(d, {0, 2.5, 0}, {4, 1.1, 5}, {0, 1});
                                    },
                                    [](Drawing& d) { fence(d, 1.8); },
                                    [](Drawing& d) {
                                        ground(d), box(d, {-15, 0, -15}, {34, 1.8, 35}, {0, 1});
                                    },
                                    [](Drawing& d) {
                                        ground(d), box(d, {6, 0, 0}, {4, 1.8, 5}, {0, 1, 5});
                                        for (const double left : {6.0, 8.5})
                                            d.sheet({left, 0, 0}, {1.5, 0, 0}, {0, 1.8, 0});
                                    }};
    for (size_t k = 0; k < cases.size(); ++k) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        cases[k](drawing);
        EXPECT_FALSE(tellsOfLowSpace(drawing)) << k;
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

// Asked again for the same and for faces moved by the least bit, it answers as without a memory.
TEST(SheetMemory, keeps_sheets_of_the_same_faces_alone) {
    std::vector<SoupFace> faces(2);
    faces[0].loops = {{{0, 0, 0}, {0, 0, 4}, {4, 0, 4}, {4, 0, 0}}};
    faces[1].loops = {{{1, 0, 1}, {1, 1, 1}, {3, 1, 1}, {3, 0, 1}}};
    std::vector<SoupFace> moved = faces;
    moved[1].loops[0][2].y = std::nextafter(1.0, 2.0);
    const SheetMemory memory;
    for (int round = 0; round < 2; ++round)
        for (const auto* given : {&faces, &moved}) {
            const std::vector<Sheet> sheets = cutIntoSheets(*given, 1e-6);
            double highest = 0;
            for (const Sheet& sheet : sheets)
                for (const glm::dvec3& p : sheet.loops[0]) highest = std::max(highest, p.y);
            EXPECT_EQ(highest, (*given)[1].loops[0][2].y);
        }
}

// Of what it keeps only the places: materials and numbers are those asked with, tolerances and rooms count.
TEST(WeldMemory, answers_with_what_is_given) {
    std::vector<SoupFace> faces(3);
    faces[0].loops = {{{0, 0, 0}, {0, 0, 0}, {1, 0, 0}}}; // vanishes
    faces[1].loops = {{{0, 0, 0}, {0, 0, 4}, {4, 0, 4}, {4, 0, 0}}};
    faces[2].loops = {{{4 + 1e-4, 0, 0}, {4, 0, 4}, {4, 1, 4}, {4, 1, 0}}};
    const WeldMemory memory;
    for (uint32_t k = 0; k < 4; ++k) {
        for (uint32_t f = 0; f < 3; ++f) faces[f].material = 10 * f + k, faces[f].surface = 100 - 10 * f + k;
        for (const double tolerance : {1e-6, 1e-3})
            for (const uint32_t other : {0u, 1u}) {
                faces[2].room = other;
                const Building welded = weldFaces(faces, 2, tolerance, true);
                ASSERT_EQ(welded.faces.size(), 2u);
                EXPECT_EQ(welded.faces[0].material, 10 + k);
                EXPECT_EQ(welded.faces[1].material, 20 + k);
                EXPECT_EQ(welded.faces[1].surface, 80 + k);
                EXPECT_EQ(welded.faces[1].room, other);
                EXPECT_EQ(welded.vertices.size(), other == 1 ? 9u : tolerance > 1e-4 ? 7u : 8u);
            }
    }
}

} // namespace heliodon::geometry
