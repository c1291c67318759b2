#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/building.h"
#include "geometry/disjoint_sets.h"
#include "geometry/face_soup.h"
#include "geometry/mesh_domains.h"
#include "geometry/mesher.h"
#include "geometry/plan_arrangement.h"
#include "geometry/plan_regions.h"
#include "tests/geometry/drawn_pieces.h"
#include "tests/geometry/shuffled_closure.h"

using namespace heliodon::geometry;
using heliodon::test::wall;
using heliodon::test::window;
namespace fs = std::filesystem;

namespace {

const fs::path kSketches = HELIODON_TEST_DATA "/geometry/sketches";

const char* name(Outcome outcome) {
    return outcome == Outcome::ok ? "ok" : outcome == Outcome::warn ? "warn" : "refuse";
}

// Four walls round a rectangle of centre lines, corners tight.
Sketch box(double x0, double y0, double x1, double y1, HeightClass height = HeightClass::red) {
    Sketch s;
    const double h = 0.1875;
    s.walls = {wall("s", {x0 - h, y0}, {x1 + h, y0}, height), wall("e", {x1, y0 - h}, {x1, y1 + h}, height),
               wall("n", {x1 + h, y1}, {x0 - h, y1}, height), wall("w", {x0, y1 + h}, {x0, y0 - h}, height)};
    return s;
}

WallRole entryOf(const ClosureReport& report, const std::string& id) {
    const auto found = std::ranges::find(report.walls, id, &WallRole::id);
    return found != report.walls.end() ? *found : WallRole{id, "missing", "missing"};
}

std::string roleOf(const ClosureReport& report, const std::string& id) {
    return entryOf(report, id).role;
}

std::string reasonOf(const ClosureReport& report, const std::string& id) {
    return entryOf(report, id).reason;
}

// Net area of a rectangle of centre lines: half a thickness comes off on each side.
double net(double width, double height) {
    return (width - 0.375) * (height - 0.375);
}

void expectProven(const Closure& closure) {
    ASSERT_TRUE(closure.building.has_value()) << closure.report.message;
    for (const RoomReport& room : closure.report.rooms) {
        EXPECT_TRUE(room.closed);
        EXPECT_FALSE(room.selfIntersecting);
    }
}

void checkExpected(const Sketch& sketch, const nlohmann::json& expect) {
    const Closure closure = closeSketch(sketch);
    const ClosureReport& report = closure.report;
    EXPECT_EQ(name(report.outcome), expect["outcome"].get<std::string>()) << report.message;
    if (report.outcome == Outcome::refuse) {
        EXPECT_EQ(report.code, expect["error"].get<std::string>());
        EXPECT_FALSE(closure.building.has_value());
        return;
    }
    expectProven(closure);
    EXPECT_EQ(report.windowCount, expect["n_windows"].get<int>());
    EXPECT_EQ(report.skylightPaneCount, expect["n_skylight_panes"].get<int>());
    for (const auto& [id, role] : expect["wall_roles"].items()) EXPECT_EQ(roleOf(report, id), role.get<std::string>()) << id;
    ASSERT_EQ(report.rooms.size(), expect["rooms"].size());
    std::vector<RoomReport> rooms = report.rooms;
    std::ranges::sort(rooms, std::greater(), &RoomReport::floorAreaFt2);
    for (size_t r = 0; r < rooms.size(); ++r) { // the files list larger rooms first
        const auto& e = expect["rooms"][r];
        const double area = e["floor_area"], tolerance = e["area_rel_tol"];
        EXPECT_NEAR(rooms[r].floorAreaFt2, area, area * tolerance);
        EXPECT_NEAR(rooms[r].volumeFt3, e["volume"].get<double>(), e["volume"].get<double>() * tolerance);
        EXPECT_EQ(rooms[r].ceilingFt, e["ceiling"].get<double>());
        EXPECT_EQ(rooms[r].euler, e["euler"].get<int>());
    }
}

} // namespace

class PublicSketch : public testing::TestWithParam<std::string> {};

TEST_P(PublicSketch, closes_as_a_sensible_person_expects) {
    const fs::path file = kSketches / GetParam();
    const nlohmann::json json = nlohmann::json::parse(std::ifstream(file));
    checkExpected(readSketch(file), json["expect"]);
}

TEST_P(PublicSketch, order_of_primitives_changes_nothing) {
    heliodon::test::expectSameInAnyOrder(readSketch(kSketches / GetParam()));
}

TEST_P(PublicSketch, noise_of_detection_changes_nothing_that_matters) {
    const fs::path file = kSketches / GetParam();
    const nlohmann::json json = nlohmann::json::parse(std::ifstream(file));
    std::mt19937 random(11);
    std::uniform_real_distribution<double> shift(-0.05, 0.05);
    for (int k = 0; k < 20; ++k) {
        Sketch sketch = readSketch(file);
        // Ends off by up to 0.05 in each way: lengths by up to 0.1.
        for (Wall& w : sketch.walls)
            for (glm::dvec2* p : {&w.a, &w.b}) *p += glm::dvec2(shift(random), shift(random));
        for (Arc& a : sketch.arcs) {
            a.center += glm::dvec2(shift(random), shift(random));
            a.radius += shift(random);
            a.a0Deg += shift(random) / a.radius * 57.3;
            a.a1Deg += shift(random) / a.radius * 57.3;
        }
        checkExpected(sketch, json["expect"]);
        if (HasFailure()) FAIL() << "with noise " << k;
    }
}

