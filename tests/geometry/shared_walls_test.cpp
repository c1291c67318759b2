// Rooms whose common walls have no thickness, as models often come.
#include <algorithm>
#include <fstream>
#include <map>
#include <tuple>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "geometry/input_error.h"
#include "geometry/mesh_domains.h"
#include "geometry/mesher.h"
#include "geometry/model_file.h"
#include "tests/geometry/mesh_volume.h"

using namespace heliodon::geometry;
using glm::dvec3;

namespace {

struct Drawn {
    std::vector<dvec3> corners;
    std::string material;
};
using Model = std::vector<Drawn>;

// A rectangle that looks along u x v, a window cut out of its middle third if `window` names one.
void rectangle(Model& model, dvec3 o, dvec3 u, dvec3 v, const std::string& wall,
               const std::string& window = "") {
    const auto at = [&](double a, double b) { return o + a * u + b * v; };
    if (window.empty()) {
        model.push_back({{at(0, 0), at(1, 0), at(1, 1), at(0, 1)}, wall});
        return;
    }
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            model.push_back({{at(i / 3.0, j / 3.0), at((i + 1) / 3.0, j / 3.0),
                              at((i + 1) / 3.0, (j + 1) / 3.0), at(i / 3.0, (j + 1) / 3.0)},
                             i == 1 && j == 1 ? window : wall});
}

// Normals inwards; `at0` and `at1`: windows in the walls at low.z and high.z.
void box(Model& model, dvec3 low, dvec3 high, const std::string& wall, const std::string& at0 = "",
         const std::string& at1 = "") {
    const dvec3 d = high - low, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
    rectangle(model, low, z, x, wall);
    rectangle(model, low + y, x, z, wall);
    rectangle(model, low, y, z, wall);
    rectangle(model, low + x, z, y, wall);
    rectangle(model, low, x, y, wall, at0);
    rectangle(model, low + z, y, x, wall, at1);
}

// Two rooms side by side at z = 4, the second one as wide as `width`.
Model twoRooms(double width, const std::string& pane = "") {
    Model model;
    box(model, {0, 0, 0}, {5, 3, 4}, "A", "", pane);
    box(model, {0, 0, 4}, {width, 3, 9}, "B", pane);
    return model;
}

Building imported(const Model& model) {
    const std::string stem = testing::TempDir() + "shared";
    std::ofstream(stem + ".mtl")
        << "newmtl A\nKd .7 .7 .7\nnewmtl B\nKd .2 .3 .4\nnewmtl glass\nTf .8 .8 .8\n"
           "Ni 1.52\n";
    std::ofstream out(stem + ".obj");
    out << "mtllib shared.mtl\n";
    size_t n = 0;
    for (const Drawn& face : model) {
        out << "usemtl " << face.material << '\n';
        for (const dvec3& p : face.corners) out << fmt::format("v {:.9g} {:.9g} {:.9g}\n", p.x, p.y, p.z);
        out << "f";
        for (size_t k = 0; k < face.corners.size(); ++k) out << ' ' << ++n;
        out << '\n';
    }
    out.close();
    return importModel(stem + ".obj", UpAxis::y);
}

std::vector<double> volumes(const Building& building) {
    std::vector<double> out(building.roomCount, 0);
    const PatchMesh mesh = meshBuilding(building, {500});
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        out[mesh.room[i]] -= glm::dot(patchCentroid(mesh, i), patchAreaVector(mesh, i)) / 6;
    std::ranges::sort(out);
    return out;
}

void expectVolumes(const Building& building, const std::vector<double>& wanted) {
    const std::vector<double> found = volumes(building);
    ASSERT_EQ(found.size(), wanted.size());
    for (size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], wanted[k], 1e-6 * wanted[k]);
}

// Area of the faces in z = 4 by the way they look and their material.
std::map<std::pair<int, std::string>, double> sharedArea(const Building& building) {
    std::map<std::pair<int, std::string>, double> out;
    const PatchMesh mesh = meshBuilding(building, {500});
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        if (std::abs(patchCentroid(mesh, i).z - 4) < 1e-6 && std::abs(patchNormal(mesh, i).z) > 0.5)
            out[{patchNormal(mesh, i).z > 0 ? 1 : -1, mesh.materials[mesh.material[i]].name}] +=
                patchArea(mesh, i);
    return out;
}

void reverse(Model& model) {
    for (Drawn& face : model) std::ranges::reverse(face.corners);
}

