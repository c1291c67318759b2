// Light that what stands outside of windows reflects into rooms.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "compute/annual_daylight.h"
#include "compute/daylight_transport.h"
#include "compute/outside_reflection.h"
#include "tests/compute/outside_scenes.h"
#include "tests/compute/path_tracer.h"
#include "tests/compute/skies.h"
#include "tests/gpu/test_device.h"

namespace heliodon::compute {
namespace {

using glm::dvec3;

constexpr double kPi = std::numbers::pi;

const std::vector<Sensor> kSensors{{{2, 0.8, 1}, {0, 1, 0}},
                                   {{2, 0.8, 2.5}, {0, 1, 0}},
                                   {{2, 1.5, 4.9}, {0, 0, -1}},
                                   {{0.1, 1.2, 1}, {1, 0, 0}}};
// Overcast; in the sun that reaches no window but what stands opposite; sun from the side.
std::vector<daylight::Sky> skies() {
    return {test::overcast(), test::sunny({0.3, 0.5, 0.8}), test::sunny({0.8, 0.6, -0.5})};
}

geometry::PatchMesh sceneOf(const std::string& what) {
    geometry::PatchMesh mesh = test::roomWithWindow(1);
    test::addOutside(mesh, what);
    return mesh;
}

// Of one luminance all round.
daylight::Sky furnace(double luminance) {
    daylight::Sky sky;
    sky.formula.scale = sky.ground.luminance = luminance;
    return sky;
}

double lux(glm::vec3 rgb) {
    return photometric(rgb);
}

struct Traced {
    const char* scene;
    struct {
        double lux, standardError;
    } at[3][4]; // skies, sensors
};
// By tests/compute/path_tracer.h, 900,000 paths each, of withOutsideAsPatches().
constexpr Traced kTraced[] = {
    {"facade",
     {{{556.89, 0.5}, {116.38, 0.4}, {126.54, 0.36}, {309.78, 0.66}},
      {{4781, 3.7}, {1265.8, 2.2}, {1465.6, 4.5}, {2113, 2.8}},
      {{1530.6, 1.4}, {617.37, 1.6}, {743.2, 1.3}, {2906.4, 2.9}}}},
    {"reveal",
     {{{733.37, 0.63}, {171.77, 0.43}, {153.09, 0.35}, {306.03, 0.7}},
      {{1144.2, 0.71}, {439.63, 0.76}, {563.54, 1.2}, {822.76, 1.4}},
      {{2697.6, 3.4}, {906.08, 2.9}, {979.7, 2.4}, {3036.1, 4.1}}}},
    {"overhang",
     {{{457.32, 0.35}, {142.23, 0.31}, {144.63, 0.3}, {255.69, 0.34}},
      {{1139.4, 1.5}, {476.31, 1.1}, {637.65, 0.96}, {926.92, 0.79}},
      {{1802.3, 1.5}, {640.47, 1.2}, {773.93, 1.5}, {2496.3, 1.8}}}},
    {"fins",
     {{{1024.9, 0.35}, {201.12, 0.28}, {161.75, 0.37}, {252.47, 0.9}},
      {{1220.4, 1.3}, {459.41, 0.97}, {572.35, 0.88}, {461.77, 0.93}},
      {{2985.6, 2}, {906.57, 1.3}, {945.87, 2.8}, {1465.5, 3.4}}}},
    {"court",
     {{{280.23, 0.55}, {81.471, 0.27}, {80.933, 0.27}, {142.79, 0.41}},
      {{3412.9, 3.3}, {935.8, 0.87}, {1103.5, 2.9}, {673.91, 2.2}},
      {{698.76, 1.4}, {252.55, 0.97}, {220.34, 0.43}, {364.17, 1.4}}}},
    {"street",
     {{{443.01, 0.77}, {119.77, 0.54}, {119.94, 0.6}, {240.2, 0.43}},
      {{6718.7, 4.2}, {1666.3, 4.2}, {1660.7, 4.2}, {3650.6, 3.7}},
      {{977.96, 1.6}, {278.31, 0.84}, {268, 0.57}, {563.87, 1.2}}}},
    {"all",
     {{{165.66, 0.39}, {64.479, 0.25}, {87.224, 0.23}, {65.506, 0.4}},
      {{1779.8, 2}, {673.48, 2.6}, {1170, 3.3}, {532.83, 1.9}},
      {{651.28, 1.7}, {260.31, 0.89}, {271.89, 1.2}, {320.15, 1.2}}}},
};

TEST(OutsideReflection, rooms_have_the_light_of_traced_paths) {
    for (const Traced& traced : kTraced) {
        DaylightTransport transport(test::device(), sceneOf(traced.scene));
        transport.setSensors(kSensors);
        double squares = 0;
        for (size_t k = 0; k < 3; ++k) {
            const Moment moment = transport.light(skies()[k]);
            for (size_t s = 0; s < kSensors.size(); ++s) {
                const auto& [truth, noise] = traced.at[k][s];
                const double here = lux(moment.sensors[s].total());
                squares += std::pow(here / truth - 1, 2);
                EXPECT_NEAR(here, truth, double{moment.sensors[s].error} + 3 * noise)
                    << traced.scene << ", sky " << k << ", sensor " << s;
            }
        }
        EXPECT_LT(std::sqrt(squares / 12), 0.02) << traced.scene;
    }
}

// Twelve louvres of 20 cm, 9 cm apart: nearly all light comes by way of their white sides, where it falls off
// within less than their depth.
TEST(OutsideReflection, light_falls_off_between_boards) {
    struct {
        double lux, standardError; // 225,000 paths each
    } constexpr traced[4][6] = {
        {{229.82, 1.6}, {99.989, 0.86}, {121.94, 0.59}, {183.45, 0.98}, {117.22, 0.98}, {1659.9, 2.5}},
        {{3117.4, 14}, {1231.7, 10}, {1336.4, 7}, {1988.6, 11}, {2135.5, 7.3}, {21269, 16}},
        {{1694.7, 8.9}, {648.26, 5.8}, {767.04, 4.9}, {1808.8, 11}, {901.13, 8.6}, {11977, 24}},
        {{905.63, 7.4}, {337.31, 2.6}, {433.79, 2.2}, {679.99, 5.1}, {469.55, 4.9}, {6543.3, 14}},
    };
    geometry::PatchMesh mesh = test::roomWithWindow(1);
    for (int k = 0; k < 12; ++k) {
        const double y = 1 + 0.09 * (k + 0.25);
        test::standOutside(mesh, {{0.9, y, -0.22}, {0.9, y, -0.02}, {3.1, y, -0.02}, {3.1, y, -0.22}}, 0.8f,
                           true);
    }
    DaylightTransport transport(test::device(), mesh);
    std::vector<Sensor> sensors = kSensors;
    sensors.push_back({{2, 2.9, 1.5}, {0, -1, 0}}), sensors.push_back({{2, 1.5, 0.3}, {0, 0, -1}});
    transport.setSensors(sensors);
    const std::vector<daylight::Sky> skies{test::overcast(), test::sunny({0.3, 0.5, -0.8}),
                                           test::sunny({0.8, 0.6, -0.5}), test::sunny({0.1, 1.2, -0.4})};
    double squares = 0;
    for (size_t k = 0; k < 4; ++k) {
        const Moment moment = transport.light(skies[k]);
        for (size_t s = 0; s < 6; ++s) {
            const auto& [truth, noise] = traced[k][s];
            const double here = lux(moment.sensors[s].total());
            squares += std::pow(here / truth - 1, 2);
            EXPECT_NEAR(here, truth, double{moment.sensors[s].error} + 3 * noise) << k << ' ' << s;
        }
    }
    EXPECT_LT(std::sqrt(squares / 24), 0.025); // with a cell or two across their depth: 0.48
}

// Lambert's formula for the window, Kepler's law for the wall: it is as bright as all that lights it.
TEST(OutsideReflection, a_wall_that_fills_the_view_in_an_even_world) {
    geometry::PatchMesh mesh = test::roomWithWindow(1);
    geometry::Material& hole = mesh.materials[1];
    hole.transmittance = glm::vec3(1), hole.refractiveIndex = 1;
    test::wallOutside(mesh, {5000, -100}, {-5000, -100}, -5000, 5000, 0.4f);
    DaylightTransport transport(test::device(), mesh);
    transport.setSensors({{{2, 1.5, 2}, {0, 0, -1}}, {{2, 1.5, 4}, {0, 0, -1}}});
    const Moment moment = transport.light(furnace(1000));
    for (size_t s = 0; s < 2; ++s) {
        const double away = s == 0 ? 2 : 4, x = 1 / std::hypot(1, away), y = 0.5 / std::hypot(0.5, away);
        const double quarter =
            (x * std::atan(0.5 / std::hypot(1, away)) + y * std::atan(1 / std::hypot(0.5, away))) / (2 * kPi);
        const double expected = 0.4 * kPi * 1000 * 4 * quarter;
        EXPECT_NEAR(lux(moment.sensors[s].ground), expected, 3e-3 * expected); // the room hides a little
        EXPECT_NEAR(lux(moment.sensors[s].sky), 0, 1e-6 * expected);
    }
}

// A sky that lights an open field by one lux.
struct UnderEvenSky {
    explicit UnderEvenSky(const geometry::PatchMesh& mesh) : scene(mesh) {}
    std::vector<float> straight() const { // on cells
        return reflection.skyLight(std::vector<double>(sky.elementCount(), 1 / kPi));
    }