INSTANTIATE_TEST_SUITE_P(All, PublicSketch,
                         testing::Values("p01_rect_tight.json", "p02_rect_gaps.json", "p03_rect_overlap.json",
                                         "p04_L.json", "p05_T_two_rooms.json", "p06_U.json", "p07_cross.json",
                                         "p08_cubicle.json", "p09_D_curved.json",
                                         "p10_window_over_joint.json", "p11_two_buildings.json",
                                         "p12_empty.json"));

TEST(Closure, photographed_sketches_close) {
    for (const char* file : {"i01_mixed.sketch.json", "i02_pinwheel.sketch.json"}) {
        const Closure closure = closeSketch(readSketch(kSketches / file));
        EXPECT_EQ(closure.report.outcome, Outcome::ok) << closure.report.message;
        expectProven(closure);
        EXPECT_EQ(closure.report.rooms.size(), 1u);
    }
}

TEST(Closure, free_standing_tall_wall_makes_a_torus) {
    Sketch s = box(-8, -6, 8, 6);
    s.walls.push_back(wall("island", {-2, 0}, {2, 0}));
    const Closure c = closeSketch(s);
    expectProven(c);
    ASSERT_EQ(c.report.rooms.size(), 1u);
    EXPECT_EQ(c.report.rooms[0].euler, 0);
    EXPECT_NEAR(c.report.rooms[0].floorAreaFt2, net(16, 12) - 4 * 0.375, 1e-6);
    EXPECT_EQ(roleOf(c.report, "island"), "interior");
}

// Four walls that end on one another's centre lines, but for 1.3 mm: seen from outside their corners are not
// filled by wall, and are shown as wall.
TEST(Closure, outer_corners_of_an_island_are_shown_as_its_walls_are) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> off(-0.05, 0.05);
    for (int copy = 0; copy < 8; ++copy) {
        Sketch s = box(-12, -10, 12, 10);
        const std::array<glm::dvec2, 4> corner{{{-4, -3}, {4, -3}, {4, 3}, {-4, 3}}};
        const auto near = [&](glm::dvec2 p) {
            for (int k = 0; k < 2; ++k) p[k] += off(random);
            return p;
        };
        for (size_t k = 0; k < 4; ++k) {
            Wall& island =
                s.walls.emplace_back(wall("i" + std::to_string(k), corner[k], corner[(k + 1) % 4]));
            island.a = near(island.a);
            island.b = near(island.b);
        }
        const Closure c = closeSketch(s);
        expectProven(c);
        for (const Face& face : c.building->faces)
            EXPECT_TRUE(face.role == Role::projection || std::abs(faceNormal(*c.building, face).y) > 0.5)
                << copy;
    }
}

TEST(Closure, door_stays_open_and_crack_is_filled) {
    for (const double hole : {0.8, 2.5}) {
        Sketch s = box(-8, -6, 8, 6);
        s.walls.push_back(wall("a", {0, -6}, {0, -hole / 2}));
        s.walls.push_back(wall("b", {0, hole / 2}, {0, 6}));
        const Closure c = closeSketch(s);
        expectProven(c);
        EXPECT_EQ(c.report.rooms.size(), hole < 1 ? 2u : 1u) << hole;
    }
}

TEST(Closure, gap_of_any_width_in_an_exterior_wall_is_filled) {
    for (const double gap : {0.5, 1.5, 3.0, 5.0, 7.0}) {
        Sketch s = box(-8, -6, 8, 6);
        s.walls[0] = wall("s1", {-8.1875, -6}, {-gap / 2, -6});
        s.walls.push_back(wall("s2", {gap / 2, -6}, {8.1875, -6}));
        const Closure c = closeSketch(s);
        expectProven(c);
        ASSERT_EQ(c.report.rooms.size(), 1u) << gap;
        EXPECT_NEAR(c.report.rooms[0].floorAreaFt2, net(16, 12), 1e-3) << gap;
    }
}