TEST(SharedWalls, each_room_gets_the_side_that_was_drawn_for_it) {
    for (const double width : {5.0, 3.0, 8.0})
        for (const bool outwards : {false, true}) {
            Model model = twoRooms(width);
            if (outwards) reverse(model);
            const Building building = imported(model);
            std::vector<double> wanted{60, 15 * width};
            std::ranges::sort(wanted);
            expectVolumes(building, wanted);
            auto area = sharedArea(building);
            EXPECT_NEAR((area[{-1, "A"}]), 15, 1e-6) << width << outwards;
            EXPECT_NEAR((area[{1, "B"}]), 3 * width, 1e-6) << width << outwards;
            EXPECT_EQ(area.size(), 2u);
        }
}

// Both look the same way then: the file has each among the others of its room.
TEST(SharedWalls, each_room_gets_its_side_where_one_is_turned_over) {
    for (const char* turned : {"A", "B"})
        for (const bool outwards : {false, true}) {
            Model model = twoRooms(5);
            if (outwards) reverse(model);
            for (Drawn& face : model)
                if (face.material == turned &&
                    std::ranges::all_of(face.corners, [](dvec3 p) { return p.z == 4; }))
                    std::ranges::reverse(face.corners);
            const Building building = imported(model);
            expectVolumes(building, {60, 75});
            auto area = sharedArea(building);
            EXPECT_NEAR((area[{-1, "A"}]), 15, 1e-6) << turned << outwards;
            EXPECT_NEAR((area[{1, "B"}]), 15, 1e-6) << turned << outwards;
            EXPECT_TRUE(std::ranges::any_of(building.warnings, [](const std::string& warning) {
                return warning.find("look the same way") != std::string::npos;
            }));
        }
}

TEST(SharedWalls, a_sheet_drawn_once_is_seen_by_both) {
    Model model = twoRooms(5);
    std::erase_if(model, [](const Drawn& face) {
        return face.material == "B" && std::ranges::all_of(face.corners, [](dvec3 p) { return p.z == 4; });
    });
    const Building building = imported(model);
    expectVolumes(building, {60, 75});
    auto area = sharedArea(building);
    EXPECT_NEAR((area[{-1, "A"}]), 15, 1e-6);
    EXPECT_NEAR((area[{1, "A"}]), 15, 1e-6);
}

TEST(SharedWalls, glass_in_them_is_an_interior_window) {
    const Building building = imported(twoRooms(5, "glass"));
    expectVolumes(building, {60, 75});
    const PatchMesh mesh = meshBuilding(building, {500});
    double area = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        if (mesh.materials[mesh.material[i]].isOpening()) {
            ASSERT_NE(mesh.twin[i], kNoTwin);
            const auto twin = static_cast<size_t>(mesh.twin[i]);
            EXPECT_NE(mesh.room[i], mesh.room[twin]);
            EXPECT_LT(glm::length(patchCentroid(mesh, i) - patchCentroid(mesh, twin)), 1e-6);
            area += patchArea(mesh, i);
        }
    EXPECT_NEAR(area, 2 * 15 / 9.0, 1e-6);
}

TEST(SharedWalls, four_rooms_meet_in_a_line_and_one_holds_a_box) {
    Model model;
    for (const double x : {0.0, 4.0})
        for (const double z : {0.0, 5.0}) box(model, {x, 0, z}, {x + 4, 3, z + 5}, "A");
    Model solid;
    box(solid, {1, 1, 1}, {2, 2, 2}, "B");
    reverse(solid);
    model.insert(model.end(), solid.begin(), solid.end());
    expectVolumes(imported(model), {59, 60, 60, 60});
}

TEST(SharedWalls, a_room_over_two_others) {
    Model model = twoRooms(5);
    box(model, {0, 3, 0}, {5, 6, 9}, "A");
    expectVolumes(imported(model), {60, 75, 135});
}

TEST(SharedWalls, glass_on_an_uncut_wall_and_holes_are_refused) {
    Model model;
    box(model, {0, 0, 0}, {5, 3, 4}, "A", "", "glass");
    box(model, {0, 0, 4}, {5, 3, 9}, "B");
    EXPECT_THROW(imported(model), InputError);
    model = twoRooms(5);
    model.erase(model.begin() + 2);
    EXPECT_THROW(imported(model), InputError);
}

