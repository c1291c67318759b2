// Models as they come: each is closed as it was meant, or refused with a face named; never silently wrong.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <random>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "geometry/bounds.h"
#include "geometry/face_soup.h"
#include "geometry/input_error.h"
#include "geometry/mesher.h"
#include "geometry/model_file.h"
#include "geometry/raw_model.h"
#include "geometry/shell_faces.h"
#include "tests/geometry/mesh_volume.h"

using namespace heliodon::geometry;

namespace {

struct Polygons {
    std::vector<glm::dvec3> vertices;
    std::vector<std::vector<uint32_t>> faces;

    void add(const Polygons& other, bool turned = false) {
        const auto first = static_cast<uint32_t>(vertices.size());
        vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
        for (std::vector<uint32_t> face : other.faces) {
            for (uint32_t& v : face) v += first;
            if (turned) std::ranges::reverse(face);
            faces.push_back(face);
        }
    }
};

// Normals inwards.
Polygons box(glm::dvec3 low, glm::dvec3 high) {
    Polygons out;
    for (int i = 0; i < 8; ++i)
        out.vertices.emplace_back(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
    out.faces = {{0, 4, 5, 1}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    return out;
}

Polygons room() {
    return box({0, 0, 0}, {4, 2.5, 3});
}

Polygons triangles(const Polygons& in) {
    Polygons out{in.vertices, {}};
    for (const auto& f : in.faces)
        for (size_t k = 1; k + 1 < f.size(); ++k) out.faces.push_back({f[0], f[k], f[k + 1]});
    return out;
}

// Every face with corners of its own, off by up to `off`.
Polygons apart(const Polygons& in, double off) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> shift(-off, off);
    Polygons out;
    for (const auto& f : in.faces) {
        out.faces.emplace_back();
        for (const uint32_t v : f) {
            out.faces.back().push_back(static_cast<uint32_t>(out.vertices.size()));
            out.vertices.push_back(in.vertices[v] + glm::dvec3(shift(random), shift(random), shift(random)));
        }
    }
    return out;
}

std::string written(const Polygons& model) {
    const std::string file = testing::TempDir() + "dirty.obj";
    std::ofstream out(file);
    for (const glm::dvec3& v : model.vertices) out << fmt::format("v {:.9g} {:.9g} {:.9g}\n", v.x, v.y, v.z);
    for (const auto& f : model.faces) {
        out << "f";
        for (const uint32_t v : f) out << ' ' << v + 1;
        out << '\n';
    }
    return file;
}

void expectRooms(const Polygons& model, uint32_t rooms, double cubicMetres, const std::string& repair = "",
                 const std::string& warning = "") {
    const Building building = importModel(written(model));
    EXPECT_EQ(building.roomCount, rooms);
    EXPECT_NEAR(volume(meshBuilding(building, {500})), cubicMetres, 1e-4 * cubicMetres);
    const auto joined = [](const std::vector<std::string>& sentences) {
        std::string all;
        for (const std::string& s : sentences) all += s + "; ";
        return all;
    };
    const std::string repairs = joined(building.repairs), warnings = joined(building.warnings);
    EXPECT_NE(repairs.find(repair), std::string::npos) << repairs;
    EXPECT_NE(warnings.find(warning), std::string::npos) << warnings;
    EXPECT_EQ(warnings.empty(), warning.empty()) << warnings;
}

void expectRefused(const Polygons& model, const std::string& why) {
    try {
        const Building building = importModel(written(model));
        ADD_FAILURE() << "taken as " << building.roomCount << " rooms of " << building.faces.size()
                      << " faces";
    } catch (const InputError& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find(why), std::string::npos) << text;
        EXPECT_NE(text.find("dirty.obj:"), std::string::npos) << text; // the line of a face
    }
}

} // namespace

TEST(DirtyModel, a_piece_of_a_face_drawn_again_changes_nothing) {
    Polygons part = room();
    part.faces.push_back({0, 4, 5});
    expectRooms(part, 1, 30, "2 faces were divided where others lie on");
}