// Whoever lays a wall across the end of a slot means the slot; without that, or closed at both ends, it is a
// crack between walls side by side.
TEST(Closure, a_niche_is_as_wide_as_it_was_laid) {
    const auto outline = [](const std::vector<glm::dvec2>& p) {
        Sketch s;
        for (size_t i = 0; i < p.size(); ++i)
            s.walls.push_back(wall("w" + std::to_string(i), p[i], p[(i + 1) % p.size()]));
        return s;
    };
    for (const double width : {0.6, 0.8, 1.0, 1.1, 1.3, 2.0})
        for (const double depth : {0.6, 2.0, 4.0}) {
            const double h = (width + 0.375) / 2;
            const Closure closure = closeSketch(outline(
                {{-8, -6}, {8, -6}, {8, 6}, {h, 6}, {h, 6 + depth}, {-h, 6 + depth}, {-h, 6}, {-8, 6}}));
            ASSERT_EQ(closure.report.rooms.size(), 1u);
            EXPECT_NEAR(closure.report.rooms[0].floorAreaFt2, net(16, 12) + width * depth, 0.02)
                << width << " x " << depth;
        }
    for (const bool capped : {false, true}) { // two walls 0.6 in apart from the facade into the room
        Sketch s = box(-8, -6, 8, 6);
        s.walls.push_back(wall("p", {-0.4875, 6}, {-0.4875, 1}));
        s.walls.push_back(wall("q", {0.4875, 6}, {0.4875, 1}));
        if (capped) s.walls.push_back(wall("cap", {-0.4875, 1}, {0.4875, 1}));
        const Closure closure = closeSketch(s);
        ASSERT_EQ(closure.report.rooms.size(), 1u);
        const double length = capped ? 5.0 : 4.8125; // from the facade's face
        EXPECT_NEAR(closure.report.rooms[0].floorAreaFt2, net(16, 12) - 1.35 * length, 0.1);
    }
}

TEST(Closure, garden_wall_encloses_nothing) {
    Sketch s = box(-8, -6, 2, 6);
    s.walls.push_back(wall("garden", {7, -5}, {7, 5}));
    const Closure c = closeSketch(s);
    expectProven(c);
    ASSERT_EQ(c.report.rooms.size(), 1u);
    EXPECT_EQ(roleOf(c.report, "garden"), "outside_extra");
    EXPECT_NE(c.report.message.find("garden"), std::string::npos);
}

TEST(Closure, curls_close_at_their_mouths) {
    // Areas of the outlines that a person would draw round the inner faces; facets of arcs take 0.5 % at
    // most.
    struct Case {
        const char* file;
        double area;
        int euler;
    };
    const double pi = 3.14159265358979;
    for (const Case& c :
         {Case{"spiral.json", net(20, 20) - 0.375 * (15 + 10 + 10 + 5) + 0.375 * 0.1875, 2},
          Case{"s_curve.json", 16 * 12 - 0.375 * (12 + 8) + 0.375 * 0.1875 - 0.1875 * pi * 8, 2},
          Case{"three_arcs.json", pi * 7.8125 * 7.8125, 2}}) {
        const Closure closure = closeSketch(readSketch(kSketches / c.file));
        expectProven(closure);
        ASSERT_EQ(closure.report.rooms.size(), 1u) << c.file;
        EXPECT_NEAR(closure.report.rooms[0].floorAreaFt2, c.area, 0.01 * c.area) << c.file;
        EXPECT_EQ(closure.report.rooms[0].euler, c.euler) << c.file;
    }
}

TEST(Closure, garden_wall_in_line_with_a_facade_stays_outside) {
    const Closure c = closeSketch(readSketch(kSketches / "garden_l.json"));
    expectProven(c);
    EXPECT_EQ(c.report.rooms.size(), 1u);
    EXPECT_EQ(roleOf(c.report, "g1"), "outside_extra");
    EXPECT_EQ(roleOf(c.report, "g2"), "outside_extra");
    EXPECT_EQ(roleOf(c.report, "n"), "exterior");
}

TEST(Closure, copies_and_nearly_collinear_pieces_are_one_wall) {
    Sketch s = box(-8, -6, 8, 6);
    s.walls.push_back(wall("copy", {-8.1, -6.08}, {8.1, -5.95}));
    s.walls.push_back(wall("part", {8.06, -3}, {8.02, 3}));
    const Closure c = closeSketch(s);
    expectProven(c);
    ASSERT_EQ(c.report.rooms.size(), 1u);
    EXPECT_NEAR(c.report.rooms[0].floorAreaFt2, net(16, 12), 0.02 * net(16, 12));
    EXPECT_EQ(c.building->faces.size(), 6u);
}

TEST(Closure, a_wall_on_another_is_higher_and_thicker_no_farther_than_it_reaches) {
    Sketch sketch = box(-12, -4, 12, 4, HeightClass::blue);
    sketch.walls[2].heightClass = HeightClass::red;
    sketch.walls.push_back(wall("tall", {-2, -4.05}, {2, -4}));
    sketch.walls.push_back(wall("pier", {6, 4}, {8, 4}));
    sketch.walls.back().thickness = 1;
    sketch.windows = {window("win", "s", 13, 6)}; // over the tall one's end
    const Closure closure = closeSketch(sketch);
    expectProven(closure);
    EXPECT_EQ(closure.report.outcome, Outcome::ok) << closure.report.message;
    ASSERT_EQ(closure.report.rooms.size(), 1u);
    EXPECT_EQ(closure.report.rooms[0].ceilingFt, 8); // of 64 in of wall 36 are low
    EXPECT_NEAR(closure.report.rooms[0].floorAreaFt2, net(24, 8) - 2 * (1 - 0.375) / 2, 0.3);
    EXPECT_EQ(closure.report.windowCount, 1);
    for (const char* id : {"s", "tall", "n", "pier"}) {
        EXPECT_EQ(roleOf(closure.report, id), "exterior") << id;
        EXPECT_EQ(reasonOf(closure.report, id), "") << id;
    }
    sketch.walls.push_back(wall("low", {-6, 4}, {0, 4}, HeightClass::blue));
    EXPECT_EQ(reasonOf(closeSketch(sketch).report, "low"), "repeats n");
}