TEST(SharedWalls, equal_windows_in_a_row_are_twins_of_those_opposite) {
    Model model; // a wall of 0.1 with two windows on each side, drawn in opposite order
    for (int k = 0; k < 2; ++k) {
        box(model, {5.0 * k, 0, 0}, {5.0 * k + 4.9, 3, 4}, "A", "", "glass");
        box(model, {5.0 - 5.0 * k, 0, 4.1}, {9.9 - 5.0 * k, 3, 9}, "B", "glass");
    }
    const Building building = imported(model);
    size_t twins = 0;
    for (const Face& face : building.faces)
        if (face.twin >= 0) {
            const Face& other = building.faces[static_cast<size_t>(face.twin)];
            EXPECT_LT(glm::length(building.vertices[face.loops[0][0]] - building.vertices[other.loops[0][0]]),
                      2.5);
            ++twins;
        }
    EXPECT_EQ(twins, 4u);
}

size_t twinsIn(const Building& building) {
    return static_cast<size_t>(
        std::ranges::count_if(building.faces, [](const Face& face) { return face.twin >= 0; }));
}

TEST(SharedWalls, equal_windows_across_a_yard_are_no_twins) {
    for (const double unit : {1.0, 1 / 0.3048, 1000.0})                    // of a file in metres, feet, mm
        for (const double yard : {0.1, 0.2032, 0.4, 0.7, 1.0, 2.0, 3.0}) { // of a building of 60 m
            Model model;
            box(model, {0, 0, 0}, {60, 3, 10}, "A", "", "glass");
            box(model, {0, 0, 10 + yard}, {60, 3, 20}, "B", "glass");
            box(model, {0, 3.3, 0}, {60, 9, 20}, "B"); // another floor makes no wall thicker
            for (Drawn& face : model)
                for (dvec3& p : face.corners) p *= unit;
            EXPECT_EQ(twinsIn(imported(model)), yard < 0.9 ? 2u : 0u) << yard << ' ' << unit;
        }
}

// Windows of 2 by 1 m in a wall of 0.2 m, one of them moved along it: what falls beside it would be lost.
TEST(SharedWalls, equal_windows_that_overlap_in_part_are_refused) {
    for (const double aside : {0.0, 0.1, 0.3, 0.9}) {
        Model model;
        box(model, {0, 0, 0}, {6, 3, 4}, "A", "", "glass");
        box(model, {aside, 0, 4.2}, {6 + aside, 3, 9}, "B", "glass");
        if (aside < 0.2) {
            EXPECT_EQ(twinsIn(imported(model)), 2u) << aside;
        } else {
            EXPECT_THROW(imported(model), InputError) << aside;
        }
    }
}

// A box without some of its faces, named by the wall: b(ottom), t(op), w, e (low and high x), n, s (low and
// high z).
Model part(dvec3 low, dvec3 high, const std::string& without, bool outwards = false) {
    Model model;
    box(model, low, high, "B");
    Model out;
    for (size_t k = 0; k < model.size(); ++k)
        if (without.find("btwens"[k]) == std::string::npos) out.push_back(model[k]);
    if (outwards) reverse(out);
    return out;
}

// A hall of 240 m3 with other things in it or beside it.
Model hall(const std::vector<Model>& others, bool outwards = false) {
    Model model;
    box(model, {0, 0, 0}, {10, 3, 8}, "A");
    if (outwards) reverse(model);
    for (const Model& other : others) model.insert(model.end(), other.begin(), other.end());
    return model;
}

void expectWarning(const Building& building, const std::string& text) {
    std::string all;
    for (const std::string& warning : building.warnings) all += warning + "; ";
    EXPECT_NE(all.find(text), std::string::npos) << all;
    EXPECT_EQ(all.empty(), text.empty()) << all;
}

TEST(SharedWalls, a_room_beside_the_middle_of_a_wall_stays_a_room) {
    for (const bool hallOutwards : {false, true})
        for (const bool outwards : {false, true})
            for (const std::string without :
                 {"", "s"}) // the common wall drawn for both, or for the hall only
                for (const double floor : {0.0, 0.5}) {
                    const Building building =
                        imported(hall({part({4, floor, -2}, {6, 2.5, 0}, without, outwards)}, hallOutwards));
                    expectVolumes(building, {4 * (2.5 - floor), 240});
                    expectWarning(building,
                                  outwards && !hallOutwards ? "though its faces look out of it" : "");
                }
}

