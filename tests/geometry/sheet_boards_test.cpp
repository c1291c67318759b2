// Sheets that stand in a room hide and reflect light on both sides: boards of a millimetre.
#include "geometry/sheet_boards.h"

#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "geometry/input_error.h"
#include "geometry/sheet_bodies.h"
#include "tests/geometry/sheet_drawing.h"

namespace heliodon::geometry {

namespace {

struct Read {
    double size = 0;                    // of the air
    std::map<std::string, double> area; // by material
};

Read read(Drawing& drawing) {
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 1u);
    EXPECT_TRUE(std::ranges::any_of(building.warnings, [](const std::string& warning) {
        return warning.find("enclose nothing: taken as boards") < warning.npos;
    }));
    const PatchMesh mesh = meshBuilding(building, {300});
    Read out{volume(mesh), {}};
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        out.area[mesh.materials[mesh.material[i]].name] += 0.5 * glm::length(patchAreaVector(mesh, i));
    return out;
}

// Beside an open door, with a pane.
void partition(Drawing& drawing) {
    const auto part = [&](const char* material, double left, double low, double right, double high) {
        drawing.face(material, {{left, low, 2.5}, {right, low, 2.5}, {right, high, 2.5}, {left, high, 2.5}});
    };
    part("wall", 0, 0, 0.5, 2.5), part("wall", 0.5, 2.1, 1.4, 2.5), part("wall", 1.4, 0, 2, 2.5);
    part("wall", 2, 0, 3.2, 0.9), part("glass", 2, 0.9, 3.2, 2.1), part("wall", 2, 2.1, 3.2, 2.5);
    part("wall", 3.2, 0, 4, 2.5);
}

} // namespace

// What is left of them would be boards, and the room would reach into the wall.
TEST(SheetBoards, walls_that_lack_a_face_and_sheets_a_hair_short_of_a_wall_are_none) {
    const auto withPartition = [](size_t lacking, double height) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        if (lacking == 6)
            drawing.sheet({0, 0, 2.5}, {4, 0, 0}, {0, height, 0});
        else
            for (size_t k = 0; k < 6; ++k) {
                const auto [at, u, v] = Drawing::sidesOf({0, 0, 2.5}, {4, height, 0.2})[k];
                if (k != lacking) drawing.sheet(at, v, u);
            }
        return drawing.read().roomCount;
    };
    EXPECT_EQ(withPartition(6, 2.2), 1u); // clear of the ceiling
    EXPECT_THROW(withPartition(6, 2.498), InputError);
    for (const size_t lacking : {1u, 4u, 5u})
        EXPECT_THROW(withPartition(lacking, 2.2), InputError) << lacking;
}

TEST(SheetBoards, sheets_in_a_room_are_seen_from_both_sides) {
    const dvec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    const double fold = std::hypot(0.2, 0.04);
    const std::map<std::string, std::pair<Sheets, double>> cases{
        // with their area, of one side
        {"a table's top",
         {[&](Drawing& d) {
              d.sheet({1, 0.75, 2}, 0.7 * z, 1.2 * x);
          },
          0.84}},
        {"a screen on the floor",
         {[&](Drawing& d) {
              d.sheet({1, 0, 2.5}, 1.5 * x, 1.8 * y);
          },
          2.7}},
        {"a partition that leaves a way",
         {[&](Drawing& d) {
              d.sheet({0, 0, 2.5}, 2.5 * x, 2.5 * y);
          },
          6.25}},
        {"one through walls",
         {[&](Drawing& d) {
              d.sheet({-0.1, -0.1, 2.5}, 2.6 * x, 2.7 * y);
          },
          6.25}},
        {"screens that cross",
         {[&](Drawing& d) {
              d.sheet({1, 0, 2.5}, 1.5 * x, 1.5 * y), d.sheet({1.75, 0, 1.75}, 1.5 * z, 1.5 * y);
          },
          4.5}},
        {"a bookcase",
         {[&](Drawing& d) {
              d.sheet({1, 0, 1}, 1.8 * y, 0.8 * x), d.sheet({1, 0, 1}, 0.3 * z, 1.8 * y);
              d.sheet({1.8, 0, 1}, 1.8 * y, 0.3 * z), d.sheet({1, 0.9, 1}, 0.3 * z, 0.8 * x);
          },
          1.44 + 2 * 0.54 + 0.24}},
        {"a curtain",
         {[&](Drawing& d) {
              for (int k = 0; k < 10; ++k)
                  d.sheet({1 + 0.2 * k, 0.1, k % 2 ? 0.09 : 0.05}, {0.2, 0, k % 2 ? -0.04 : 0.04}, 2.2 * y);
          },
          22 * fold}}};
    for (const auto& [what, expected] : cases)
        for (const bool over : {false, true}) {
            SCOPED_TRACE(what);
            Drawing drawing(false);
            drawing.room(0, -1, true);
            drawing.twoSided = over;
            expected.first(drawing);
            const auto [size, area] = read(drawing);
            EXPECT_NEAR(size, 50 - 1e-3 * expected.second, 1.5e-5);
            EXPECT_NEAR(area.at("wall"), 2 * 20 + 2 * 12.5 + 2 * 10 - 2.4 + 2 * expected.second, 0.05);
        }
}