// Both walls would run on to the corner; as wide as a door it is one between rooms, and a gap in a facade.
TEST(Closure, door_in_a_corner_stays_open_within_and_is_filled_outside) {
    for (const double bend : {20.0, 45.0, 70.0})
        for (const double opening : {1.2, 2.25, 2.6}) {
            const double turn = bend * std::numbers::pi / 180, reach = opening / 2 / std::cos(turn / 2);
            const glm::dvec2 out{std::sin(turn), std::cos(turn)};
            const double length = std::min(12 / out.x, 10 / out.y);
            Sketch sketch = box(-12, -10, 12, 10);
            sketch.walls.push_back(wall("straight", {0, -10}, {0, -reach}));
            sketch.walls.push_back(wall("turned", reach * out, length * out));
            const Closure within = closeSketch(sketch);
            expectProven(within);
            EXPECT_EQ(within.report.rooms.size(), opening < 2 ? 2u : 1u) << bend << " " << opening;
            std::erase_if(sketch.walls, [](const Wall& w) { return w.id == "w"; });
            sketch.walls[0].a.x = -0.1875; // south and north begin at the divider, now the facade
            sketch.walls[2].b.x = length * out.x - 0.1;
            const Closure outside = closeSketch(sketch);
            expectProven(outside);
            EXPECT_EQ(outside.report.rooms.size(), 1u) << bend << " " << opening;
        }
}

TEST(Closure, what_cannot_enclose_is_refused_with_a_reason) {
    Sketch one;
    one.walls = {wall("lonely", {-5, 0}, {5, 0})};
    EXPECT_EQ(closeSketch(one).report.code, "NOT_ENCLOSED");
    EXPECT_NE(closeSketch(one).report.message.find("lonely"), std::string::npos);
    Sketch parallel;
    parallel.walls = {wall("a", {-5, -2}, {5, -2}), wall("b", {-5, 2}, {5, 2})};
    EXPECT_EQ(closeSketch(parallel).report.code, "NOT_ENCLOSED");
    EXPECT_EQ(closeSketch(box(-5, -5, 5, 5, HeightClass::green)).report.code, "ONLY_PARTITIONS");
    Sketch point;
    point.walls = {wall("dot", {1, 1}, {1, 1})};
    EXPECT_EQ(closeSketch(point).report.code, "NO_WALLS");
    EXPECT_NE(closeSketch(point).report.message.find("dot"), std::string::npos);
}

TEST(Closure, walls_that_take_no_part_have_a_reason) {
    Sketch s = box(-8, -6, 8, 6);
    s.walls.push_back(wall("far", {30, -3}, {30, 3}));
    s.walls.push_back(wall("dot", {1, 1}, {1, 1}));
    s.walls.push_back(wall("copy", {-8.1, -6.05}, {8.1, -5.95}));
    s.walls.push_back(wall("piece", {8, -2}, {8, 3}));
    s.walls.push_back(wall("garden", {-8, 9}, {8, 9}));
    s.walls.push_back(wall("hedge", {-8, -9}, {8, -9}, HeightClass::green));
    const ClosureReport report = closeSketch(s).report;
    const std::vector<WallRole> expected{{"far", "ignored", "lies off the table"},
                                         {"dot", "ignored", "has no length"},
                                         {"copy", "exterior", "repeats s"},
                                         {"piece", "exterior", "repeats e"},
                                         {"garden", "outside_extra", "encloses nothing"},
                                         {"hedge", "outside_extra", "stands in no room"},
                                         {"n", "exterior", ""}};
    for (const WallRole& wall : expected) {
        EXPECT_EQ(roleOf(report, wall.id), wall.role) << wall.id;
        EXPECT_EQ(reasonOf(report, wall.id), wall.reason) << wall.id;
        if (!wall.reason.empty()) {
            EXPECT_NE(report.message.find(wall.id), std::string::npos) << report.message;
        }
    }

    Sketch open; // a refusal names what was ignored: it may be why
    open.walls = {wall("a", {-5, 0}, {5, 0}), wall("b", {-5, 30}, {5, 30})};
    const ClosureReport refused = closeSketch(open).report;
    EXPECT_EQ(refused.code, "NOT_ENCLOSED");
    EXPECT_NE(refused.message.find("b is ignored: it lies off the table"), std::string::npos)
        << refused.message;
    EXPECT_EQ(reasonOf(refused, "a"), "encloses nothing");
}