TEST(DirtyModel, a_box_on_the_floor_of_a_room_with_gaps) {
    for (const double off : {1e-6, 1e-5, 2e-5, 3e-5, 4e-5}) {
        Polygons model = apart(room(), off);
        model.add(box({1, 0, 1}, {2, 1, 2}), true);
        expectRooms(model, 1, 29, off > 1e-5 ? "gaps of up to" : "", "1 solid was cut out");
    }
}

TEST(DirtyModel, faces_that_share_no_corners_are_welded) {
    expectRooms(apart(room(), 0), 1, 30);
    expectRooms(apart(triangles(room()), 1e-6), 1, 30);
}

TEST(DirtyModel, gaps_that_nobody_sees_are_closed_and_reported) {
    expectRooms(apart(triangles(room()), 1e-4), 1, 30, "gaps of up to");
    expectRefused(apart(triangles(room()), 5e-3), "not closed");
}

TEST(DirtyModel, flipped_faces_are_turned_and_counted) {
    Polygons some = triangles(room());
    for (const size_t f : {3u, 7u}) std::ranges::reverse(some.faces[f]);
    expectRooms(some, 1, 30, "2 faces were turned over");
    Polygons all;
    all.add(room(), true);
    expectRooms(all, 1, 30);
}

TEST(DirtyModel, faces_drawn_twice_or_without_area_are_left_out) {
    Polygons twice = room();
    twice.faces.push_back({1, 5, 4, 0});
    expectRooms(twice, 1, 30, "left out");
    Polygons line = room();
    line.vertices.emplace_back(2, 0, 0);
    line.faces.push_back({0, 8, 1});
    expectRooms(line, 1, 30, "left out");
}

TEST(DirtyModel, a_face_without_area_may_bridge_a_corner_on_another_edge) {
    Polygons model = apart(room(), 0);
    // The first face in two parts, and from one end of an edge to the other, over its middle, a face as thin.
    const std::vector<uint32_t> whole = model.faces[0]; // 0 4 5 1 of the room: x from 0 to 4, z 3, back
    model.vertices.emplace_back(1, 0, 3);
    model.vertices.emplace_back(1, 0, 0);
    model.vertices.emplace_back(2, 0, 0);
    model.faces[0] = {whole[0], whole[1], 24, 25};
    model.faces.push_back({25, 24, whole[2], whole[3]});
    model.faces.push_back({whole[0], 26, whole[3]});
    expectRooms(model, 1, 30, "left out");
}

TEST(DirtyModel, corners_in_whole_millimetres_bend_faces_which_are_divided) {
    Polygons house; // with a gable, turned: four corners of its roof lie in no plane
    const std::vector<glm::dvec2> gable{{0, 0}, {5, 0}, {5, 2.5}, {2.5, 4}, {0, 2.5}};
    for (const double z : {0.0, 6.0})
        for (const glm::dvec2 p : gable) {
            const double x = std::cos(0.4) * p.x - std::sin(0.4) * z,
                         y = std::sin(0.4) * p.x + std::cos(0.4) * z;
            house.vertices.push_back(glm::round(1000.0 * glm::dvec3(x, p.y, y)) / 1000.0);
        }
    house.faces = {{0, 1, 2, 3, 4}, {9, 8, 7, 6, 5}};
    for (uint32_t i = 0; i < 5; ++i) house.faces.push_back({i, i + 5, (i + 1) % 5 + 5, (i + 1) % 5});
    expectRooms(house, 1, 97.5, "divided into triangles");
}