// What lies right before a wall lies on it, each side has its material, and nothing is left behind it.
TEST(SheetBoards, posters_and_rugs_lie_on_what_is_behind) {
    Drawing drawing(false);
    drawing.room(0, -1, true);
    drawing.face("paint", {{0.003, 1, 1}, {0.003, 1.8, 1}, {0.003, 1.8, 1.6}, {0.003, 1, 1.6}});
    drawing.face("paint", {{1, 0.001, 1}, {1, 0.001, 2.5}, {3, 0.001, 2.5}, {3, 0.001, 1}});
    const auto [size, area] = read(drawing);
    EXPECT_NEAR(size, 50 - 0.48 * 0.003 - 3 * 0.001, 1e-5);
    EXPECT_NEAR(area.at("paint"), 0.48 + 3 + 2.8 * 0.003 + 7 * 0.001, 1e-3);
    EXPECT_NEAR(area.at("wall"), 85 - 2.4 - 0.48 - 3, 1e-3);
}

// Where they lean, air is left behind them.
TEST(SheetBoards, pictures_on_a_wall_without_thickness_are_not_seen_in_the_next_room) {
    for (const auto& [low, high] : {std::pair(0.005, 0.018), std::pair(0.019, 0.002), std::pair(0.0, 0.015),
                                    std::pair(0.01, 0.01), std::pair(1e-4, 1e-4)}) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        const auto sides = Drawing::sidesOf({4, 0, 0}, {4, 2.5, 5});
        for (const size_t k : {0u, 1u, 3u, 4u, 5u}) drawing.sheet(sides[k][0], sides[k][1], sides[k][2]);
        drawing.face("paint", {{4 - low, 1, 1}, {4 - low, 1, 3}, {4 - high, 2, 3}, {4 - high, 2, 1}});
        const Building building = drawing.read();
        EXPECT_EQ(building.roomCount, 2u);
        const PatchMesh mesh = meshBuilding(building, {300});
        EXPECT_NEAR(volume(mesh), 100 - 2 * (low == high ? low : 1e-3), 1e-4) << low;
        double paint = 0;
        for (size_t i = 0; i < mesh.patchCount(); ++i)
            if (mesh.materials[mesh.material[i]].name == "paint")
                paint += 0.5 * glm::length(patchAreaVector(mesh, i));
        EXPECT_NEAR(paint, low == high ? 2 + 6 * low : 4 + 6e-3, 1e-3) << low; // of a board both sides
    }
}