TEST(Closure, copies_of_arcs_are_named) {
    Sketch s;
    for (const auto& [id, from, to] : {std::tuple("ring", 0.0, 360.0), {"part", 350.0, 420.0}}) {
        Arc arc;
        arc.id = id;
        arc.radius = 5;
        arc.a0Deg = from;
        arc.a1Deg = to;
        s.arcs.push_back(arc);
    }
    const ClosureReport report = closeSketch(s).report;
    EXPECT_EQ(reasonOf(report, "part"), "repeats ring");
    EXPECT_EQ(reasonOf(report, "ring"), "");
}

// Posts of 0.3 in stand between windows of one wall, but over a joint of two walls a gap is none.
TEST(Closure, markers_of_one_wall_are_one_window_only_where_they_touch) {
    Sketch sketch = box(-8, -6, 8, 6);
    const std::string wall = sketch.walls[0].id;
    const auto windows = [&](double gap) {
        sketch.windows = {window("one", wall, 5, 3), window("two", wall, 8 + gap, 3)};
        return closeSketch(sketch).report.windowCount;
    };
    EXPECT_EQ(windows(0), 1);
    EXPECT_EQ(windows(0.1), 1);
    EXPECT_EQ(windows(0.3), 2);
    Wall rest = sketch.walls[0];
    const glm::dvec2 joint = rest.a + 6.6 * glm::normalize(rest.b - rest.a);
    sketch.walls[0].b = rest.a = joint;
    rest.id = "rest";
    sketch.walls.push_back(rest);
    sketch.windows = {window("one", wall, 5, 3), window("two", "rest", 1.7, 3)};
    EXPECT_EQ(closeSketch(sketch).report.windowCount, 1);
}

TEST(Closure, a_window_that_reaches_far_beyond_its_wall_is_named) {
    const auto codeOf = [](const WindowMarker& marker) {
        Sketch s = box(-10, -6, 10, 6);
        s.walls.push_back(wall("tail", {10, -6}, {18, -6})); // runs on outside
        s.windows = {marker};
        const Closure closure = closeSketch(s);
        expectProven(closure);
        return closure.report.code;
    };
    EXPECT_EQ(codeOf(window("fits", "n", 10, 20)), "OK");
    EXPECT_EQ(codeOf(window("to_the_corner", "n", 0.5, 3)), "OK");
    EXPECT_EQ(codeOf(window("wide", "n", 10, 30)), "WINDOW_BEYOND_WALL");
    EXPECT_EQ(codeOf(window("half", "w", 0.5, 5)), "WINDOW_BEYOND_WALL");
    EXPECT_EQ(codeOf(window("on_the_tail", "tail", 0, 6)), "WINDOW_BEYOND_WALL");
    EXPECT_EQ(codeOf(window("slit", "n", 10, 0.1)), "WINDOW_TOO_NARROW");
}

TEST(Closure, what_is_said_of_a_window_is_taken_back_of_that_alone) {
    Sketch s = box(-10, -6, 10, 6);
    s.walls.push_back(wall("tail", {10, -6}, {18, -6}));
    s.windows = {window("n1 wide", "n", 10, 30), window("n1", "tail", 6, 3)};
    const std::string message = closeSketch(s).report.message;
    EXPECT_NE(message.find("n1 wide reaches"), std::string::npos) << message;
    EXPECT_EQ(message.find("n1 reaches"), std::string::npos) << message;
    EXPECT_NE(message.find("n1 is where its wall encloses nothing"), std::string::npos) << message;
}

TEST(Closure, partitions_may_touch_walls_and_cross_each_other) {
    Sketch s = box(-8, -6, 8, 6);
    s.walls.push_back(wall("g1", {-8, 0}, {0, 0}, HeightClass::green));
    s.walls.push_back(wall("g2", {-4, -3}, {-4, 6}, HeightClass::green));
    const Closure c = closeSketch(s);
    expectProven(c);
    const double footprint = (8 - 0.1875) * 0.375 + (9 - 0.1875) * 0.375 - 0.375 * 0.375;
    EXPECT_NEAR(c.report.rooms[0].floorAreaFt2, net(16, 12) - footprint, 1e-6);
    EXPECT_NEAR(c.report.rooms[0].volumeFt3, net(16, 12) * 10 - footprint * 4, 1e-6);
    EXPECT_EQ(c.report.rooms[0].euler, 2);
    EXPECT_EQ(roleOf(c.report, "g1"), "partition");
}