// As drawn by hand, or for water to run off: folded as little as may be seen, and said.
TEST(DirtyModel, faces_bent_by_centimetres_are_divided_with_a_warning) {
    Polygons bent = box({0, 0, 0}, {6, 3, 6});
    bent.vertices[7].y += 0.022;
    const std::string warning = "1 face bent by up to 0.011 m (the first at 10) was divided into triangles";
    expectRooms(bent, 1, 108 + 36 * 0.022 / 6, "", warning); // the fold ends in the corner that is lifted
    const Building building = importModel(written(bent));
    std::set<uint32_t> surfaces;
    for (const Face& face : building.faces) surfaces.insert(face.surface);
    EXPECT_EQ(building.faces.size(), 7u);
    EXPECT_EQ(surfaces.size(), 6u); // light runs on over the fold
    // Both sides of a floor without thickness fold alike, whichever corner they begin with.
    for (const size_t first : {0, 1, 2, 3}) {
        Polygons two = bent;
        two.vertices.insert(two.vertices.end(), {{0, 6, 0}, {6, 6, 0}, {0, 6, 6}, {6, 6, 6}});
        for (const std::vector<uint32_t>& face : {std::vector<uint32_t>{6, 7, 3, 2},
                                                  {8, 9, 11, 10},
                                                  {2, 3, 9, 8},
                                                  {7, 6, 10, 11},
                                                  {6, 2, 8, 10},
                                                  {3, 7, 11, 9}})
            two.faces.push_back(face);
        std::ranges::rotate(two.faces[6], two.faces[6].begin() + static_cast<std::ptrdiff_t>(first));
        expectRooms(two, 2, 216, "", "2 faces bent by up to 0.011 m (the first at 14)");
    }
}

TEST(DirtyModel, a_hole_is_said_with_its_size_and_place) {
    Polygons open = room(); // a door hole in the wall at z = 0
    open.vertices.insert(open.vertices.end(), {{1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 2, 0}});
    open.faces[2] = {0, 8, 11, 10, 9, 1, 3, 2};
    expectRefused(open, "it is 1 wide and 2 high, round 1.5 1 0,");
    try {
        importModel(written(open), UpAxis::z);
        ADD_FAILURE() << "taken";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("round 1.5 1 0,"), std::string::npos) << error.what();
    }
}

TEST(DirtyModel, a_level_or_leaning_hole_is_said_with_both_sides) {
    Polygons roofless = box({0, 0, 0}, {4, 2.5, 5});
    std::erase(roofless.faces, std::vector<uint32_t>{2, 3, 7, 6});
    expectRefused(roofless, "(it is 5 by 4, round 2 2.5 2.5,");
    for (const double turn : {0.3, 1.2}) { // about the vertical
        Polygons turned = roofless;
        for (glm::dvec3& p : turned.vertices)
            p = {std::cos(turn) * p.x + std::sin(turn) * p.z, p.y,
                 std::cos(turn) * p.z - std::sin(turn) * p.x};
        expectRefused(turned, "(it is 5 by 4, round ");
    }
    Polygons lean = roofless; // 3 up on 4
    for (const size_t v : {3, 7}) lean.vertices[v].y += 3;
    expectRefused(lean, "(it is 5 by 5, round 2 4 2.5,");
    Polygons corner = roofless; // a wall is missing, too
    std::erase(corner.faces, std::vector<uint32_t>{0, 2, 6, 4});
    expectRefused(corner, "(it is 5 by 4 by 2.5, round ");
}

// Where the model closes with it, in either way of dividing it.
TEST(DirtyModel, a_face_bent_by_much_is_divided_with_a_warning) {
    Polygons bent = room();
    bent.vertices[7].y += 0.3;
    expectRooms(bent, 1, 30 + 12 * 0.3 / 6, "", "1 face bent by up to 0.15 m (the first at 10) was divided");
}

// A message reads "file:line (object): what", so that the line is found by programs, too.
TEST(DirtyModel, a_face_is_named_by_its_object_too) {
    const auto placeIn = [](const std::string& before) {
        const std::string file = testing::TempDir() + "dirty.obj";
        std::ofstream(file) << "v 0 0 0\nv 1 0 0\nv 0 1 0\n" << before << "f 1 2 3\nf 2 1 3\n";
        return readRawModel(file).places(std::vector<uint32_t>{0, 1});
    };
    EXPECT_EQ(placeIn(""), "4, 5");
    EXPECT_EQ(placeIn("g default\n"), "5, 6");
    EXPECT_EQ(placeIn("g Box003\n"), "5, 6 (object \"Box003\")");
    EXPECT_EQ(placeIn("o Wall.003\ng inner\n"), "6, 7 (object \"Wall.003\")");
    std::string longName;
    for (int i = 0; i < 41; ++i) longName += "\xC3\xA4";
    EXPECT_EQ(placeIn("o " + longName + "\n"), "5, 6 (object \"" + longName.substr(2) + "...\")");
}