// Across the diagonal of a wall in two triangles: a sheet, and a body less before it than faces are told
// apart by.
TEST(SheetBoards, nothing_is_left_behind_what_lies_on_walls_of_triangles) {
    for (const bool isBody : {false, true}) {
        Drawing drawing(false);
        drawing.triangles = true;
        drawing.room(0, -1, true);
        drawing.triangles = false;
        if (isBody)
            for (const auto& [at, u, v] : Drawing::sidesOf({1e-6, 0.5, 1.5}, {0.6, 1.5, 2}))
                drawing.face("paint", {at, at + v, at + u + v, at + u});
        else
            drawing.face("paint", {{0.003, 0.5, 1.5}, {0.003, 2, 1.5}, {0.003, 2, 3.5}, {0.003, 0.5, 3.5}});
        const PatchMesh mesh = meshBuilding(drawing.read(), {300});
        std::map<std::string, double> area;
        for (size_t i = 0; i < mesh.patchCount(); ++i)
            area[mesh.materials[mesh.material[i]].name] += 0.5 * glm::length(patchAreaVector(mesh, i));
        const double deep = isBody ? 0.6 : 0.003;
        EXPECT_NEAR(volume(mesh), 50 - 3 * deep, 1e-3) << isBody;
        EXPECT_NEAR(area.at("paint"), 3 + 7 * deep, 1e-3) << isBody;
        EXPECT_NEAR(area.at("wall"), 85 - 2.4 - 3, 1e-3) << isBody;
    }
}

// Nor do gaps between boards and the glass in them, less than a millimetre wide, close.
TEST(SheetBoards, a_partition_with_an_open_door_and_a_pane_has_its_room_on_both_sides) {
    for (const bool triangles : {false, true}) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        drawing.triangles = triangles;
        partition(drawing);
        const auto [size, area] = read(drawing);
        const double pane = 1.2 * 1.2, boards = 10 - 0.9 * 2.1 - pane;
        EXPECT_NEAR(area.at("glass"), 2.4 + 2 * pane, 1e-3);
        EXPECT_NEAR(size, 50 - 1e-3 * boards - 1e-4 * std::sqrt(16 + 25 + 2.5 * 2.5) * pane, 1e-5);
    }
}

// Floors, and ceilings, meet under a partition with an open door, or a part that leaves a way, also where
// others end on it, lower or as high.
TEST(SheetBoards, partitions_may_stand_where_floors_of_two_rooms_meet) {
    for (const auto& [low, high] : {std::pair(0.0, 2.5), std::pair(0.0, 2.3), std::pair(0.1, 2.5)})
        for (const double other : {0.0, 2.2, high}) { // height of one that ends on it, if any
            SCOPED_TRACE(fmt::format("threshold {}, {} high, another {}", low, high, other));
            Drawing drawing(false);
            drawing.turned = other;
            drawing.room(0, 0, true);
            const dvec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), o = 2.5 * z, p(2, 0, 2.5);
            drawing.sheet({0, 0, 0}, 2.5 * z, 4.0 * x, "paint");
            if (other > 0)
                drawing.sheet(o, 2.5 * z, 2.0 * x, "paint"), drawing.sheet(p, 2.5 * z, 2.0 * x, "paint");
            else
                drawing.sheet(o, 2.5 * z, 4.0 * x, "paint");
            const auto at = [&](double right, double up) { return o + right * x + up * y; };
            if (low > 0) { // all round the hole
                const std::vector<dvec3> wall{at(0, 0), at(4, 0), at(4, high), at(0, high)},
                    hole{at(0.5, low), at(1.4, low), at(1.4, 2), at(0.5, 2)};
                for (size_t k = 0; k < 4; ++k)
                    drawing.face("wall", {wall[k], wall[(k + 1) % 4], hole[(k + 1) % 4], hole[k]});
            } else
                drawing.face("wall", {at(0, 0), at(0.5, 0), at(0.5, 2), at(1.4, 2), at(1.4, 0), at(4, 0),
                                      at(4, high), at(0, high)});
            if (other > 0) drawing.face("wall", {p, p + 2.0 * z, p + 2.0 * z + other * y, p + other * y});
            const auto [size, area] = read(drawing);
            EXPECT_NEAR(area.at("paint"), 20, 0.01);
            EXPECT_NEAR(size, 50 - 1e-3 * (4 * high - 0.9 * (2 - low) + 2 * other), 2e-5);
        }
}