TEST(SharedWalls, walls_drawn_once_divide_what_they_end_on) {
    Model across;
    rectangle(across, {4, 0, 0}, {0, 3, 0}, {0, 0, 8}, "B");
    expectVolumes(imported(hall({across})), {96, 144});
    Model corner; // one of the two turned over
    rectangle(corner, {4, 0, 0}, {0, 3, 0}, {0, 0, 5}, "B");
    rectangle(corner, {0, 0, 5}, {0, 3, 0}, {4, 0, 0}, "B");
    expectVolumes(imported(hall({corner})), {60, 180});
    Model floor;
    rectangle(floor, {0, 1.2, 0}, {0, 0, 8}, {10, 0, 0}, "B");
    expectVolumes(imported(hall({floor})), {96, 144});
    Model screen; // does not reach the wall: a board
    rectangle(screen, {4, 0, 1}, {0, 3, 0}, {0, 0, 7}, "B");
    EXPECT_EQ(imported(hall({screen})).roomCount, 1u);
    // A room in the hall whose back is the hall's wall, under a ceiling of its own and the hall's.
    expectVolumes(imported(hall({part({4, 0, 0}, {6, 2.4, 2}, "bn")})), {9.6, 230.4});
    expectVolumes(imported(hall({part({4, 0, 0}, {6, 3, 2}, "btn")})), {12, 228});
}

TEST(SharedWalls, rooms_may_overlap_in_half_a_wall) {
    Model model;
    box(model, {0, 0, 0}, {4, 3, 4}, "A");
    box(model, {4, 1, 2}, {8, 4, 6}, "B");
    expectVolumes(imported(model), {48, 48});
    reverse(model);
    expectVolumes(imported(model), {48, 48});
}

TEST(SharedWalls, columns_and_blocks_are_solid_and_said_to_be) {
    for (const bool hallOutwards : {false, true})
        for (const std::string without : {"", "bt"}) {
            const Building building =
                imported(hall({part({4, 0, 3}, {4.4, 3, 3.4}, without, true)}, hallOutwards));
            expectVolumes(building, {240 - 0.48});
            expectWarning(building, "1 solid was cut out");
        }
    // A block that looks inwards as the hall does is a room in it, a column is none.
    const Building block = imported(hall({part({4, 0, 3}, {6, 2.4, 5}, "b")}));
    expectVolumes(block, {9.6, 230.4});
    expectWarning(block, "1 space within a room was taken as a room of its own");
    const Building column = imported(hall({part({4, 0, 3}, {4.4, 3, 3.4}, "bt")}));
    expectVolumes(column, {240 - 0.48});
    expectWarning(column, "1 solid was cut out");
}

TEST(SharedWalls, tables_stacks_and_rows_of_cupboards_are_solid) {
    std::vector<Model> table{part({1, 0.7, 1}, {2, 0.75, 1.6}, "", true)};
    for (const double x : {1.0, 1.95})
        for (const double z : {1.0, 1.55})
            table.push_back(part({x, 0, z}, {x + 0.05, 0.7, z + 0.05}, "", true));
    const std::vector<Model> stack{part({1, 0, 1}, {2, 0.5, 2}, "", true),
                                   part({1, 0.5, 1}, {2, 1, 2}, "", true),
                                   part({1.2, 1, 1.2}, {1.8, 1.5, 1.8}, "b", true)};
    std::vector<Model> row;
    for (const double x : {0.3, 0.9, 1.5}) row.push_back(part({x, 0, 0}, {x + 0.6, 0.8, 0.6}, "", true));
    for (const bool outwards : {false, true}) {
        expectVolumes(imported(hall(table, outwards)), {240 - 0.03 - 4 * 0.00175});
        expectVolumes(imported(hall(stack, outwards)), {240 - 1 - 0.18});
        expectVolumes(imported(hall(row, outwards)), {240 - 3 * 0.288});
    }
}

TEST(SharedWalls, walls_drawn_as_solids) {
    // A wall with a thickness from side to side of the hall.
    for (const bool outwards : {false, true})
        for (const std::string without : {"", "btns"})
            if (!outwards || without.empty())
                expectVolumes(imported(hall({part({4, 0, 0}, {4.2, 3, 8}, without, true)}, outwards)),
                              {96, 5.8 * 24});
    Model butted; // four walls between two slabs, nothing else
    for (const Model& solid :
         {part({-0.3, 0, -0.3}, {4.3, 2.5, 0}, "", true), part({-0.3, 0, 3}, {4.3, 2.5, 3.3}, "", true),
          part({-0.3, 0, 0}, {0, 2.5, 3}, "", true), part({4, 0, 0}, {4.3, 2.5, 3}, "", true),
          part({-0.3, -0.3, -0.3}, {4.3, 0, 3.3}, "", true),
          part({-0.3, 2.5, -0.3}, {4.3, 2.8, 3.3}, "", true)})
        butted.insert(butted.end(), solid.begin(), solid.end());
    const Building building = imported(butted);
    expectVolumes(building, {30});
    expectWarning(building, "6 solids were cut out");
    // Two rooms with a wall between that has no thickness, in walls that have one.
    Model thick = part({-0.3, -0.3, -0.3}, {8.5, 2.8, 3.3}, "", true);
    box(thick, {0, 0, 0}, {4, 2.5, 3}, "A");
    box(thick, {4, 0, 0}, {8.2, 2.5, 3}, "B");
    const Building two = imported(thick);
    expectVolumes(two, {30, 31.5});
    expectWarning(two, "outside of walls was left out");
}