TEST(DirtyModel, slabs_without_a_room_between_them_are_told_so) {
    Polygons slabs;
    slabs.add(box({0, -0.2, 0}, {5, 0, 4}), true);
    slabs.add(box({-0.2, -0.2, -0.2}, {0, 2.5, 4.2}), true);
    slabs.add(box({0, -0.1, 0}, {5.2, 2.5, 0.2}), true);
    expectRefused(slabs, "encloses no room");
    slabs.add(box({-0.2, 2.6, -0.2}, {5.2, 2.8, 4.2}), true); // a ceiling that touches no wall
    expectRefused(slabs, "encloses no room");
}

TEST(DirtyModel, a_copy_of_another_material_is_named) {
    const auto file = [](const std::string& copies) {
        const std::string path = written(room());
        std::ofstream(testing::TempDir() + "dirty.mtl")
            << "newmtl red\nKd 0.5 0.1 0.1\nnewmtl pane\nKd 0 0 0\nTf 0.8 0.8 0.8\nNi 1.52\n";
        std::ofstream(path, std::ios::app) << "mtllib dirty.mtl\n" << copies;
        return path;
    };
    const Building building = importModel(file("usemtl red\nf 2 6 5 1\nf 3 4 8 7\n"));
    EXPECT_EQ(building.roomCount, 1u);
    ASSERT_EQ(building.warnings.size(), 1u);
    EXPECT_NE(building.warnings[0].find("2 faces of \"red\""), std::string::npos) << building.warnings[0];
    EXPECT_NE(building.warnings[0].find("these are seen"), std::string::npos) << building.warnings[0];
    for (const Face& face : building.faces) EXPECT_NE(building.materials[face.material].name, "red");
    try {
        importModel(file("usemtl pane\nf 2 6 5 1\n"));
        ADD_FAILURE() << "a pane on a wall of the same corners is taken";
    } catch (const InputError& error) {
        EXPECT_EQ(
            std::string(error.what()).substr(testing::TempDir().size()),
            "dirty.obj:17: an opening and a wall (9) lie on one another, expected a hole in the wall there");
    }
}

// By the line of the pane, whichever of them comes first.
TEST(DirtyModel, a_pane_drawn_on_a_part_of_a_wall_is_refused_by_its_line) {
    const std::string file = written(room());
    std::ofstream(testing::TempDir() + "dirty.mtl") << "newmtl pane\nTf 0.8\nNi 1.52\n";
    std::ofstream(file, std::ios::app)
        << "mtllib dirty.mtl\nv 1 1 0\nv 2 1 0\nv 2 2 0\nv 1 2 0\nusemtl pane\nf 9 10 11 12\n";
    try {
        importModel(file);
        ADD_FAILURE() << "taken";
    } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()).substr(testing::TempDir().size()),
                  "dirty.obj:21: an opening and a wall (11) lie on one another, expected a hole in the wall "
                  "there");
    }
}