// That a body is closed without it, by the one that it lies on, says nothing.
TEST(SheetBoards, faces_of_bodies_drawn_twice_are_none) {
    std::vector<SoupFace> faces;
    for (const auto& [at, u, v] : Drawing::sidesOf({0, 0, 0}, {1, 1, 1})) {
        faces.emplace_back().loops = {{at, at + u, at + u + v, at + v}};
        faces.back().surface = static_cast<uint32_t>(faces.size());
    }
    faces.push_back(faces[3]);
    faces.back().surface = 0;
    EXPECT_TRUE(areOfBody(faces, {0}, 0.5, 1e-6));
}

// Drawn once, for each room, or apart from what stands on above the ceiling of the lower one.
TEST(SheetBoards, walls_between_rooms_of_different_heights_may_have_open_doors) {
    for (const int how : {0, 1, 2})
        for (const double turned : {0.0, 0.4}) {
            SCOPED_TRACE(fmt::format("{}, turned by {}", how, turned));
            Drawing drawing(false);
            drawing.turned = turned;
            drawing.room(0, 3, true);
            const auto sides = Drawing::sidesOf({4, 0, 0}, {3, 3.2, 5});
            for (const size_t k : {0u, 1u, 3u, 4u, 5u}) drawing.sheet(sides[k][0], sides[k][1], sides[k][2]);
            const auto wall = [&](double height) {
                drawing.face("wall", {{4, 0, 0},
                                      {4, 0, 1},
                                      {4, 2, 1},
                                      {4, 2, 1.9},
                                      {4, 0, 1.9},
                                      {4, 0, 5},
                                      {4, height, 5},
                                      {4, height, 0}});
            };
            wall(how == 2 ? 2.5 : 3.2);
            if (how == 1) wall(2.5);
            if (how == 2) drawing.sheet({4, 2.5, 0}, {0, 0, 5}, {0, 0.7, 0});
            EXPECT_NEAR(read(drawing).size, 50 + 48, 0.02);
        }
}

// The body of one lacks its top there; two partitions stand farther from one another.
TEST(SheetBoards, walls_that_lack_a_face_are_none_where_floors_and_walls_meet_under_them) {
    for (const double thick : {0.2, 1.0}) {
        Drawing drawing(false);
        const dvec3 x(4, 0, 0), y(0, 2.5, 0), z(0, 0, 1);
        drawing.deep = 2.5;
        drawing.room(0, 4, true);
        for (const auto& [from, deep] : {std::pair(2.5, thick), std::pair(2.5 + thick, 2.5 - thick)}) {
            const auto sides = Drawing::sidesOf(from * z, {4, 2.5, deep});
            for (size_t k = 0; k < (deep == thick ? 4 : 5); ++k)
                drawing.sheet(sides[k][0], sides[k][1], sides[k][2]);
            drawing.sheet(from * z, x, {0, 2.2, 0});
        }
        if (thick < 0.5)
            EXPECT_THROW(drawing.read(), InputError);
        else
            EXPECT_NEAR(read(drawing).size, 50 - 2 * 8.8e-3, 2e-5);
    }
}

// However near the window of which they hide half.
TEST(SheetBoards, posters_half_over_a_window_hide_that_of_it) {
    for (const bool twoSided : {false, true})
        for (const double gap : {5e-5, 1e-4, 4e-4}) {
            Drawing drawing(false);
            drawing.room(0, -1, true);
            drawing.twoSided = twoSided;
            drawing.face("paint", {{2, 1, gap}, {3.5, 1, gap}, {3.5, 1.4, gap}, {2, 1.4, gap}});
            const auto [size, area] = read(drawing);
            EXPECT_NEAR(size, 50 - 0.6 * gap, 1e-6) << gap;
            EXPECT_NEAR(area.at("paint"), 0.6 + 3.8 * gap, 1e-4) << gap;
            EXPECT_NEAR(area.at("wall") + area.at("glass"), 85 - 0.6, 1e-4) << gap;
            EXPECT_NEAR(area.at("glass"), 2.4 - 0.4, 1e-4) << gap;
        }
}

