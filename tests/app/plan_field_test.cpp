// Values between the sensors of a plan, and lines of equal value.
#include "engine/app/plan_field.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "engine/app/chart.h"
#include "engine/app/floor_cells.h"
#include "engine/app/plan_chart.h"
#include "engine/app/plan_floors.h"
#include "engine/app/work_plane.h"
#include "geometry/room_measures.h"
#include "tests/geometry/box_model.h"
#include "tests/passes/room_builder.h"

namespace heliodon::test {
namespace {

using app::Sample;

std::vector<Sample> scattered(const std::function<double(glm::dvec2)>& value, double jitter) {
    std::minstd_rand random(5);
    std::uniform_real_distribution<double> shift(-jitter, jitter);
    std::vector<Sample> samples;
    for (int x = 0; x <= 8; ++x)
        for (int y = 0; y <= 8; ++y) {
            const glm::dvec2 p(x + shift(random), y + shift(random));
            samples.push_back({p, value(p)});
        }
    return samples;
}

double rmsError(const std::vector<app::SampleTriangle>& triangles,
                const std::function<double(glm::dvec2)>& value) {
    double sum = 0, weights = 0;
    for (const auto& t : triangles) { // at the middles of triangles, by area
        const glm::dvec2 a = t[1].at - t[0].at, b = t[2].at - t[0].at;
        const double weight = std::abs(a.x * b.y - a.y * b.x);
        const double off =
            (t[0].value + t[1].value + t[2].value) / 3 - value((t[0].at + t[1].at + t[2].at) / 3.0);
        sum += weight * off * off, weights += weight;
    }
    return std::sqrt(sum / weights);
}

TEST(PlanField, a_linear_field_stays_what_it_is) {
    const auto plane = [](glm::dvec2 p) { return 3 * p.x - 2 * p.y + 7; };
    const auto triangles = app::smoothTriangles(scattered(plane, 0.3), 5);
    ASSERT_GT(triangles.size(), 25 * 100u);
    for (const auto& t : triangles)
        for (const Sample& s : t) EXPECT_NEAR(s.value, plane(s.at), 1e-9);
}

TEST(PlanField, floor_cells_cover_what_their_patches_cover) {
    geometry::PatchMesh mesh; // triangles of an L of 6 x 6 squares, up, turned by 20 degrees
    const auto turned = [](double x, double y) {
        return glm::dvec2(0.94 * x - 0.34 * y, 0.34 * x + 0.94 * y);
    };
    const auto add = [&](std::initializer_list<glm::dvec2> corners) {
        for (const glm::dvec2 c : corners) {
            const glm::dvec2 p = turned(c.x, c.y);
            mesh.corners.push_back(static_cast<uint32_t>(mesh.vertices.size()));
            mesh.vertices.emplace_back(p.x, 0, p.y);
        }
        mesh.firstCorner.push_back(static_cast<uint32_t>(mesh.corners.size()));
    };
    const auto isInL = [](double x, double y) {
        return x > 0 && y > 0 && x < 6 && y < 6 && (x < 3 || y < 3);
    };
    std::vector<size_t> patches;
    for (int x = 0; x < 6; ++x)
        for (int y = 0; y < 6; ++y)
            if (isInL(x + 0.5, y + 0.5)) {
                add({{x, y}, {x, y + 1}, {x + 1, y + 1}});
                add({{x, y}, {x + 1, y + 1}, {x + 1, y}});
            }
    for (size_t i = 0; i < mesh.patchCount(); ++i) patches.push_back(i);
    const app::FloorCells cells(mesh, patches);
    for (double x = -3.03; x < 9; x += 0.11)
        for (double y = -3.03; y < 9; y += 0.13)
            EXPECT_EQ(cells.covers(turned(x, y)), isInL(x, y)) << x << " " << y;
    EXPECT_TRUE(cells.covers(turned(2, 2)) && cells.covers(turned(0, 0)) && cells.covers(turned(6, 1)));
    EXPECT_FALSE(app::FloorCells(mesh, {}).covers({0, 0}));
}

TEST(PlanField, a_curved_field_is_met_better_than_by_flat_triangles) {
    const auto wave = [](glm::dvec2 p) { return std::sin(0.7 * p.x) * std::cos(0.6 * p.y); };
    const auto samples = scattered(wave, 0.2);
    // The same points of both: middles of the small triangles.
    auto flat = app::smoothTriangles(samples, 6);
    const double smooth = rmsError(flat, wave);
    const auto coarse = app::smoothTriangles(samples, 1);
    ASSERT_EQ(flat.size(), 36 * coarse.size());
    for (size_t i = 0; i < flat.size(); ++i) {
        const auto& t = coarse[i / 36];
        const glm::dvec2 a = t[1].at - t[0].at, b = t[2].at - t[0].at;
        for (Sample& s : flat[i]) {
            const glm::dvec2 p = s.at - t[0].at;
            const double area = a.x * b.y - a.y * b.x, u = (p.x * b.y - p.y * b.x) / area,
                         v = (a.x * p.y - a.y * p.x) / area;
            s.value = (1 - u - v) * t[0].value + u * t[1].value + v * t[2].value;
        }
    }
    EXPECT_LT(smooth, 0.75 * rmsError(flat, wave));
}

TEST(PlanField, a_patch_of_sun_brings_no_value_that_no_sensor_has) {
    const auto patch = [](glm::dvec2 p) { return p.x > 2.5 && p.x < 5.5 && p.y > 3.5 ? 40000.0 : 800.0; };
    const auto samples = scattered(patch, 0.2);
    for (const auto& t : app::smoothTriangles(samples, 7))
        for (const Sample& s : t) {
            EXPECT_GE(s.value, 800 - 1e-6);
            EXPECT_LE(s.value, 40000 + 1e-6);
            for (const Sample& sensor : samples)
                if (glm::distance(s.at, sensor.at) < 1e-9) {
                    EXPECT_NEAR(s.value, sensor.value, 1e-6);
                }
        }
}

TEST(PlanField, a_hill_has_one_closed_line_and_a_slope_an_open_one) {
    const auto hill = [](glm::dvec2 p) { return 20 - glm::dot(p - 4.0, p - 4.0); };
    const auto triangles = app::smoothTriangles(scattered(hill, 0.1), 6);
    const auto lines = app::isoLines(triangles, 11); // a circle of radius 3
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_LT(glm::distance(lines[0].front(), lines[0].back()), 1e-6);
    for (glm::dvec2 p : lines[0]) EXPECT_NEAR(glm::distance(p, glm::dvec2(4)), 3, 0.1);
    const auto open =
        app::isoLines(app::smoothTriangles(scattered([](glm::dvec2 p) { return p.x; }, 0), 4), 3.3);
    ASSERT_EQ(open.size(), 1u);
    EXPECT_NEAR(glm::distance(open[0].front(), open[0].back()), 8, 1e-6);
    EXPECT_TRUE(app::isoLines(triangles, 1000).empty());
}

TEST(PlanField, colours_reach_a_spacing_around_the_sensors) {
    // A grid reaches the corners of its room.
    const auto grid = scattered([](glm::dvec2) { return 1; }, 0);
    EXPECT_NEAR(app::spacingOf(grid), 1, 1e-12);
    const auto room = app::reachOf(grid, 1 + 1e-9);
    for (glm::dvec2 p : {glm::dvec2(-1, -1), glm::dvec2(9, -1), glm::dvec2(9, 9), glm::dvec2(-1, 9)})
        EXPECT_TRUE(app::isWithin(room, p));
    EXPECT_FALSE(app::isWithin(room, {4, 9.01}));
    // A row is a strip, one sensor a disc, a sharp corner is cut.
    const auto row = app::reachOf({{{0, 0}, 1}, {{2, 2}, 1}, {{1, 1}, 1}}, 0.5);
    EXPECT_TRUE(app::isWithin(row, glm::dvec2(1 + 0.35, 1 - 0.35)));
    EXPECT_FALSE(app::isWithin(row, glm::dvec2(1 + 0.36, 1 - 0.36)));
    EXPECT_TRUE(app::isWithin(row, glm::dvec2(2.35)));
    EXPECT_FALSE(app::isWithin(row, glm::dvec2(2.36)));
    const auto one = app::reachOf({{{3, 3}, 1}}, 0.5);
    EXPECT_TRUE(app::isWithin(one, {3, 3.49}));
    EXPECT_FALSE(app::isWithin(one, {3.4, 3.4}));
    const auto sharp = app::reachOf({{{0, 0}, 1}, {{10, 1}, 1}, {{10, -1}, 1}}, 0.5);
    EXPECT_TRUE(app::isWithin(sharp, {-0.49, 0}));
    EXPECT_FALSE(app::isWithin(sharp, {-0.51, 0}));
    EXPECT_TRUE(app::reachOf({}, 1).empty());
}

TEST(PlanField, what_lies_within_is_the_whole_field_cut) {
    const auto plane = [](glm::dvec2 p) { return 3 * p.x - 2 * p.y + 7; };
    const auto triangles = app::smoothTriangles(scattered(plane, 0), 3);
    const auto cut = app::within(triangles, {{2.1, 1.3}, {5.4, 2.2}, {3.3, 6.7}});
    double area = 0;
    for (const auto& t : cut) {
        const glm::dvec2 a = t[1].at - t[0].at, b = t[2].at - t[0].at;
        area += std::abs(a.x * b.y - a.y * b.x) / 2;
        for (const Sample& s : t) EXPECT_NEAR(s.value, plane(s.at), 1e-9);
    }
    EXPECT_NEAR(area, (3.3 * 5.4 - 0.9 * 1.2) / 2, 1e-9);
    EXPECT_EQ(app::within(triangles, {{-1, -1}, {9, -1}, {9, 9}, {-1, 9}}).size(), triangles.size());
}

TEST(PlanField, what_lies_in_the_sun_is_raised_with_an_exact_edge) {
    const auto plane = [](glm::dvec2 p) { return 3 * p.x - 2 * p.y + 7; };
    const auto triangles = app::smoothTriangles(scattered(plane, 0), 3);
    const std::vector<glm::dvec2> patch{{2.1, 1.3}, {3.3, 6.7}, {5.4, 2.2}},
        beside{{20, 1}, {21, 1}, {20, 2}};
    const auto lit = app::raisedWithin(app::raisedWithin(triangles, patch, 100), beside, 50);
    double area = 0, raised = 0;
    for (const auto& t : lit) {
        const glm::dvec2 a = t[1].at - t[0].at, b = t[2].at - t[0].at,
                         middle = (t[0].at + t[1].at + t[2].at) / 3.0;
        const double one = std::abs(a.x * b.y - a.y * b.x) / 2, more = t[0].value - plane(t[0].at);
        area += one, raised += one * more / 100;
        if (one < 1e-9) continue; // a sliver along the edge, whose middle may lie on either side
        const bool inside = app::isWithin({patch[0], patch[2], patch[1]}, middle);
        for (const Sample& s : t) EXPECT_NEAR(s.value, plane(s.at) + (inside ? 100 : 0), 1e-9);
    }
    EXPECT_NEAR(area, 64, 1e-9);
    EXPECT_NEAR(raised, app::areaOf(patch), 1e-5);
    EXPECT_EQ(app::raisedWithin(triangles, beside, 50).size(), triangles.size());
}

TEST(PlanField, edges_are_where_the_value_differs) {
    // Two squares of one value that share half a side, and one of another beside them.
    const std::vector<std::vector<glm::dvec2>> polygons{
        {{0, 0}, {2, 0}, {2, 2}, {0, 2}}, {{2, 1}, {2, 3}, {4, 3}, {4, 1}}, {{4, 1}, {5, 1}, {5, 3}, {4, 3}}};
    double length = 0;
    for (const auto& [a, b] : app::stepsBetween(polygons, {1, 1, 7}, 1e-9)) {
        length += glm::distance(a, b);
        const glm::dvec2 middle = 0.5 * (a + b);
        EXPECT_FALSE(middle.x > 1.9 && middle.x < 2.1 && middle.y > 1 && middle.y < 2);
    }
    EXPECT_NEAR(length, (8 - 1) + (8 - 1) + 6, 1e-9); // the side between 1 and 7 is told from both
}

TEST(PlanField, areas_of_one_colour_are_outlined_once) {
    // Squares around an empty one, every other one the wrong way round.
    std::vector<std::vector<glm::dvec2>> ring;
    for (int x = 0; x < 3; ++x)
        for (int y = 0; y < 3; ++y) {
            if (x == 1 && y == 1) continue;
            ring.push_back({{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}});
            if (x == y) std::reverse(ring.back().begin(), ring.back().end());
        }
    const auto outlines = app::unitedOutlines(ring, 0.01);
    ASSERT_EQ(outlines.size(), 2u);
    EXPECT_EQ(outlines[0].size() + outlines[1].size(), 16u);
    double area = 0;
    for (const auto& outline : outlines)
        for (size_t k = 0; k < outline.size(); ++k) {
            const glm::dvec2 a = outline[k], b = outline[(k + 1) % outline.size()];
            area += (a.x * b.y - a.y * b.x) / 2;
        }
    EXPECT_NEAR(area, 8, 1e-9);
}

size_t count(const std::string& text, const std::string& words) {
    size_t found = 0;
    for (size_t at = 0; (at = text.find(words, at)) != std::string::npos; ++at) ++found;
    return found;
}

// The line at 500 runs fifteen pixels before a wall: nearer than numbers are put as long as there is a
// choice.
TEST(PlanChart, a_level_without_a_number_gets_one_where_it_fits) {
    app::Scene scene;
    scene.worldPerBuilding = 1;
    RoomBuilder room;
    room.box({0, 0, 0}, {4, 2.5, 3}, 2, [](int, int) { return kWhite; });
    scene.mesh = room.mesh;
    std::vector<glm::dvec3> points, normals;
    std::vector<double> lux;
    for (const double x : {0.01, 0.04, 0.07, 0.1, 0.13, 0.4, 1.0, 1.6, 2.2, 2.8, 3.4, 3.9})
        for (double z = 0.05; z < 3; z += 0.2) {
            points.emplace_back(x, 0.8, z);
            normals.emplace_back(0, 1, 0);
            lux.push_back(x < 0.15 ? 900 - 400 * x / (15.0 / 180) : 276 - 40 * x);
        }
    app::ValueScale scale;
    scale.low = 100, scale.high = 1000, scale.logarithmic = true, scale.unit = "lux",
    scale.ticks = {200, 500};
    const std::string svg = app::planChart(scene, {points, normals, lux}, scale, "", "").chart.svg();
    EXPECT_EQ(count(svg, ">200<"), 2u); // beside the scale, and on the line
    EXPECT_EQ(count(svg, ">500<"), 2u);
}

// A room of 100 lux and, partly over it, one of 900: no line at 500 lies between their sensors.
TEST(PlanChart, storeys_are_drawn_side_by_side) {
    app::Scene scene;
    scene.worldPerBuilding = 1;
    RoomBuilder room;
    const auto white = [](int, int) { return kWhite; };
    room.box({0, 0, 0}, {4, 2.5, 3}, 2, white, 0);
    room.box({1, 3, 0}, {4, 2.5, 3}, 2, white, 1);
    room.box({-3, 3, 0}, {3, 2.5, 3}, 2, white, 2); // over no room, as high as the second
    scene.mesh = room.mesh;
    std::vector<glm::dvec3> points, normals;
    std::vector<double> lux;
    for (double x = -2.75; x < 5; x += 0.5)
        for (double z = 0.25; z < 3; z += 0.5)
            for (const bool upper : {false, true})
                if (upper ? x < 0 || x > 1 : x > 0 && x < 4) {
                    points.emplace_back(x, upper ? 3.8 : 0.8, z);
                    normals.emplace_back(0, 1, 0);
                    lux.push_back(upper ? 900 : 100);
                }
    app::ValueScale scale;
    scale.low = 50, scale.high = 1000, scale.logarithmic = true, scale.unit = "lux", scale.ticks = {500};
    const app::Plan plan = app::planChart(scene, {points, normals, lux}, scale, "", "");
    EXPECT_EQ(plan.shown, points.size()); // those at one place, too
    const std::string svg = plan.chart.svg();
    EXPECT_EQ(count(svg, ">floors from "), 2u);
    EXPECT_EQ(count(svg, ">500<"), 1u); // beside the scale
}

// A cupboard on feet and a lamp above the sensors' plane: it cuts the one, and the room's walls.
TEST(PlanChart, what_the_sensors_plane_cuts_is_no_floor) {
    app::Scene scene;
    scene.worldPerBuilding = 1;
    RoomBuilder room;
    room.box({0, 0, 0}, {4, 2.5, 3}, 2, [](int, int) { return kWhite; });
    const auto solid = [&](glm::dvec3 low, glm::dvec3 high) {
        const glm::dvec3 size = high - low, x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
        for (const auto& [u, v] : {std::pair(x, z), std::pair(y, x), std::pair(z, y)}) {
            room.wall(low, u, v, 1, 1);
            room.wall(high, -v, -u, 1, 1);
        }
    };
    solid({1, 0.1, 1}, {1.5, 2, 2});
    solid({2.5, 1.5, 1}, {3, 1.7, 2});
    scene.mesh = room.mesh;
    std::vector<glm::dvec3> points, normals;
    for (double x = 0.25; x < 4; x += 0.5)
        for (double z = 0.25; z < 3; z += 0.5)
            if (x < 1 || x > 1.5) points.emplace_back(x, 0.8, z), normals.emplace_back(0, 1, 0);
    const std::vector<double> lux(points.size(), 100);
    const auto floors = app::planFloors(scene, {points, normals, lux});
    ASSERT_EQ(floors.size(), 1u);
    for (const auto& [at, open] :
         {std::pair(glm::dvec2(1.2, 1.4), false), std::pair(glm::dvec2(0.9, 1.4), true),
          std::pair(glm::dvec2(1.6, 1.4), true), std::pair(glm::dvec2(1.2, 2.1), true),
          std::pair(glm::dvec2(2.7, 1.4), true), std::pair(glm::dvec2(4.1, 1.4), false)})
        EXPECT_EQ(floors[0].isOpenAt(at), open) << at.x << ' ' << at.y;
    double length = 0;
    for (const auto& [a, b] : floors[0].outline) length += glm::distance(a, b);
    EXPECT_NEAR(length, 2 * (4 + 3) + 2 * (0.5 + 1), 1e-9);
}

TEST(PlanChart, stages_are_floor_and_no_counters_that_are_lower_than_sensors_over_them) {
    test::BoxModel model(4, {1, -1.5, 1}, {3.5, 0, 4});
    model.add({4, 0, 0}, {6, 0.9, 5});
    model.add({0, 0, 0}, {0.6, 1.1, 5}); // a counter
    app::Scene scene;
    scene.worldPerBuilding = 1;
    scene.mesh = geometry::ownTriangles(model.building());
    const app::SensorTable table =
        app::workPlaneSensors(scene.mesh, geometry::UpAxis::y, {.worldPerBuilding = 1});
    const std::vector<double> lux(table.points.size(), 100);
    const auto floors = app::planFloors(scene, {table.points, table.normals, lux});
    ASSERT_EQ(floors.size(), 1u);
    for (const auto& [at, open] :
         {std::pair(glm::dvec2(0.3, 2.1), false), std::pair(glm::dvec2(0.8, 2.1), true),
          std::pair(glm::dvec2(2.1, 2.2), true), std::pair(glm::dvec2(5.1, 2.1), true)})
        EXPECT_EQ(floors[0].isOpenAt(at), open) << at.x << ' ' << at.y;
}

TEST(LuxScale, holds_the_largest_of_a_few_values) {
    std::vector<double> lux(150, 300.0);
    lux[7] = 4200;
    lux[8] = 40;
    const app::ValueScale scale = app::luxScale(lux);
    EXPECT_EQ(scale.high, 5000);
    EXPECT_EQ(scale.low, 200);
    lux.resize(2000, 300); // of many, one that stands out leaves the others their colours
    EXPECT_EQ(app::luxScale(lux).high, 1000);
}

TEST(WorkPlane, tables_have_no_negative_zero) {
    const glm::dvec3 up = app::modelFromWorld({0, 1, 0}, geometry::UpAxis::z);
    EXPECT_EQ(up, glm::dvec3(0, 0, 1));
    EXPECT_FALSE(std::signbit(up.y));
}

} // namespace
} // namespace heliodon::test