// Two walls that face one another, and one of them: it is no edge that is missing.
TEST(DirtyModel, walls_that_do_not_touch_are_told_so) {
    SoupFace wall{.loops = {{{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {0, 3, 0}}}}, other = wall;
    for (glm::dvec3& p : other.loops[0]) p.z = 4;
    other.surface = 1;
    for (const std::vector<SoupFace>& soup : {std::vector{wall}, std::vector{wall, other}}) {
        Building building = weldFaces(soup, 1, 1e-6);
        const ShellFaces shells = orientShells(building);
        EXPECT_EQ(shells.bad.size(), soup.size());
        EXPECT_NE(shells.what.find("no two of these faces meet"), std::string::npos) << shells.what;
    }
}

// A closed box beside two without their tops: the larger one's hole, 2 m by 2 m, is the one that is told.
TEST(DirtyModel, of_parts_that_are_open_the_border_of_the_largest_is_told) {
    std::vector<SoupFace> soup;
    const auto box = [&](double x, double size, bool isClosed) {
        const auto face = [&](std::array<int, 4> corners) {
            SoupFace& out = soup.emplace_back();
            out.loops.emplace_back();
            for (const int k : corners)
                out.loops[0].push_back(glm::dvec3(x, 0, 0) + size * glm::dvec3(k & 1, k >> 1 & 1, k >> 2));
            out.surface = static_cast<uint32_t>(soup.size() - 1);
        };
        for (const std::array<int, 4> corners :
             {std::array{0, 4, 5, 1}, std::array{0, 1, 3, 2}, std::array{4, 6, 7, 5}, std::array{0, 2, 6, 4},
              std::array{1, 5, 7, 3}})
            face(corners);
        if (isClosed) face({2, 3, 7, 6});
    };
    box(0, 1, false);
    box(10, 3, true);
    box(20, 2, false);
    Building building = weldFaces(soup, 1, 1e-6);
    const ShellFaces shells = orientShells(building);
    EXPECT_EQ(shells.bad.size(), 8u) << "four walls of each that is open";
    ASSERT_FALSE(shells.bad.empty());
    EXPECT_EQ(shells.bad[0], 12u) << "the first wall of the third box";
    EXPECT_FALSE(shells.isHole);
    const Bounds box20 = boundsOf(shells.border);
    EXPECT_EQ(box20.low, glm::dvec3(20, 2, 0));
    EXPECT_EQ(box20.high, glm::dvec3(22, 2, 2));
}

TEST(DirtyModel, a_sheet_in_a_closed_room_is_a_board_but_for_a_hole_in_the_room) {
    Polygons model = room();
    model.vertices.insert(model.vertices.end(), {{2, 0.5, 1}, {2, 2, 1}, {2, 2, 2}, {2, 0.5, 2}});
    model.faces.push_back({8, 9, 10, 11});
    for (const bool triangulated : {false, true})
        EXPECT_EQ(importModel(written(triangulated ? triangles(model) : model)).roomCount, 1u);
    model.faces.erase(model.faces.begin());
    expectRefused(model,
                  "an edge of this face has no neighbour, on the first of 2 open borders: close the hole");
}

TEST(DirtyModel, a_corner_on_another_faces_edge_divides_it) {
    Polygons model = room();
    model.vertices.emplace_back(2, 0, 0);
    model.faces[0] = {0, 4, 5, 1, 8};
    expectRooms(model, 1, 30);
}

TEST(DirtyModel, solids_in_the_room_are_cut_out_of_its_air) {
    for (const bool turned : {false, true}) {
        Polygons floating = room();
        floating.add(box({1, 0.5, 1}, {2, 1.5, 2}), turned);
        expectRooms(floating, 1, 29, "", turned ? "" : "taken as solid though the faces look into it");
    }
    Polygons standing = room();
    standing.add(box({1, 0, 1}, {2, 1, 2}), true);
    expectRooms(standing, 1, 29, "", "1 solid was cut out of the room where it stands, of 3.4 %");
}

TEST(DirtyModel, outlines_may_turn_inwards) {
    Polygons prism; // an L seen from above
    const std::vector<glm::dvec2> plan{{0, 0}, {4, 0}, {4, 2}, {2, 2}, {2, 4}, {0, 4}};
    const auto n = static_cast<uint32_t>(plan.size());
    for (const double y : {0.0, 3.0})
        for (const glm::dvec2 p : plan) prism.vertices.emplace_back(p.x, y, p.y);
    prism.faces.resize(2);
    for (uint32_t i = 0; i < n; ++i) {
        prism.faces[0].push_back(i);
        prism.faces[1].push_back(2 * n - 1 - i);
        prism.faces.push_back({i, i + n, (i + 1) % n + n, (i + 1) % n});
    }
    expectRooms(prism, 1, 36);
}

TEST(DirtyModel, far_from_the_origin_and_in_millimetres) {
    Polygons far = room();
    for (glm::dvec3& p : far.vertices) p += glm::dvec3(1e6, 0, -1e6);
    EXPECT_EQ(importModel(written(far)).roomCount, 1u);
    Polygons fine = room();
    for (glm::dvec3& p : fine.vertices) p *= 1000;
    expectRooms(fine, 1, 30e9);
    Polygons site = fine; // in a national grid
    for (glm::dvec3& p : site.vertices) p += glm::dvec3(3e8 + 100, 0, -5e9);
    EXPECT_EQ(importModel(written(site)).roomCount, 1u);
    for (glm::dvec3& p : site.vertices) p += glm::dvec3(0, 0, -6e9);
    expectRefused(site, "has the coordinate -1.1e+10, expected -1e+10 to 1e+10");
}

TEST(DirtyModel, rooms_that_share_a_wall_without_thickness) {
    Polygons once = room();
    once.add(box({4, 0, 0}, {8, 2.5, 3}));
    for (const Polygons& drawn : {once, triangles(once), apart(once, 1e-6)})
        expectRooms(drawn, 2, 60, "without thickness");
    once.faces.erase(once.faces.end() - 2); // the wall between drawn once
    expectRooms(once, 2, 60, "without thickness");
}

TEST(DirtyModel, faces_that_do_not_fit_are_refused_by_name) {
    Polygons twisted = room(); // corners in the wrong order
    twisted.faces[0] = {0, 5, 4, 1};
    expectRefused(twisted, "not closed");
    Polygons bent = room(); // a quad with one corner lifted
    bent.vertices[7].y = 2.8;
    bent.faces.erase(bent.faces.begin());
    expectRefused(bent, "not planar"); // this may be what keeps it open
}

TEST(DirtyModel, what_has_no_one_answer_is_refused_by_name) {
    Polygons open = room();
    open.faces.pop_back();
    expectRefused(open, "not closed");
    Polygons hole = triangles(room());
    hole.faces.pop_back();
    expectRefused(hole, "not closed");
    Polygons sheet = room();
    sheet.faces.resize(1);
    expectRefused(sheet, "not closed"); // it does not stand on itself
    Polygons through = room();
    through.add(box({1, -0.2, 1}, {2, 1, 2}), true);
    expectRefused(through, "crosses another face");
    Polygons crossing = room();
    crossing.add(box({2, 0, 1}, {6, 2.5, 4}));
    expectRefused(crossing, "");
}

TEST(DirtyModel, what_holds_no_room_is_refused_by_name) {
    Polygons far = room();
    far.vertices[0].x = 1e30;
    expectRefused(far, "1e+30");
    Polygons wrongUnit = room();
    for (glm::dvec3& p : wrongUnit.vertices) p *= 1e8;
    expectRefused(wrongUnit, "metres");
    Polygons line = room();
    for (glm::dvec3& p : line.vertices) p.y = p.z = 0;
    expectRefused(line, "area");
    Polygons point = room();
    for (glm::dvec3& p : point.vertices) p = {1, 2, 3};
    expectRefused(point, "one point");
    Polygons flat; // a tetrahedron pressed flat
    flat.vertices = {{0, 0, 0}, {4, 0, 0}, {4, 0, 3}, {0, 0, 3}};
    flat.faces = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    expectRefused(flat, "");
    Polygons twoSides; // a sheet that is drawn from either side
    twoSides.vertices = flat.vertices;
    twoSides.faces = {{0, 1, 2, 3}, {3, 2, 1, 0}};
    expectRefused(twoSides, "");
}

// Corners that no face uses mean nothing.
TEST(DirtyModel, stray_corners_far_away_do_not_matter) {
    Polygons model = room();
    model.vertices.emplace_back(1e30, 0, 0);
    expectRooms(model, 1, 30);
}

// A floor and a ceiling with a court, each drawn as one polygon that runs to its hole and back.
TEST(DirtyModel, polygons_that_run_to_their_holes_and_back_have_holes) {
    Polygons model = box({0, 0, 0}, {6, 3, 6});
    model.add(box({2, 0, 2}, {4, 3, 4}), true);
    std::vector<std::vector<uint32_t>> faces;
    for (const bool up : {false, true}) { // floor and ceiling of each box are its faces 0 and 1
        const std::vector<uint32_t>&outer = model.faces[up ? 1 : 0], &inner = model.faces[up ? 7 : 6];
        std::vector<uint32_t> face = outer;
        face.push_back(outer[0]);
        for (size_t k = 0; k <= 4; ++k) face.push_back(inner[k % 4]);
        faces.push_back(face);
    }
    for (size_t f = 0; f < model.faces.size(); ++f)
        if (f % 6 > 1) faces.push_back(model.faces[f]);
    model.faces = faces;
    expectRooms(model, 1, 3 * (36 - 4));
    expectRooms(apart(model, 0), 1, 3 * (36 - 4)); // each corner written again where a face comes back to it
}

// A wall that runs to the hole for its window and back, and the pane in it.
Building roomWithPane(const std::string& pane, const std::string& name = "pane") {
    Polygons model = room();
    for (const glm::dvec3 v : {glm::dvec3(1, 1, 0), {3, 1, 0}, {3, 2, 0}, {1, 2, 0}})
        model.vertices.push_back(v);
    model.faces[2] = {1, 3, 2, 0, 1, 8, 11, 10, 9, 8}; // at z = 0
    const std::string file = written(model), folder = testing::TempDir();
    std::ofstream(file, std::ios::app) << "mtllib pane.mtl\nusemtl " << name << "\nf 9 10 11 12\n";
    std::ofstream(folder + "pane.mtl") << "newmtl unused\nd 0.3\nnewmtl " << name << "\n" << pane;
    return importModel(file);
}

TEST(DirtyModel, a_bent_face_with_open_edges_is_named_once) {
    const std::string file = written(
        {{{0, 0, 0}, {4, 0, 0}, {4, 1, 1e-3}, {4, 3, 0}, {1, 3, 0}, {0, 3, 1e-3}}, {{0, 1, 2, 3, 4, 5}}});
    try {
        importModel(file);
        ADD_FAILURE();
    } catch (const InputError& error) {
        EXPECT_EQ(error.what(), file + ":7: the model is not closed: an edge of this face has no neighbour");
    }
}

TEST(DirtyModel, a_pane_in_a_hole_is_a_window_and_see_through_without_transmittance_is_named) {
    const Building window = roomWithPane("Kd 0 0 0\nd 0.2\nTf 0.8 0.8 0.8\n");
    EXPECT_TRUE(window.warnings.empty());
    EXPECT_EQ(std::ranges::count_if(window.faces,
                                    [&](const Face& f) { return window.materials[f.material].isOpening(); }),
              1);
    for (const char* pane :
         {"Kd 0.6 0.7 0.8\nd 0.4\n", "Kd 0.6 0.7 0.8\nTr 0.6\n", "Kd .1 .1 .1\nd -halo .4\n"}) {
        const Building opaque = roomWithPane(pane);
        ASSERT_EQ(opaque.warnings.size(), 1u) << pane;
        EXPECT_NE(opaque.warnings[0].find("\"pane\" is see-through (opacity 0.4)"), std::string::npos)
            << opaque.warnings[0];
    }
    EXPECT_TRUE(roomWithPane("Kd 0.5 0.5 0.5\nd 1\n").warnings.empty());
    const auto named = roomWithPane("Kd 0.5 0.5 0.5\n", "Window_Glass").warnings;
    ASSERT_EQ(named.size(), 1u);
    EXPECT_NE(named[0].find("\"Window_Glass\" is glass by its name"), std::string::npos) << named[0];
    for (const char* plaster : {"d 1\nTf 1 1 1\nKd 0.5 0.5 0.5\n", "Kd 0.5 0.5 0.5\nTf 1 1 1\nTr 0\n"}) {
        const Building opaque = roomWithPane(plaster);
        EXPECT_TRUE(std::ranges::none_of(opaque.materials, [](const Material& m) { return m.isOpening(); }));
        ASSERT_EQ(opaque.warnings.size(), 1u) << plaster;
        EXPECT_NE(opaque.warnings[0].find("\"pane\" has d 1 and Kd, and Tf 1 1 1"), std::string::npos)
            << opaque.warnings[0];
    }
    const std::vector<std::string> repairs = roomWithPane("map_Kd tiles.png\nnewmtl unused\nNs 3\n").repairs;
    EXPECT_TRUE(std::ranges::none_of(repairs, [](const auto& r) { return r.find("unused") < r.size(); }));
    EXPECT_EQ(std::ranges::count(repairs, "material \"pane\" has no Kd: a reflectance of 0.5 was assumed"), 1)
        << fmt::format("{}", fmt::join(repairs, "; "));
}

TEST(DirtyModel, the_outside_of_walls_with_a_thickness_is_no_room) {
    for (const bool outwards : {false, true}) { // the faces of the outside
        Polygons model = room();
        model.add(box({-0.3, -0.3, -0.3}, {4.3, 2.8, 3.3}), outwards);
        expectRooms(model, 1, 30, "", "6 faces of the outside of walls were left out");
    }
    // Walls of a metre round a cell: only the way that faces look tells it from a block in a room.
    for (const bool solid : {false, true}) {
        Polygons model = box({-1, -1, -1}, {3, 3.2, 3});
        if (!solid) std::ranges::for_each(model.faces, [](auto& face) { std::ranges::reverse(face); });
        model.add(box({0, 0, 0}, {2, 2.2, 2}), solid);
        expectRooms(model, 1, solid ? 4 * 4.2 * 4 - 8.8 : 8.8, "", solid ? "" : "outside of walls");
    }
}

TEST(DirtyModel, a_block_that_fills_most_of_a_room_is_solid_where_faces_say_so) {
    for (const double size : {3.3, 3.9}) { // 56 % and 93 %
        const double gap = (4 - size) / 2;
        Polygons model = box({0, 0, 0}, {4, 4, 4});
        model.add(box({gap, gap, gap}, {4 - gap, 4 - gap, 4 - gap}), true);
        expectRooms(model, 1, 64 - size * size * size);
    }
    // Two blocks, one of them drawn the other way: the faces say nothing sure, most of it is filled.
    Polygons mixed = box({0, 0, 0}, {4, 4, 4});
    mixed.add(box({0.2, 0.2, 0.2}, {3.8, 3.8, 1.9}), true);
    mixed.add(box({0.2, 0.2, 2.1}, {3.8, 3.8, 3.8}));
    expectRooms(mixed, 2, 2 * 3.6 * 3.6 * 1.7, "", "outside of walls");
}

// Each box drawn by itself, from outside, the room from inside: floor and bottom lie on one another.
TEST(DirtyModel, things_that_stand_against_walls_are_solid) {
    for (const Polygons& thing : {box({1, 0, 0}, {1.5, 0.8, 0.6}), box({0, 0, 0}, {0.6, 2, 0.5}),
                                  box({1, 0, 1}, {1.4, 2.5, 1.4}), box({1, 0, 0}, {1.3, 2.5, 0.3})}) {
        Polygons model = room();
        model.add(thing, true);
        const glm::dvec3 size = thing.vertices[7] - thing.vertices[0];
        for (const Polygons& drawn : {model, triangles(model), apart(triangles(model), 0)}) {
            expectRooms(drawn, 1, 30 - size.x * size.y * size.z, "", "1 solid was cut out");
        }
    }
    Polygons two = room();
    two.add(box({1, 0, 0}, {1.5, 0.8, 0.6}), true);
    two.add(box({3.5, 0, 0}, {4, 2.5, 0.72}), true);
    expectRooms(two, 1, 30 - 0.24 - 0.9, "",
                "2 solids were cut out of the room where they stand, the largest of 3.1 %");
    Polygons closet = room(); // drawn from inside it is a room
    closet.add(box({4, 0, 0}, {4.5, 2.5, 0.7}));
    expectRooms(closet, 2, 30 + 0.5 * 2.5 * 0.7);
}

TEST(DirtyModel, crumpled_faces_in_a_room_are_refused_by_name) {
    ImportOptions options;
    options.materials.glazing = {{"glass", glm::vec3(0.85f)}};
    try {
        importModel(HELIODON_TEST_DATA "/geometry/models/crumpled_in_room.obj", UpAxis::y, options);
        ADD_FAILURE();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("Suzanne"), std::string::npos) << error.what();
    }
}