// Before it by less than faces are told apart by; on its other side the partition is as it was.
TEST(SheetBoards, posters_on_a_partition_are_seen) {
    for (const double gap : {0.0, 1e-5})
        for (const bool over : {false, true}) {
            Drawing drawing(false);
            drawing.room(0, -1, true);
            partition(drawing);
            const double z = 2.5 + gap;
            std::vector<dvec3> poster{{1.5, 1, z}, {1.9, 1, z}, {1.9, 1.6, z}, {1.5, 1.6, z}};
            if (over) std::ranges::reverse(poster);
            drawing.face("paint", poster);
            EXPECT_NEAR(read(drawing).area.at("paint"), 0.24, 1e-4) << gap;
        }
}

// By a tenth of a millimetre and more, and with an edge on the glass.
TEST(SheetBoards, leaning_posters_half_over_a_window_hide_that_of_it) {
    for (const auto& [low, high] : {std::pair(0.0, 3e-4), std::pair(1e-4, 4e-4), std::pair(5e-5, 2.5e-4)}) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        drawing.face("paint", {{0.5, 1, low}, {1.5, 1, low}, {1.5, 1.5, high}, {0.5, 1.5, high}});
        const auto [size, area] = read(drawing);
        EXPECT_NEAR(area.at("paint"), 0.5, 4e-3) << low; // and rims
        EXPECT_NEAR(area.at("wall") + area.at("glass"), 85 - 0.5, 1e-3) << low;
        EXPECT_NEAR(area.at("glass"), 2.4 - 0.25, 1e-3) << low;
    }
    for (const auto& [low, high] : {std::pair(0.0, 2e-4), std::pair(5e-5, 1.5e-4)}) { // nor outside
        Drawing drawing(false);
        drawing.room(0, -1, true);
        drawing.face("paint", {{0.5, 1, low}, {1.5, 1, low}, {1.5, 1.5, high}, {0.5, 1.5, high}});
        EXPECT_THROW(drawing.read(), InputError) << low;
    }
}

// Nor united with walls: with an edge on the floor, from which it leans by 3 %.
TEST(SheetBoards, what_is_not_united_and_seen_all_the_same_is_a_board) {
    Drawing drawing(false);
    drawing.room(0, -1, true);
    drawing.face("paint", {{1, 0, 2}, {2, 0, 2}, {2, 1, 2.03}, {1, 1, 2.03}});
    EXPECT_NEAR(read(drawing).area.at("paint"), 2 * std::hypot(1, 0.03), 5e-3);
}