// Facets that nearly lie in one plane: their corners must stay where those of the next plane have them.
TEST(SharedWalls, a_ball_beside_a_table_does_not_keep_it_from_closing) {
    Model ball;
    const int n = 40;
    const auto at = [&](int i, int j) {
        const double a = 3.14159265358979 * i / n, b = 2 * 3.14159265358979 * (j % n) / n;
        return dvec3(6, 1.5, 4) + dvec3(std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b));
    };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            if (i > 0) ball.push_back({{at(i, j), at(i, j + 1), at(i + 1, j)}, "B"});
            if (i < n - 1) ball.push_back({{at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)}, "B"});
        }
    double volume = 0;
    for (const Drawn& t : ball) volume += glm::dot(t.corners[0], glm::cross(t.corners[1], t.corners[2])) / 6;
    expectVolumes(imported(hall({ball, part({1, 0, 1}, {2, 1, 2}, "", true)})), {239 - std::abs(volume)});
}

// Area that a room sees of a material.
double areaOf(const Building& building, const std::string& material) {
    double area = 0;
    const PatchMesh mesh = meshBuilding(building, {500});
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        if (mesh.materials[mesh.material[i]].name == material) area += patchArea(mesh, i);
    return area;
}

bool repaired(const Building& building, const std::string& text) {
    return std::ranges::any_of(building.repairs,
                               [&](const std::string& r) { return r.find(text) != std::string::npos; });
}

TEST(SharedWalls, rugs_and_pictures_are_seen_whichever_way_they_look) {
    for (const bool outwards : {false, true})
        for (const bool turned : {false, true}) {
            Model rug, picture, corner;
            rectangle(rug, {2, 0, 2}, {0, 0, 2}, {3, 0, 0}, "B");
            rectangle(picture, {3, 1, 0}, {2, 0, 0}, {0, 1, 0}, "B");
            rectangle(corner, {0, 0, 0}, {0, 0, 2}, {3, 0, 0}, "B"); // two of its edges on the walls
            for (Model* model : {&rug, &picture, &corner})
                if (turned) reverse(*model);
            const std::vector<std::pair<std::vector<Model>, double>> cases{
                {{rug}, 6}, {{picture}, 2}, {{corner}, 6}, {{rug, picture}, 8}};
            for (const auto& [things, area] : cases) {
                const Building building = imported(hall(things, outwards));
                expectVolumes(building, {240});
                EXPECT_NEAR(areaOf(building, "B"), area, 1e-6) << outwards << turned;
                EXPECT_NEAR(areaOf(building, "A"), 268 - area, 1e-6) << outwards << turned;
                EXPECT_TRUE(repaired(building, "the smaller is seen")) << outwards << turned;
                EXPECT_TRUE(building.warnings.empty());
            }
        }
    Model rug, inRug; // one on the other
    rectangle(rug, {2, 0, 2}, {0, 0, 2}, {3, 0, 0}, "B");
    rectangle(inRug, {3, 0, 3}, {0, 0, 1}, {1, 0, 0}, "A");
    const Building two = imported(hall({rug, inRug}));
    EXPECT_NEAR(areaOf(two, "B"), 5, 1e-6);
    Model beside; // of one size: nobody can say which lies on the other
    rectangle(beside, {3, 0, 2}, {0, 0, 2}, {3, 0, 0}, "A");
    EXPECT_THROW(imported(hall({rug, beside})), InputError);
}