// Exactly, or all but: apart by less than the eye sees, or overlapping by as much.
TEST(Closure, what_touches_in_a_point_can_be_built) {
    const auto expectBuilt = [](const Closure& c) {
        expectProven(c);
        double least = 1;
        for (const Face& face : c.building->faces)
            for (const auto& t : triangulateFace(*c.building, face)) {
                const glm::dvec3 p = c.building->vertices[t[0]];
                least = std::min(least, 0.5 * glm::length(glm::cross(c.building->vertices[t[1]] - p,
                                                                     c.building->vertices[t[2]] - p)));
            }
        EXPECT_GT(least, 1e-6 * kMetresPerInch * kMetresPerInch);
        EXPECT_NO_THROW(meshBuilding(*c.building, {1000}));
    };
    for (const double off : {0.0, 1e-9, 1e-6, 1e-4, 2e-3, -1e-9, -1e-6, -1e-4, -2e-3}) {
        SCOPED_TRACE(off);
        Sketch corners = box(-8, -6, 8, 6);
        corners.walls.push_back(wall("g1", {-4, -3.8125}, {0, -3.8125}, HeightClass::green));
        corners.walls.push_back(wall("g2", {off, -3.4375 + off}, {4, -3.4375 + off}, HeightClass::green));
        const Closure touching = closeSketch(corners);
        expectBuilt(touching);
        const double footprint = 8 * 0.375;
        EXPECT_NEAR(touching.report.rooms[0].floorAreaFt2, net(16, 12) - footprint, 0.03);

        Sketch slanted = box(-8, -6, 8, 6); // one corner of its end against the wall
        const double h = 0.1875, c45 = std::sqrt(0.5);
        const glm::dvec2 end(-7.8125 + off + h * c45, 0);
        slanted.walls.push_back(wall("g", end, end + 4.0 * glm::dvec2(c45, c45), HeightClass::green));
        expectBuilt(closeSketch(slanted));

        Sketch sky = box(-8, -6, 8, 6);
        for (const double side : {-1.0, 1.0}) {
            Skylight s;
            s.id = side < 0 ? "a" : "b";
            s.center = side * glm::dvec2(1 + off / 2, 1 + off / 2);
            s.size = {2, 2};
            sky.skylights.push_back(s);
        }
        const Closure panes = closeSketch(sky);
        expectBuilt(panes);
        EXPECT_EQ(panes.report.skylightPaneCount, 2);

        Sketch windows = box(-8, -6, 8, 6); // one above the other's end
        for (const double side : {-1.0, 1.0}) {
            WindowMarker w;
            w.id = side < 0 ? "low" : "high";
            w.wall = "s";
            w.pos = 8 + side * (1 + off / 2);
            w.width = 2;
            w.kind = side < 0 ? WindowKind::standard : WindowKind::transom;
            windows.windows.push_back(w);
        }
        const Closure glazed = closeSketch(windows);
        expectBuilt(glazed);
        EXPECT_EQ(glazed.report.windowCount, 2);
        EXPECT_EQ(glazed.report.rooms[0].euler, 2);
    }
}

TEST(Closure, interior_window_is_two_glasses_of_equal_shape) {
    const Closure c = closeSketch(readSketch(kSketches / "p05_T_two_rooms.json"));
    ASSERT_TRUE(c.building);
    int twins = 0;
    for (size_t f = 0; f < c.building->faces.size(); ++f) {
        const Face& face = c.building->faces[f];
        if (face.twin == kNoTwin) continue;
        ++twins;
        const Face& other = c.building->faces[static_cast<size_t>(face.twin)];
        EXPECT_EQ(other.twin, static_cast<int32_t>(f));
        EXPECT_NE(face.room, other.room);
        EXPECT_EQ(face.loops[0].size(), other.loops[0].size());
        EXPECT_TRUE(c.building->materials[face.material].isOpening());
    }
    EXPECT_EQ(twins, 2);
}

// A tower beside a low hall, and one within it: daylight comes in over the roof, not from the hall. A low
// wall between the two, or a window of another kind, joins them.
TEST(Closure, a_transom_above_the_roof_of_a_lower_room_looks_out_over_it) {
    for (const bool within : {false, true}) {
        Sketch s = within ? box(-12, -8, 12, 8, HeightClass::blue) : box(-12, -8, 0, 8, HeightClass::blue);
        const Sketch tower = within ? box(-4, -4, 4, 4) : box(0, -8, 8, 8);
        if (!within) std::erase_if(s.walls, [](const Wall& w) { return w.id == "e"; });
        for (Wall w : tower.walls) {
            w.id += "t";
            s.walls.push_back(w);
        }
        WindowMarker marker;
        marker.id = "window";
        marker.wall = "wt";
        marker.pos = within ? 4 : 8;
        marker.width = 3;
        for (const WindowKind kind : {WindowKind::transom, WindowKind::picture}) {
            marker.kind = kind;
            s.windows = {marker};
            const Closure c = closeSketch(s);
            ASSERT_TRUE(c.building) << c.report.message;
            EXPECT_EQ(c.report.outcome, Outcome::ok) << c.report.message;
            EXPECT_EQ(c.report.windowCount, 1);
            double low = 1e9, high = 0;
            int twins = 0, panes = 0;
            for (const Face& face : c.building->faces) {
                if (!c.building->materials[face.material].isOpening()) continue;
                ++panes;
                twins += face.twin != kNoTwin;
                for (const uint32_t v : face.loops[0]) {
                    low = std::min(low, c.building->vertices[v].y / kMetresPerInch);
                    high = std::max(high, c.building->vertices[v].y / kMetresPerInch);
                }
            }
            const bool transom = kind == WindowKind::transom;
            EXPECT_EQ(panes, transom ? 1 : 2);
            EXPECT_EQ(twins, transom ? 0 : 2);
            EXPECT_NEAR(low, transom ? 8 : 1, 1e-9);
            EXPECT_NEAR(high, transom ? 9 : 7.5, 1e-9);
        }
    }
}