// The pane would be seen through, and the poster not at all.
TEST(SheetBoards, posters_over_a_pane_in_a_partition_are_not_lost) {
    const auto wrongWith = [](double wider, double gap) -> std::string {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        drawing.object("partition");
        partition(drawing);
        drawing.object("poster");
        const double left = 2 - wider, right = 3.2 + wider, low = 0.9 - wider, high = 2.1 + wider,
                     z = 2.5 + gap;
        drawing.face("paint", {{left, low, z}, {right, low, z}, {right, high, z}, {left, high, z}});
        try {
            drawing.read();
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    const std::string hint = "; --leave-out='poster' does without this object";
    for (const double gap : {3e-5, 1e-4, 3e-4}) {
        const std::string wrong = wrongWith(0.1, gap);
        EXPECT_TRUE(wrong.find("(object \"poster\"): the face lies less than 0.001 m from") < wrong.npos)
            << wrong;
        EXPECT_TRUE(wrong.ends_with(hint)) << wrong;
    }
    for (const double wider : {0.0, -0.1, -0.3}) { // in its plane
        const std::string wrong = wrongWith(wider, 0);
        EXPECT_TRUE(wrong.find("an opening and a wall (") < wrong.npos) << wider << wrong;
        EXPECT_TRUE(wrong.ends_with(hint)) << wrong;
    }
}

// However near: none runs into the wall or is taken to stand outside.
TEST(SheetBoards, decals_a_hair_before_a_wall_draw_no_other_warnings) {
    for (const double gap : {5e-5, 8e-5, 1e-4, 1.3e-4, 2e-4, 1e-3, 3e-3}) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        drawing.face("paint", {{4 - gap, 1, 1}, {4 - gap, 1, 2}, {4 - gap, 1.6, 2}, {4 - gap, 1.6, 1}});
        const Building building = drawing.read();
        const PatchMesh mesh = meshBuilding(building, {300});
        EXPECT_NEAR(volume(mesh), 50 - 0.6 * gap, 1e-6) << gap;
        for (const std::string& warning : building.warnings)
            EXPECT_TRUE(warning.find("taken as boards") < warning.npos ||
                        warning.find("cut out of the room where it stands") < warning.npos)
                << gap << warning;
    }
}

// Where the planes at a corner are one, or many, some of them one.
TEST(SheetBoards, leaning_and_folded_sheets_of_many_faces_are_a_millimetre_thick) {
    const auto thickness = [](dvec3 at, const std::vector<dvec3>& along, const std::vector<dvec3>& across) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        double area = 0;
        for (const dvec3 u : along) {
            dvec3 o = at;
            for (const dvec3 v : across) {
                drawing.sheet(o, u, v);
                area += glm::length(glm::cross(u, v));
                o += v;
            }
            at += u;
        }
        return (50 - read(drawing).size) / area;
    };
    const dvec3 u(0.4, 0.13, 0.27), v(-0.21, 0.37, 0.11);
    const dvec3 up(0.25, 0.12, 0), down(0.25, -0.12, 0), far(0, 0.12, 0.25), on(0, -0.12, 0.25);
    EXPECT_NEAR(thickness({1, 1, 1}, {u}, {v}), 1e-3, 1e-6);
    EXPECT_NEAR(thickness({1, 1, 1}, {u, u}, {v, v}), 1e-3, 1e-6);
    EXPECT_NEAR(thickness({1, 1, 1}, {u, u, 0.7 * u}, {v, v}), 1e-3, 1e-6);
    EXPECT_NEAR(thickness({1, 1, 1}, {up, down, down}, {far, far, on, far}), 1e-3, 1e-5);
    EXPECT_NEAR(thickness({1, 1, 1}, {up, 1.1 * up, down, up}, {far, on, 1.3 * on}), 1e-3, 1e-5);
}

// However little their rims, moved along the sheet's normal, would leave that.
TEST(SheetBoards, leaning_and_flared_sheets_stand_on_floors_and_ceilings_and_lean_on_walls) {
    const auto thickness = [](double turned, double area, const Sheets& sheets) {
        Drawing drawing(false);
        drawing.turned = turned;
        drawing.room(0, -1, true);
        sheets(drawing);
        return (50 - read(drawing).size) / area;
    };
    const dvec3 x(1, 0, 0);
    for (const double turned : {0.0, 0.13})
        for (const double slope : {0.02, 0.05, 0.1, 0.16, 2.0}) {
            SCOPED_TRACE(fmt::format("slope {}, turned by {}", slope, turned));
            const dvec3 up(0, 1, slope), down(0, -1, slope);
            const double high = glm::length(up);
            for (const auto& [at, v] : {std::pair(dvec3(1, 0, 2), up), std::pair(dvec3(1, 2.5, 2), down),
                                        std::pair(dvec3(0, 0, 2), up)}) // the last along a wall, too
                EXPECT_NEAR(thickness(turned, high, [&](Drawing& d) { d.sheet(at, x, v); }), 1e-3, 1e-6);
            for (const double gap : {0.0, 0.01}) { // its foot clear of the wall that it leans on
                const dvec3 at(1, 0, 5 - slope - gap);
                if (slope == 0.02) continue;
                EXPECT_NEAR(thickness(turned, high, [&](Drawing& d) { d.sheet(at, x, up); }), 1e-3, 3e-6);
            }
            const auto shade = [&](Drawing& d) { // of eight sides
                const auto at = [&](int k, double y) {
                    const double angle = 0.25 * std::numbers::pi * k, r = 0.3 + 0.5 * slope * y;
                    return dvec3(2 + r * std::cos(angle), y, 2.5 + r * std::sin(angle));
                };
                for (int k = 0; k < 8; ++k)
                    d.face("wall", {at(k, 0), at(k + 1, 0), at(k + 1, 0.6), at(k, 0.6)});
            };
            const double inner = 0.3 * std::cos(std::numbers::pi / 8),
                         outer = (0.3 + 0.3 * slope) * std::cos(std::numbers::pi / 8),
                         area = 8 * std::tan(std::numbers::pi / 8) * (inner + outer) *
                                std::hypot(0.6, outer - inner);
            EXPECT_NEAR(thickness(turned, area, shade), 1e-3, 5e-6);
        }
}