    PointScene scene;
    daylight::SkyPatches sky{2};
    OutsideReflection reflection{scene, sky};
};

// Nothing outside is brighter than what lights it, however often light goes to and fro.
TEST(OutsideReflection, an_enclosure_sends_no_more_than_it_gets) {
    geometry::PatchMesh mesh = test::roomWithWindow(1);
    for (const float x : {-0.5f, 4.5f})
        test::wallOutside(mesh, {x, x < 0 ? -6 : 0}, {x, x < 0 ? 0 : -6}, -3, 9, 0.99f);
    test::wallOutside(mesh, {4.5, -6}, {-0.5, -6}, -3, 9, 0.99f);
    const UnderEvenSky world(mesh);
    const std::vector<float> straight = world.straight();
    std::vector<glm::vec3> lit;
    for (const float one : straight) lit.emplace_back(one);
    const std::vector<glm::vec3> sent = world.reflection.exitance(lit);
    double mean = 0, once = 0;
    for (size_t c = 0; c < sent.size(); ++c) {
        EXPECT_LT(sent[c].y, 1.001);
        mean += sent[c].y / static_cast<double>(sent.size());
        once += 0.99 * straight[c] / static_cast<double>(sent.size());
    }
    EXPECT_GT(mean, 1.5 * once); // the black room before it takes its share
}

// Leaves send little, and each may hide what all others send.
TEST(OutsideReflection, crowds_before_a_window_are_black) {
    for (const int leaves : {150, 200}) {
        geometry::PatchMesh mesh = test::roomWithWindow(1);
        for (int k = 0; k < leaves; ++k) {
            const double x = 1 + 0.1 * (k % 20), y = 0.2 * (k / 20), z = -3 - 0.01 * k;
            test::wallOutside(mesh, {x + 0.05, z}, {x, z}, y, y + 0.1, 0.5f);
        }
        const PointScene scene(mesh);
        EXPECT_EQ(scene.outside().tooMany(), leaves == 200);
        EXPECT_EQ(scene.outside().cells().empty(), leaves == 200);
    }
}

// Four rooms without walls' thickness round a court of 6 x 6 m, a window of the first in one of its walls;
// their outer sides are of the material of their insides.
geometry::PatchMesh courtOfRooms(float reflectance, double height = 6) {
    geometry::PatchMesh mesh;
    const auto add = [&](glm::dvec2 low, glm::dvec2 high, uint32_t room) {
        test::BoxRoom box{.low = {low.x, 0, low.y}, .high = {high.x, height, high.y}};
        box.cells = {room == 0 ? 7U : 1U, room == 0 ? 3U : 1U, room == 0 ? 2U : 1U};
        box.triangles = false, box.wall.reflectance = glm::vec3(reflectance);
        if (room == 0)
            box.isGlass = [height](dvec3 p) {
                return std::abs(p.z - 4) < 1e-9 && p.x > 6 && p.x < 8 && 3 * p.y > height &&
                       3 * p.y < 2 * height;
            };
        test::addBox(mesh, box, room);
    };
    add({0, 0}, {14, 4}, 0), add({0, 10}, {14, 14}, 1), add({0, 4}, {4, 10}, 2), add({10, 4}, {14, 10}, 3);
    return mesh;
}

// A crowd of leaves does not blacken the rooms' own outer sides, and many of these are no crowd.
TEST(OutsideReflection, own_outer_sides_are_no_crowd) {
    geometry::PatchMesh mesh = test::roomWithWindow(1);
    const auto behind = [](int k) { return dvec3(0.2 * (k % 20), 0.2 * (k / 20), -4 - 0.01 * k); };
    for (uint32_t k = 0; k < 200; ++k) {
        const dvec3 p = behind(static_cast<int>(k));
        test::addBox(mesh, {.low = p, .high = p + dvec3(0.15, 0.15, 0.005), .cells = {1, 1, 1}}, k + 1);
    }
    const PointScene rooms(mesh);
    EXPECT_FALSE(rooms.outside().tooMany());
    const size_t own = rooms.outside().cells().size();
    std::set<uint32_t> sides;
    for (const OutsideCell& cell : rooms.outside().cells()) sides.insert(cell.region);
    EXPECT_GT(sides.size(), 190u);
    for (int k = 0; k < 200; ++k) {
        const dvec3 p = behind(k) + dvec3(0, 0, 1);
        test::wallOutside(mesh, {p.x + 0.02, p.z}, {p.x, p.z}, p.y, p.y + 0.02, 0.5f);
    }
    const PointScene leaves(mesh);
    EXPECT_TRUE(leaves.outside().tooMany());
    EXPECT_GT(leaves.outside().cells().size(), own / 2);
    for (const OutsideCell& cell : leaves.outside().cells())
        EXPECT_TRUE(leaves.outside().isOfRooms(cell.region));
}

TEST(OutsideReflection, outer_sides_of_rooms_have_the_light_of_traced_paths) {
    const geometry::PatchMesh mesh = courtOfRooms(0.7F);
    const std::vector<Sensor> sensors{
        {{7, 1.5, 3.5}, {0, 0, 1}}, {{7, 0.8, 2}, {0, 1, 0}}, {{5, 2.5, 1}, {0, -1, 0}}};
    DaylightTransport transport(test::device(), mesh);
    transport.setSensors(sensors);
    for (const daylight::Sky& sky : {test::overcast(), test::sunny({0.3, 0.8, 0.4})}) {
        const Moment moment = transport.light(sky);
        EXPECT_EQ(std::ranges::count_if(moment.report.modelled,
                                        [](const std::string& what) {
                                            return what.starts_with("what stands outside: reflected light");
                                        }),
                  1);
        test::PathTracer tracer(mesh, sky);
        double all = 0, traced = 0;
        for (size_t s = 0; s < sensors.size(); ++s) {
            const auto truth = tracer.at(sensors[s], 40);
            EXPECT_NEAR(lux(moment.sensors[s].total()), truth.lux,
                        double{moment.sensors[s].error} + 3 * truth.standardError)
                << s;
            all += lux(moment.sensors[s].total()), traced += truth.lux;
        }
        EXPECT_NEAR(all, traced, 0.06 * traced); // mostly the noise of paths
    }
}

// A reveal sees nothing of its own facade but the glass in it, however large the cells of that are.
TEST(OutsideReflection, walls_beside_glass_send_nothing_into_its_reveal) {
    std::vector<std::vector<glm::vec3>> sent;
    for (const float reflectance : {0.0F, 0.9F}) {
        const double left = 8.0 / 7, right = 16.0 / 7;
        test::BoxRoom box{.cells = {7, 3, 5}};
        box.isGlass = [&](dvec3 p) { return p.z < 1e-9 && p.x > left && p.x < right && p.y > 1 && p.y < 2; };
        box.wall.reflectance = glm::vec3(reflectance);
        geometry::PatchMesh mesh = test::boxRoom(box);
        test::wallOutside(mesh, {left, -0.3}, {left, 0}, 1, 2, 0.7F);
        test::wallOutside(mesh, {right, 0}, {right, -0.3}, 1, 2, 0.7F);
        test::standOutside(mesh, {{left, 1, 0}, {right, 1, 0}, {right, 1, -0.3}, {left, 1, -0.3}}, 0.7F);
        test::standOutside(mesh, {{left, 2, -0.3}, {right, 2, -0.3}, {right, 2, 0}, {left, 2, 0}}, 0.7F);
        const UnderEvenSky world(mesh);
        std::vector<glm::vec3> lit;
        for (const float one : world.straight()) lit.emplace_back(one);
        const std::vector<glm::vec3> all = world.reflection.exitance(lit);
        sent.emplace_back();
        for (size_t c = 0; c < all.size(); ++c) {
            const OutsideCell& cell = world.reflection.cells()[c];
            if (world.scene.outside().isOfRooms(cell.region))
                EXPECT_EQ(cell.materials.size(), 1u); // glass or wall
            else
                sent.back().push_back(all[c]);
        }
    }
    ASSERT_EQ(sent[0].size(), sent[1].size());
    for (size_t c = 0; c < sent[0].size(); ++c) EXPECT_NEAR(sent[0][c].y, sent[1][c].y, 1e-4) << c;
}

TEST(OutsideReflection, a_court_of_rooms_sends_no_more_than_it_gets) {
    const geometry::PatchMesh mesh = courtOfRooms(0.99F, 12);
    const UnderEvenSky world(mesh);
    const std::vector<float> straight = world.straight();
    std::vector<glm::vec3> lit;
    double wall = 0, glass = 0;
    for (size_t c = 0; c < straight.size(); ++c) {
        const OutsideCell& cell = world.reflection.cells()[c];
        const double area = 0.5 * glm::length(geometry::areaVector(cell.corners));
        lit.emplace_back(straight[c]), wall += area;
        for (const MaterialShare& of : cell.materials)
            if (mesh.materials[of.material].isOpening()) glass += of.share * area;
    }
    EXPECT_NEAR(wall, 4 * 6 * 12, 1e-6 * wall); // nothing but the walls of the court
    EXPECT_NEAR(glass, 2 * 4, 1e-6 * wall);
    double mean = 0;
    const std::vector<glm::vec3> sent = world.reflection.exitance(lit);
    for (const glm::vec3& one : sent) {
        EXPECT_LT(one.y, 1.001);
        mean += one.y / static_cast<double>(sent.size());
    }
    EXPECT_GT(mean, 0.5);
}

// Black walls send nothing, and a room whose windows see no wall of another has nothing outside.
TEST(OutsideReflection, outer_sides_count_where_windows_see_some_that_reflect) {
    DaylightTransport transport(test::device(), courtOfRooms(0));
    EXPECT_EQ(std::ranges::count(transport.light(test::overcast()).report.skipped,
                                 "what stands outside: nothing that reflects"),
              1);
    geometry::PatchMesh white = courtOfRooms(0.5F);
    transport.setMaterials(white.materials);
    transport.setSensors({{{7, 1.5, 3.5}, {0, 0, 1}}});
    DaylightTransport anew(test::device(), white);
    anew.setSensors({{{7, 1.5, 3.5}, {0, 0, 1}}});
    const double lit = lux(anew.light(test::overcast()).sensors[0].ground);
    EXPECT_NEAR(lux(transport.light(test::overcast()).sensors[0].ground), lit, 1e-5 * lit);
    const geometry::PatchMesh alone = test::roomWithWindow(1);
    EXPECT_TRUE(PointScene(alone).outside().regions().empty());
}

TEST(OutsideReflection, what_answers_is_the_transpose_of_what_is_sent) {
    const geometry::PatchMesh mesh = sceneOf("court");
    const PointScene scene(mesh);
    const OutsideReflection reflection(scene, daylight::SkyPatches(1));
    const size_t n = reflection.cells().size();
    ASSERT_GT(n, 20u);
    const std::span<const OutsideCell> cells = reflection.cells();
    const auto area = [&](size_t c) { return 0.5 * glm::length(geometry::areaVector(cells[c].corners)); };
    for (const size_t from : {size_t{3}, n / 2, n - 4}) {
        std::vector<glm::vec3> lit(n, glm::vec3(0));
        lit[from] = glm::vec3(1);
        const std::vector<glm::vec3> sent = reflection.exitance(lit);
        std::vector<float> answers(n, 0);
        answers[from] = 1;
        reflection.answer(0, answers);
        double there = 0, back = 0;
        for (size_t to = 0; to < n; ++to) {
            std::vector<float> one(n, 0);
            one[to] = 1;
            reflection.answer(0, one);
            EXPECT_NEAR(one[from], sent[to].x, 1e-4 * sent[from].x);
            if (to == from || glm::length(cells[to].centre - cells[from].centre) < 4) continue;
            there += area(to) * sent[to].x, back += area(from) * answers[to];
        }
        EXPECT_NEAR(there, back, 0.15 * back); // reciprocity, of cells seen from their middles
    }
}

TEST(OutsideReflection, is_ground_light_and_has_the_colour_of_the_wall) {
    geometry::PatchMesh mesh = sceneOf("facade");
    mesh.materials.back().reflectance = {0.6f, 0.3f, 0};
    DaylightTransport red(test::device(), mesh);
    mesh.materials.back().reflectance = glm::vec3(0);
    DaylightTransport black(test::device(), mesh);
    red.setSensors(kSensors), black.setSensors(kSensors);
    const Moment one = red.light(test::overcast()), other = black.light(test::overcast());
    EXPECT_EQ(std::ranges::count(other.report.skipped, "what stands outside: black, reflects nothing"), 1);
    for (size_t s = 0; s < kSensors.size(); ++s) {
        const glm::vec3 more = one.sensors[s].ground - other.sensors[s].ground;
        EXPECT_GT(more.x, 0.05F * other.sensors[s].total().x) << s;
        EXPECT_NEAR(more.y, more.x / 2, 2e-3 * more.x);
        EXPECT_NEAR(more.z, 0, 2e-3 * more.x);
        EXPECT_NEAR(lux(one.sensors[s].sky), lux(other.sensors[s].sky), 1e-6 * lux(other.sensors[s].sky));
    }
    red.setMaterials(mesh.materials); // black
    const Moment again = red.light(test::overcast());
    for (size_t s = 0; s < kSensors.size(); ++s)
        EXPECT_NEAR(lux(again.sensors[s].total()), lux(other.sensors[s].total()),
                    1e-4 * lux(other.sensors[s].total()));
}

// Before a wall that fills its view a blind glows as much less as the wall is darker than the sky.
TEST(OutsideReflection, blinds_glow_with_it) {
    for (const char* state : {"fabric:0.3,0.4", "slats:30"}) {
        geometry::PatchMesh mesh = test::roomWithWindow(1);
        mesh.materials[1] = daylight::withBlind(mesh.materials[1], geometry::parseBlind(state));
        DaylightTransport open(test::device(), mesh);
        test::wallOutside(mesh, {5000, -100}, {-5000, -100}, -5000, 5000, 0.4f);
        DaylightTransport behind(test::device(), mesh);
        const Moment one = open.light(furnace(1000)), other = behind.light(furnace(1000));
        ASSERT_FALSE(other.glow.empty());
        for (size_t i = 0; i < mesh.patchCount(); ++i)
            if (one.glow[i].y > 0) {
                EXPECT_NEAR(other.glow[i].y / one.glow[i].y, 0.4, 0.01) << state << ", " << i;
            }
    }
}

// A second, large window lights a wall close before the first: by the room's own light, and by sky that is
// seen from there through both. What comes back of it is a third of what the first sensor gets.
TEST(OutsideReflection, light_of_rooms_comes_back) {
    test::BoxRoom box{.cells = {4, 3, 5}};
    box.wall.reflectance = glm::vec3(0.8f);
    box.isGlass = [](dvec3 p) {
        return (p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2) || p.z > 5 - 1e-9;
    };
    geometry::PatchMesh mesh = test::boxRoom(box);
    test::wallOutside(mesh, {8, -0.5}, {-4, -0.5}, 0, 9, 0.85f);
    const std::vector<Sensor> sensors{
        {{2, 1.5, 0.3}, {0, 0, -1}}, {{2, 1.5, 2}, {0, 0, -1}}, {{2, 0.8, 0.5}, {0, 1, 0}}};
    const std::vector<daylight::Sky> hours{test::overcast(), test::sunny({0.2, 0.8, 0.5})};
    const geometry::PatchMesh faces = test::withOutsideAsPatches(mesh);
    DaylightTransport transport(test::device(), mesh);
    const size_t count = sensors.size() * hours.size();
    std::vector<float> all(count), sun(count), error(count);
    AnnualDaylight year(transport, hours, sensors.size());
    year.sensors(sensors, all, sun, error);
    for (size_t h = 0; h < hours.size(); ++h) {
        test::PathTracer tracer(faces, hours[h]);
        const Moment moment = transport.light(hours[h]);
        EXPECT_LT(moment.report.energyImbalance, 1e-3);
        for (size_t s = 0; s < sensors.size(); ++s) {
            const auto traced = tracer.at(sensors[s], 30);
            const double here = lux(moment.sensors[s].total());
            EXPECT_NEAR(here, traced.lux, double{moment.sensors[s].error} + 3 * traced.standardError)
                << h << ", " << s;
            EXPECT_NEAR(here, traced.lux, 0.06 * traced.lux) << h << ", " << s;
            EXPECT_NEAR(all[s * hours.size() + h], here, 4e-3 * here) << h << ", " << s;
        }
    }
}

// Hour by hour as moment by moment, also where the sun reaches what stands outside alone.
TEST(OutsideReflection, years_have_it) {
    for (const char* state : {"open", "fabric:0.3,0.4", "slats:30"}) {
        geometry::PatchMesh mesh = sceneOf("facade");
        mesh.materials[1] = daylight::withBlind(mesh.materials[1], geometry::parseBlind(state));
        DaylightTransport transport(test::device(), mesh);
        const std::vector<daylight::Sky> hours = skies();
        AnnualDaylight year(transport, hours, kSensors.size());
        const size_t count = kSensors.size() * hours.size();
        std::vector<float> all(count), sun(count), error(count);
        year.sensors(kSensors, all, sun, error);
        EXPECT_EQ(year.report().withSun, 2u);
        for (size_t h = 0; h < hours.size(); ++h) {
            const Moment moment = transport.light(hours[h]);
            for (size_t s = 0; s < kSensors.size(); ++s) {
                const double truth = lux(moment.sensors[s].total());
                EXPECT_NEAR(all[s * hours.size() + h], truth, 4e-3 * truth) << state << h << ", " << s;
            }
        }
    }
}

} // namespace
} // namespace heliodon::compute