TEST(Closure, chips_are_srgb_and_never_reach_one) {
    Sketch s = box(-8, -6, 8, 6);
    Token floor;
    floor.pos = {1, 1};
    floor.rgb = {255, 188, 0};
    s.tokens = {floor};
    const Closure c = closeSketch(s);
    ASSERT_TRUE(c.building);
    const auto found = std::ranges::find(c.building->materials, "floor", &Material::name);
    ASSERT_NE(found, c.building->materials.end());
    EXPECT_LT(found->reflectance.x, 0.95f);
    EXPECT_NEAR(found->reflectance.y, 0.50289f, 1e-5); // sRGB 188, IEC 61966-2-1
    EXPECT_EQ(found->reflectance.z, 0.0f);
}

TEST(Closure, facets_of_a_curved_wall_stay_within_the_chord_error) {
    const Sketch sketch = readSketch(kSketches / "p09_D_curved.json");
    const double radius =
        sketch.arcs[0].radius - sketch.arcs[0].thickness / 2; // of the face that the room sees
    size_t last = 1000000;
    for (const double error : {0.002, 0.02, 0.2}) {
        ClosureOptions options;
        options.chordError = error;
        const Closure closure = closeSketch(sketch, options);
        ASSERT_TRUE(closure.building);
        size_t facets = 0;
        double farthest = 0;
        for (const Face& face : closure.building->faces) {
            const auto& loop = face.loops[0];
            for (size_t i = 0; i < loop.size(); ++i) {
                const glm::dvec3 a = closure.building->vertices[loop[i]] / kMetresPerInch,
                                 b = closure.building->vertices[loop[(i + 1) % loop.size()]] / kMetresPerInch;
                const auto fromCentre = [&](glm::dvec3 p) {
                    return glm::length(glm::dvec2(p.x, -p.z) - sketch.arcs[0].center);
                };
                // Edges on the floor with both ends on the arc.
                if (a.y > 0 || b.y > 0 || std::min(a.x, b.x) < sketch.arcs[0].center.x - 1e-6 ||
                    std::abs(fromCentre(a) - radius) > error || std::abs(fromCentre(b) - radius) > error)
                    continue;
                ++facets;
                farthest = std::max(farthest, std::abs(fromCentre(0.5 * (a + b)) - radius));
            }
        }
        EXPECT_GT(facets, 0u);
        EXPECT_LE(farthest, error) << facets;
        EXPECT_LT(facets, last); // coarser facets are fewer
        last = facets;
    }
}

TEST(Closure, facets_of_curved_walls_enclose_the_arcs_own_area) {
    Sketch round;
    Arc arc;
    arc.id = "round";
    arc.radius = 5;
    arc.a1Deg = 360;
    round.arcs = {arc};
    Sketch half; // whose ends stay where they are
    arc.a1Deg = 180;
    half.arcs = {arc};
    half.walls = {wall("chord", {-5.1875, 0}, {5.1875, 0})};
    const double r = 5 - 0.1875, y = 0.1875; // the room's side of the wall and of the chord
    const double segment = r * r * std::acos(y / r) - y * std::sqrt(r * r - y * y);
    for (const double error : {0.005, 0.02, 0.06}) {
        ClosureOptions options;
        options.chordError = error;
        const Closure whole = closeSketch(round, options), part = closeSketch(half, options);
        ASSERT_EQ(whole.report.rooms.size(), 1u);
        ASSERT_EQ(part.report.rooms.size(), 1u);
        EXPECT_NEAR(whole.report.rooms[0].floorAreaFt2, std::numbers::pi * r * r, 1e-6);
        // The chord's face cuts the first facet at another place than the arc.
        EXPECT_NEAR(part.report.rooms[0].floorAreaFt2, segment, 0.4 * error);
    }
}

TEST(Closure, options_that_leave_facets_as_they_are_change_nothing) {
    const Sketch sketch = readSketch(kSketches / "three_arcs.json");
    ClosureOptions options, finer, same;
    finer.chordError = 0.005;
    same.chordError = 0.0200001;
    ASSERT_EQ(facetsOfArcs(sketch, options), facetsOfArcs(sketch, same));
    EXPECT_NE(facetsOfArcs(sketch, options), facetsOfArcs(sketch, finer));
    const Closure a = closeSketch(sketch, options), b = closeSketch(sketch, same);
    ASSERT_TRUE(a.building && b.building);
    EXPECT_EQ(a.building->vertices, b.building->vertices);
}