TEST(SharedWalls, what_covers_most_of_a_wall_and_looks_away_is_told_where_nothing_is_behind) {
    const auto picture = [](double left, bool away) {
        Model out;
        rectangle(out, {left, 0.2, 0}, {9 - left, 0, 0}, {0, 2.6, 0}, "B");
        if (away) reverse(out);
        return out;
    };
    EXPECT_NEAR(areaOf(imported(hall({picture(1, false)})), "B"), 8 * 2.6, 1e-6);
    const Building away = imported(hall({picture(1, true)}));
    EXPECT_NEAR(areaOf(away, "B"), 0, 1e-6);
    expectWarning(away, "not seen in the room, taken as its outside");

    Model walls; // walls with a thickness, which have an outside of their own
    const double t = 0.3;
    for (const auto& [low, high] : {std::pair(dvec3(-t, 0, -t), dvec3(10 + t, 3, 0)),
                                    {{-t, 0, 8}, {10 + t, 3, 8 + t}},
                                    {{-t, 0, 0}, {0, 3, 8}},
                                    {{10, 0, 0}, {10 + t, 3, 8}},
                                    {{-t, -t, -t}, {10 + t, 0, 8 + t}},
                                    {{-t, 3, -t}, {10 + t, 3 + t, 8 + t}}}) {
        const Model wall = part(low, high, "", true);
        walls.insert(walls.end(), wall.begin(), wall.end());
    }
    for (const double left : {1.0, 6.0}) {
        Model model = walls;
        model.push_back({picture(left, true)[0].corners, "A"});
        const Building building = imported(model);
        expectVolumes(building, {240});
        EXPECT_NEAR(areaOf(building, "A"), (9 - left) * 2.6, 1e-6); // walls are of "B"
    }
}

TEST(SharedWalls, nothing_is_seen_of_a_sheet_within_a_wall) {
    const double t = 0.2; // of walls round the room, between one floor and one ceiling
    const dvec3 up(0, 2.4, 0), x(3, 0, 0), y(0, 0.8, 0), z(0, 0, t);
    Model model, inner;
    rectangle(model, {3, 0, 5}, {t, 0, 0}, up, "B"); // across the walls' inside, where strips of floors end
    for (const auto& [o, u, v] : {std::tuple(dvec3(0), dvec3(0, 0, 5), dvec3(3, 0, 0)),
                                  {{-t, 0, -t}, {0, 0, 5 + 2 * t}, {t, 0, 0}},
                                  {{3, 0, -t}, {0, 0, 5 + t}, {t, 0, 0}},
                                  {{0, 0, 5}, {0, 0, t}, {3 + t, 0, 0}},
                                  {{0, 0, -t}, {0, 0, t}, {3, 0, 0}}}) {
        rectangle(model, o, u, v, "A");
        rectangle(model, o + up, v, u, "A");
    }
    box(inner, {0, 0, 0}, {3, 2.4, 5}, "A", "glass");
    model.insert(model.end(), inner.begin() + 2, inner.end());
    rectangle(model, {-t, 0, -t}, {0, 0, 5 + 2 * t}, up, "A");
    rectangle(model, {3 + t, 0, -t}, up, {0, 0, 5 + 2 * t}, "A");
    rectangle(model, {-t, 0, 5 + t}, {3 + 2 * t, 0, 0}, up, "A");
    for (const double left : {-t, 3.0}) rectangle(model, {left, 0, -t}, up, {t, 0, 0}, "A");
    Model front;
    rectangle(front, -z, up, x, "A", "glass");
    std::erase_if(front, [](const Drawn& face) { return face.material == "glass"; });
    model.insert(model.end(), front.begin(), front.end());
    for (const double level : {0.8, 1.6}) rectangle(model, dvec3(1, level, -t), z, x / 3.0, "A");
    for (const double left : {1.0, 2.0}) rectangle(model, dvec3(left, 0.8, -t), y, z, "A");
    const Building building = imported(model);
    expectVolumes(building, {36});
    EXPECT_NEAR(areaOf(building, "B"), 0, 1e-6);
}

TEST(SharedWalls, the_outer_side_of_a_wall_is_not_seen_inside) {
    Model shell; // as large, and in panels
    box(shell, {0, 0, 0}, {10, 3, 8}, "B");
    reverse(shell);
    Model panels;
    for (const double x : {0.0, 5.0}) rectangle(panels, {x, 0, 0}, {0, 3, 0}, {5, 0, 0}, "B");
    for (const Model& outer : {shell, panels}) {
        const Building building = imported(hall({outer}));
        expectVolumes(building, {240});
        EXPECT_NEAR(areaOf(building, "A"), 268, 1e-6);
        EXPECT_NEAR(areaOf(building, "B"), 0, 1e-6);
    }
}

} // namespace