// Half of the bottom's millimetre is in the floor, or, as that of some without a divider, all.
TEST(SheetBoards, boxes_without_a_lid_stand_on_floors) {
    for (const double divided : {0.0, 0.3})
        for (const bool twoSided : {false, true}) {
            Drawing drawing(false);
            drawing.room(0, -1, true);
            drawing.triangles = twoSided;
            drawing.twoSided = twoSided;
            SCOPED_TRACE(fmt::format("divided at {}, {}", divided, twoSided ? "two-sided" : "one-sided"));
            const dvec3 size(0.6, 0.3, 0.4);
            for (const size_t k : {0u, 2u, 3u, 4u, 5u}) {
                const auto [at, u, v] = Drawing::sidesOf({1, 0, 2}, size)[k];
                drawing.face("paint", {at, at + v, at + u + v, at + u});
            }
            if (divided > 0) drawing.sheet({1 + divided, 0, 2}, {0, 0, 0.4}, {0, 0.3, 0});
            const auto [air, area] = read(drawing);
            const double sides = 2 * 0.3 * (0.6 + 0.4), divider = divided > 0 ? 0.3 * 0.4 : 0;
            EXPECT_NEAR(air, 50 - 1e-3 * (sides + divider + 0.25 * 0.24), 6.2e-5);
            EXPECT_NEAR(area.at("paint"), 2 * sides + 0.24, 4e-3);
            EXPECT_NEAR(area.at("wall"), 85 - 2.4 - 0.24 + 2 * divider, 4e-3);
        }
}

// In the planes of the lower one's sides.
TEST(SheetBoards, boxes_without_a_lid_stand_on_one_another) {
    for (const bool triangles : {false, true}) {
        Drawing drawing(false);
        drawing.room(0, -1, true);
        drawing.triangles = triangles;
        for (const double low : {0.0, 0.3})
            for (const size_t k : {0u, 2u, 3u, 4u, 5u}) {
                const auto [at, u, v] = Drawing::sidesOf({1, low, 2}, {0.6, 0.3, 0.6})[k];
                drawing.face("paint", {at, at + v, at + u + v, at + u});
            }
        EXPECT_NEAR(read(drawing).size, 50 - 0.6 * 0.6 * 0.3 - 1e-3 * 4 * 0.6 * 0.3, 1e-5) << triangles;
    }
}

TEST(SheetBoards, each_side_has_its_material) {
    Drawing drawing(false);
    drawing.room(0, -1, true);
    const std::vector<dvec3> down{{1, 0.75, 2}, {2, 0.75, 2}, {2, 0.75, 3}, {1, 0.75, 3}};
    drawing.face("paint", down);
    drawing.face("wall", {down.rbegin(), down.rend()});
    EXPECT_NEAR(read(drawing).area.at("paint"), 1, 0.005);
}

} // namespace heliodon::geometry