// Drawn to the centre line of the wall, or through it by a hair: what looks out of its other side would be a
// stub in the next room.
TEST(Closure, partitions_end_in_the_wall_that_they_meet) {
    for (const double end : {-0.25, -0.1875, 0.0, 0.15, 0.3, 0.45}) {
        Sketch sketch = box(-12, -8, 12, 8);
        sketch.walls.push_back(wall("divider", {0, -8}, {0, 8}));
        sketch.walls.push_back(wall("green", {-12, 2}, {end, 2}, HeightClass::green));
        const Closure closure = closeSketch(sketch);
        expectProven(closure);
        ASSERT_EQ(closure.report.rooms.size(), 2u);
        const RoomReport &left = closure.report.rooms[0], &right = closure.report.rooms[1];
        const double footprint = 0.375 * net(12, 16) / (16 - 0.375); // as long as the room is wide
        EXPECT_NEAR(left.floorAreaFt2, net(12, 16) - footprint, 1e-6) << end;
        EXPECT_NEAR(right.floorAreaFt2, net(12, 16), 1e-6) << end;
        EXPECT_NEAR(right.volumeFt3, 10 * net(12, 16), 1e-5) << end;
    }
}

// Ends on a grid, turned or not: segments touch, overlap and cross in threes.
TEST(PlanArrangement, of_random_segments_is_whole_whatever_their_order) {
    std::mt19937 random(3);
    for (int round = 0; round < 300; ++round) {
        const double turn = round % 2 * 0.3, c = std::cos(turn), s = std::sin(turn);
        const auto end = [&] {
            const double x = static_cast<double>(random() % 7), y = static_cast<double>(random() % 7);
            return glm::dvec2(c * x - s * y, s * x + c * y);
        };
        std::vector<PlanSegment> segments;
        while (segments.size() < static_cast<size_t>(1 + round % 30)) {
            const PlanSegment segment{end(), end(), static_cast<int32_t>(segments.size())};
            if (segment.a != segment.b) segments.push_back(segment);
        }
        const PlanArrangement map = arrange(segments);
        DisjointSets pieces(map.points.size());
        for (uint32_t h = 0; h < map.target.size(); ++h) {
            pieces.join(map.source(h), map.target[h]);
            EXPECT_EQ(map.source(map.next[h]), map.target[h]);
            EXPECT_EQ(map.cell[map.next[h]], map.cell[h]);
        }
        size_t pieceCount = 0;
        for (uint32_t v = 0; v < map.points.size(); ++v) pieceCount += pieces.root(v) == v;
        EXPECT_EQ(map.points.size() + map.cellCount, map.edgeCount() + 1 + pieceCount); // Euler
        double sum = 0;
        const std::vector<double> areas = cellAreas(map);
        for (uint32_t cell = 0; cell < map.cellCount; ++cell) sum += areas[cell];
        for (uint32_t cell = 1; cell < map.cellCount; ++cell) EXPECT_GT(areas[cell], -1e-12);
        EXPECT_NEAR(sum, 0, 1e-9); // the unbounded cell has that of all others, negative
        std::ranges::shuffle(segments, random);
        const PlanArrangement other = arrange(segments);
        EXPECT_EQ(other.points, map.points);
        EXPECT_EQ(other.next, map.next);
        EXPECT_EQ(other.cell, map.cell);
    }
}

TEST(PlanArrangement, knows_what_lies_in_what) {
    std::vector<PlanSegment> segments;
    for (const double half : {4.0, 3.0, 1.0}) {
        const glm::dvec2 u(half, 0), v(0, half);
        for (const auto& [a, b] : {std::pair(-u - v, u - v), {u - v, u + v}, {u + v, v - u}, {v - u, -u - v}})
            segments.push_back({a, b, static_cast<int32_t>(half)});
    }
    segments.push_back({{-0.5, 0}, {0.5, 0}, 9}); // in the innermost one, bounding nothing
    const PlanArrangement map = arrange(segments);
    EXPECT_EQ(map.cellCount, 4u);
    std::vector<double> areas = cellAreas(map);
    std::ranges::sort(areas);
    EXPECT_EQ(areas, (std::vector<double>{-64, 4, 28, 32}));
}

// Two thirds and one third, rounded once, however fine the numbers are that say where the segments lie.
TEST(PlanArrangement, crossings_are_rounded_once) {
    for (const double unit : {1.0, 0x1p-40, 0x1p-300}) {
        const PlanArrangement map =
            arrange(std::vector<PlanSegment>{{{0, 0}, {2 * unit, unit}, 0}, {{unit, 0}, {0, unit}, 1}});
        ASSERT_EQ(map.points.size(), 5u);
        EXPECT_EQ(map.points[2], unit * glm::dvec2(2 / 3.0, 1 / 3.0)) << unit;
    }
    const PlanArrangement tiny =
        arrange(std::vector<PlanSegment>{{{0, 0}, {8, 4}, 0}, {{4, 0x1p-1000}, {0, 4}, 1}});
    ASSERT_EQ(tiny.points.size(), 5u);
    EXPECT_EQ(tiny.points[2], glm::dvec2(8 / 3.0, 4 / 3.0));
}
