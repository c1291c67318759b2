// Rooms unlike those of the reference data: turned, with corners rounded to the digits of a file, shaded by
// their own building, seen through one another, with sensors a hair from what they see.
#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "compute/daylight_transport.h"
#include "geometry/mesher.h"
#include "geometry/model_file.h"
#include "tests/compute/path_tracer.h"
#include "tests/compute/rooms.h"
#include "tests/compute/skies.h"
#include "tests/gpu/test_device.h"

namespace heliodon::compute {
namespace {

using glm::dvec3;

constexpr double kPi = std::numbers::pi;

// About the vertical.
dvec3 turned(dvec3 p, double degrees) {
    const double c = std::cos(degrees * kPi / 180), s = std::sin(degrees * kPi / 180);
    return {c * p.x + s * p.z, p.y, -s * p.x + c * p.z};
}

// As read from a file of six digits.
void turnAndRound(geometry::PatchMesh& mesh, double degrees) {
    for (dvec3& p : mesh.vertices) p = glm::round(1e6 * turned(p, degrees)) / 1e6;
}

// 4 x 3 x 5 m with a window at z = 0, one at x = 4 and a hole at x = 0.
geometry::PatchMesh threeWindows(uint32_t times, bool triangles = true) {
    test::BoxRoom box;
    box.triangles = triangles;
    box.cells = {4 * times, 3 * times, 5 * times};
    box.isGlass = [](dvec3 p) {
        return (p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2) ||
               (p.x > 4 - 1e-9 && p.z > 1 && p.z < 2 && p.y > 1) ||
               (p.x < 1e-9 && p.z > 3 && p.z < 4 && p.y < 2);
    };
    return test::boxRoom(box);
}

TEST(OtherRooms, a_turned_room_gets_as_much_sun) {
    const dvec3 sun = glm::normalize(dvec3(0.5, 0.1, -0.8));
    for (const uint32_t times : {2u, 8u}) {
        geometry::PatchMesh mesh = threeWindows(times);
        const auto flux = [&](dvec3 towards) {
            const auto lit = SunPatches(mesh, towards).onPatches();
            double sum = 0;
            for (size_t i = 0; i < lit.size(); ++i) sum += geometry::patchArea(mesh, i) * lit[i].y;
            return sum;
        };
        const double straight = flux(sun);
        EXPECT_GT(straight, 1);
        for (const double degrees : {37.0, 111.3, 250.7}) {
            mesh = threeWindows(times);
            turnAndRound(mesh, degrees);
            EXPECT_NEAR(flux(turned(sun, degrees)), straight, 1e-5 * straight) << degrees; // six digits
        }
    }
}

TEST(OtherRooms, sensors_on_turned_walls_are_not_behind_them) {
    geometry::PatchMesh mesh = threeWindows(2), other = mesh;
    turnAndRound(other, 37);
    DaylightTransport straight(test::device(), mesh), oblique(test::device(), other);
    std::vector<Sensor> sensors, moved;
    for (const auto& [p, n] :
         {std::pair(dvec3(0.7, 1.1, 5), dvec3(0, 0, -1)), std::pair(dvec3(0, 1.3, 2.2), dvec3(1, 0, 0)),
          std::pair(dvec3(1.7, 0, 2.9), dvec3(0, 1, 0)), std::pair(dvec3(4, 0.4, 3.1), dvec3(-1, 0, 0))}) {
        sensors.push_back({p, n});
        for (const double behind : {-3e-7, 0.0, 3e-7})
            moved.push_back({turned(p - behind * n, 37), turned(n, 37)});
    }
    straight.setSensors(sensors), oblique.setSensors(moved);
    daylight::Sky sky = test::sunny({0.5, 0.3, -0.8});
    const Moment one = straight.light(sky);
    sky = test::sunny(turned(dvec3(0.5, 0.3, -0.8), 37));
    const Moment two = oblique.light(sky);
    EXPECT_TRUE(oblique.report().sensorsOutside.empty());
    for (size_t k = 0; k < moved.size(); ++k) {
        const double lux = photometric(one.sensors[k / 3].total());
        EXPECT_NEAR(photometric(two.sensors[k].total()), lux, 3e-3 * lux) << k; // form factors to 1e-3
    }
}

TEST(OtherRooms, a_hair_from_an_opening_half_the_sky_is_seen) {
    test::BoxRoom box;
    box.isGlass = [](dvec3 p) { return p.z < 1e-9; };
    box.glass.refractiveIndex = 1, box.glass.transmittance = glm::vec3(1);
    DaylightTransport transport(test::device(), test::boxRoom(box));
    transport.setSensors({{{2, 1.5, 1e-3}, {0, 1, 0}}, {{2, 1.5, 1e-5}, {0, 1, 0}}});
    const daylight::Sky sky = daylight::cieGeneralSky(16, {0, 1, 0}, 5000);
    const double half = 0.5 * 7 * kPi / 9 * sky.luminance({0, 1, 0});
    const Moment moment = transport.light(sky);
    for (const LightParts& parts : moment.sensors) // cells of 0.1 radians
        EXPECT_NEAR(photometric(parts.sky), half, 2e-3 * half);
}

// A board right before half of a window takes what the window's other half would not let in.
TEST(OtherRooms, what_stands_outside_shades_windows) {
    const auto room = [](double right) {
        test::BoxRoom box{.cells = {8, 6, 10}};
        box.isGlass = [=](dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < right && p.y > 1 && p.y < 2; };
        return test::boxRoom(box);
    };
    geometry::PatchMesh shaded = room(3);
    shaded.outside.vertices = {{2, 0, -1e-4}, {2, 3, -1e-4}, {4, 3, -1e-4}, {4, 0, -1e-4}};
    shaded.outside.triangles = {0, 2, 1, 0, 3, 2};
    DaylightTransport one(test::device(), shaded), half(test::device(), room(2));
    const std::vector<Sensor> sensors{{{2, 0.8, 1}, {0, 1, 0}}, {{2.9, 1.1, 2}, {0, 0, -1}}};
    one.setSensors(sensors), half.setSensors(sensors);
    for (const daylight::Sky& sky : {test::sunny({-0.3, 0.2, -0.9}), test::overcast()}) {
        const Moment shade = one.light(sky), narrow = half.light(sky);
        for (size_t k = 0; k < sensors.size(); ++k) {
            const double lux = photometric(narrow.sensors[k].total());
            // Patches of the wall are glass in one: it reflects less.
            EXPECT_NEAR(photometric(shade.sensors[k].sky), photometric(narrow.sensors[k].sky), 2e-3 * lux);
            EXPECT_NEAR(photometric(shade.sensors[k].sun), photometric(narrow.sensors[k].sun), 1e-3 * lux);
        }
    }
}

// A written model gives the light of the given one: the board hides half of its window, too.
TEST(OtherRooms, what_stands_outside_shades_windows_of_written_models) {
    test::BoxRoom box{.cells = {8, 6, 10}};
    box.isGlass = [](dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    geometry::PatchMesh given = test::boxRoom(box);
    given.outside.vertices = {{2, 0, -1e-2}, {2, 3, -1e-2}, {4, 3, -1e-2}, {4, 0, -1e-2}};
    given.outside.triangles = {0, 2, 1, 0, 3, 2};
    const std::vector<Sensor> sensors{{{2, 0.8, 1}, {0, 1, 0}}, {{2.9, 1.1, 2}, {0, 0, -1}}};
    DaylightTransport transport(test::device(), given);
    transport.setSensors(sensors);
    const Moment wanted = transport.light(test::overcast());
    for (const char* name : {"shaded.obj", "shaded.glb"}) {
        const std::string file = testing::TempDir() + name;
        geometry::writeModel(given, file);
        DaylightTransport again(test::device(), geometry::meshBuilding(geometry::importModel(file), {300}));
        again.setSensors(sensors);
        const Moment found = again.light(test::overcast());
        for (size_t k = 0; k < sensors.size(); ++k) {
            const double lux = photometric(wanted.sensors[k].total());
            EXPECT_NEAR(photometric(found.sensors[k].sky), photometric(wanted.sensors[k].sky), 2e-3 * lux);
            EXPECT_NEAR(photometric(found.sensors[k].total()), lux, 0.02 * lux); // other patches
        }
    }
}

// An overhang drawn as one plane takes as much of the sky as a thin board does.
TEST(OtherRooms, an_overhang_without_thickness_shades_as_a_thin_one) {
    test::BoxRoom box{.cells = {8, 6, 10}};
    box.isGlass = [](dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    const std::string file = testing::TempDir() + "overhang.obj";
    const std::vector<Sensor> sensors{
        {{2, 0.8, 1}, {0, 1, 0}}, {{2.9, 1.1, 2}, {0, 0, -1}}, {{1, 0.8, 4}, {0, 1, 0}}};
    std::array<std::vector<double>, 3> sky; // without it, as a plane, as a board
    for (size_t k = 0; k < 3; ++k) {
        geometry::writeModel(test::boxRoom(box), file);
        std::ofstream out(file, std::ios::app);
        out << "o overhang\nusemtl wall\nv 0 2.1 -1\nv 4 2.1 -1\nv 4 2.1 -.1\nv 0 2.1 -.1\n"
               "v 0 2.1005 -1\nv 4 2.1005 -1\nv 4 2.1005 -.1\nv 0 2.1005 -.1\n";
        if (k > 0) out << "f -8 -7 -6 -5\n";
        if (k > 1) out << "f -1 -2 -3 -4\nf -8 -4 -3 -7\nf -7 -3 -2 -6\nf -6 -2 -1 -5\nf -5 -1 -4 -8\n";
        out.close();
        DaylightTransport transport(test::device(),
                                    geometry::meshBuilding(geometry::importModel(file), {300}));
        transport.setSensors(sensors);
        for (const LightParts& parts : transport.light(test::overcast()).sensors)
            sky[k].push_back(photometric(parts.sky));
    }
    for (size_t s = 0; s < sensors.size(); ++s) {
        EXPECT_NEAR(sky[1][s], sky[2][s], 5e-3 * sky[2][s]) << s;
        EXPECT_LT(sky[1][s], 0.9 * sky[0][s]) << s;
    }
}

// Coarse patches below a window send too much of its light down.
TEST(OtherRooms, what_coarse_meshes_leave_in_a_shaft_lies_in_the_stated_error) {
    std::vector<Sensor> sensors;
    for (const double y : {0.3, 0.8, 1.6}) {
        sensors.push_back({{0.5, y, 0.4}, {1, 0, 0}});
        sensors.push_back({{0.3, y, 0.5}, {0, -1, 0}});
    }
    const auto lightOn = [&](uint32_t times, const daylight::Sky& sky) {
        test::BoxRoom shaft{.high = {0.8, 4, 0.8}, .cells = {2 * times, 8 * times, 2 * times}};
        shaft.wall.reflectance = glm::vec3(0.7f);
        shaft.isGlass = [](dvec3 p) { return p.y > 4 - 1e-9; };
        DaylightTransport transport(test::device(), test::boxRoom(shaft));
        transport.setSensors(sensors);
        return transport.light(sky).sensors;
    };
    for (const daylight::Sky& sky : {test::sunny({0.7, 0.3, 0.1}), test::overcast()}) {
        const std::vector<LightParts> coarse = lightOn(1, sky), fine = lightOn(4, sky);
        for (size_t s = 0; s < sensors.size(); ++s)
            EXPECT_NEAR(photometric(coarse[s].total()), photometric(fine[s].total()), double{coarse[s].error})
                << s;
    }
}

// A second building before the window at z = 0, if wanted with a window that looks back at it.
geometry::PatchMesh facingAnother(uint32_t times, bool triangles, bool window = false) {
    geometry::PatchMesh mesh = threeWindows(times, triangles);
    test::BoxRoom box{.low = {1.5, 0, -6}, .high = {6, 4, -2}, .cells = {2, 2, 2}, .triangles = triangles};
    if (window) {
        for (uint32_t& cells : box.cells) cells *= times;
        box.isGlass = [](dvec3 p) { return p.z > -2 - 1e-9 && p.x < 3.75 && p.y < 2; };
    }
    test::addBox(mesh, box, 1);
    return mesh;
}

// `few`: the same room in few large patches.
void expectInside(const geometry::PatchMesh& mesh, const geometry::PatchMesh& few, const daylight::Sky& sky,
                  const std::vector<Sensor>& sensors, double widest) {
    DaylightTransport transport(test::device(), mesh);
    transport.setSensors(sensors);
    const Moment moment = transport.light(sky);
    test::PathTracer tracer(few, sky);
    for (size_t k = 0; k < sensors.size(); ++k) {
        const auto truth = tracer.at(sensors[k], 50);
        const LightParts& parts = moment.sensors[k];
        const double lux = photometric(parts.total());
        EXPECT_NEAR(lux, truth.lux, static_cast<double>(parts.error) + 3 * truth.standardError)
            << "sensor " << k;
        EXPECT_LT(truth.standardError, 0.05 * truth.lux);
        EXPECT_LT(static_cast<double>(parts.error), widest * lux) << "sensor " << k; // says something
    }
}

TEST(OtherRooms, what_stands_before_a_window_hides_the_sky) {
    const std::vector<Sensor> sensors{
        {{2, 1, 2}, {0, 1, 0}}, {{2, 1.5, 0.5}, {0, 0, -1}}, {{3, 0.5, 1}, {0, 0.6, -0.8}}};
    const daylight::Sky sky = test::sunny({-0.3, 0.6, -0.5});
    expectInside(facingAnother(3, true), facingAnother(1, false), sky, sensors, 0.06);
    DaylightTransport alone(test::device(), threeWindows(2)), shaded(test::device(), facingAnother(2, true));
    alone.setSensors(sensors), shaded.setSensors(sensors);
    EXPECT_LT(photometric(shaded.light(sky).sensors[1].sky),
              0.8 * photometric(alone.light(sky).sensors[1].sky));
}

TEST(OtherRooms, a_window_that_looks_at_another_gets_light_from_the_room_behind_it) {
    const std::vector<Sensor> sensors{{{2, 1, 2}, {0, 1, 0}},
                                      {{2, 1.5, 2.5}, {0, 0.5, -1}},
                                      {{3, 0.5, 1}, {0, 0.6, -0.8}},
                                      {{2.5, 1, -5}, {0, -0.3, 1}}};
    const daylight::Sky sky = test::sunny({-0.2, 0.5, 0.6}); // into the other building's window
    expectInside(facingAnother(3, true, true), facingAnother(1, false, true), sky, sensors, 0.06);
    geometry::PatchMesh dark = facingAnother(3, true, true);
    dark.materials.back().transmittance = glm::vec3(0);
    DaylightTransport closed(test::device(), dark), glass(test::device(), facingAnother(3, true, true));
    closed.setSensors(sensors), glass.setSensors(sensors);
    EXPECT_GT(photometric(glass.light(sky).sensors[1].total()),
              1.01 * photometric(closed.light(sky).sensors[1].total()));
}

// A U of three boxes round a court, whose two windows look at one another; one room.
geometry::PatchMesh court(uint32_t times, bool triangles) {
    geometry::PatchMesh mesh;
    mesh.materials.push_back({"wall", glm::vec3(0.6f)});
    mesh.materials.push_back({"glass", glm::vec3(0), glm::vec3(0.8f)});
    uint32_t surface = 0;
    const auto wall = [&](dvec3 corner, dvec3 u, dvec3 v, bool window = false) {
        const auto cells = [&](dvec3 d) {
            return times * static_cast<uint32_t>(std::lround(glm::length(d)));
        };
        const uint32_t nu = cells(u), nv = cells(v);
        for (uint32_t i = 0; i < nu; ++i)
            for (uint32_t j = 0; j < nv; ++j) {
                const auto first = static_cast<uint32_t>(mesh.vertices.size());
                for (const auto& [a, b] : {std::pair(i, j), {i + 1, j}, {i + 1, j + 1}, {i, j + 1}})
                    mesh.vertices.push_back(corner + u * (double(a) / nu) + v * (double(b) / nv));
                const bool glass = window && j * 3 / nv == 1 && i * 3 / nu == 1;
                const auto add = [&](std::vector<uint32_t> corners) {
                    mesh.addPatch(corners, glass ? 1 : 0, geometry::Role::projection, surface, 0);
                };
                if (triangles)
                    add({first, first + 1, first + 2}), add({first, first + 2, first + 3});
                else
                    add({first, first + 1, first + 2, first + 3});
            }
        ++surface;
    };
    const dvec3 x(3, 0, 0), y(0, 3, 0), z(0, 0, 3);
    for (const dvec3 box : {dvec3(0), dvec3(3, 0, 0), dvec3(6, 0, 0), dvec3(0, 0, 3), dvec3(6, 0, 3)}) {
        wall(box, z, x);     // floor
        wall(box + y, x, z); // ceiling
    }
    wall({0, 0, 0}, x, y), wall({3, 0, 0}, x, y), wall({6, 0, 0}, x, y);
    wall({0, 0, 6}, y, x), wall({3, 0, 3}, y, x), wall({6, 0, 6}, y, x);
    wall({0, 0, 0}, y, z), wall({0, 0, 3}, y, z), wall({9, 0, 0}, z, y), wall({9, 0, 3}, z, y);
    wall({3, 0, 3}, z, y, true), wall({6, 0, 3}, y, z, true);
    return mesh;
}

TEST(OtherRooms, windows_on_to_a_court_look_at_one_another) {
    const std::vector<Sensor> sensors{{{1, 1, 4.5}, {1, 0, 0}},
                                      {{1, 0.8, 4.5}, {0, 1, 0}},
                                      {{8.5, 2, 4}, {-1, -0.5, 0.2}},
                                      {{4.5, 1, 1}, {0, 1, 0}}};
    const daylight::Sky sky = test::sunny({-0.7, 0.5, 0.3});
    expectInside(court(3, true), court(1, false), sky, sensors, 0.06);
}

TEST(OtherRooms, sky_and_walls_are_seen_through_interior_glass) {
    const glm::vec3 wall(0.5f);
    const geometry::PatchMesh mesh = test::twoRooms(true, wall, 2),
                              few = test::twoRooms(true, wall, 1, false);
    const std::vector<Sensor> sensors{
        {{2, 0.8, 7}, {0, 1, 0}}, {{1, 1.5, 9}, {0, 0, -1}}, {{3, 0.8, 3}, {0, 0, 1}}};
    expectInside(mesh, few, test::sunny({0.2, 0.5, -0.8}), sensors, 0.12);
    expectInside(mesh, few, test::overcast(), sensors, 0.12);
}

// A window in a partition that air runs round: light passes it as between two rooms.
TEST(OtherRooms, a_pane_within_a_room_lets_its_share_of_the_light_through) {
    test::BoxRoom box{.cells = {4, 3, 5}};
    box.isGlass = [](dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    const std::string file = testing::TempDir() + "pane_within.obj";
    const auto read = [&](bool pane, uint32_t triangles) {
        geometry::writeModel(test::boxRoom(box), file);
        std::ofstream out(file, std::ios::app);
        out << "o partition\nusemtl wall\n";
        for (const auto& [x0, x1, y0, y1] :
             {std::array{1, 2, 0, 3}, {2, 3, 0, 1}, {2, 3, 2, 3}, {3, 4, 0, 3}}) { // no door in x < 1
            for (const double z : {2.5, 2.6})
                for (const auto& [x, y] : {std::pair(x0, y0), {x1, y0}, {x1, y1}, {x0, y1}})
                    out << "v " << x << ' ' << y << ' ' << z << '\n';
            out << "f -5 -6 -7 -8\nf -4 -3 -2 -1\nf -8 -7 -3 -4\nf -7 -6 -2 -3\nf -6 -5 -1 -2\nf -5 -8 -4 "
                   "-1\n";
        }
        if (pane) out << "usemtl glass\nv 2 1 2.55\nv 3 1 2.55\nv 3 2 2.55\nv 2 2 2.55\nf -4 -3 -2 -1\n";
        out.close();
        return geometry::meshBuilding(geometry::importModel(file), {triangles});
    };
    const std::vector<Sensor> sensors{
        {{2.5, 1.5, 2.7}, {0, 0, -1}}, {{2.3, 1.4, 4.5}, {0, 0, -1}}, {{2.5, 0.8, 1.5}, {0, 0, 1}}};
    const geometry::PatchMesh mesh = read(true, 600);
    EXPECT_EQ(mesh.room, std::vector<uint32_t>(mesh.patchCount(), 0));
    expectInside(mesh, read(true, 60), test::overcast(), sensors, 0.06);
    DaylightTransport glass(test::device(), mesh), hole(test::device(), read(false, 600));
    glass.setSensors(sensors), hole.setSensors(sensors);
    const Moment through = glass.light(test::overcast()), open = hole.light(test::overcast());
    EXPECT_NEAR(photometric(through.sensors[1].sky) / photometric(open.sensors[1].sky), 0.88, 0.003);
}

TEST(OtherRooms, low_sun_in_a_turned_room_with_three_windows) {
    geometry::PatchMesh mesh = threeWindows(4), coarse = threeWindows(1, false);
    turnAndRound(mesh, 37), turnAndRound(coarse, 37);
    const daylight::Sky sky = test::sunny(turned(dvec3(0.5, 0.08, -0.8), 37));
    std::vector<Sensor> sensors;
    for (const auto& [p, n] :
         {std::pair(dvec3(2, 0.8, 2.5), dvec3(0, 1, 0)), std::pair(dvec3(0.5, 2, 4), dvec3(1, 0, 0)),
          std::pair(dvec3(1e-3, 1e-3, 1e-3), dvec3(0, 1, 0)), std::pair(dvec3(2, 1.5, 1e-3), dvec3(0, -1, 0)),
          std::pair(dvec3(3, 2.9, 4.9), dvec3(0, -1, 0))})
        sensors.push_back({turned(p, 37), turned(n, 37)});
    DaylightTransport transport(test::device(), mesh);
    transport.setSensors(sensors);
    const Moment moment = transport.light(sky);
    test::PathTracer tracer(coarse, sky);
    for (size_t k = 0; k < sensors.size(); ++k) {
        const auto truth = tracer.at(sensors[k], 50);
        EXPECT_NEAR(photometric(moment.sensors[k].total()), truth.lux,
                    static_cast<double>(moment.sensors[k].error) + 3 * truth.standardError)
            << "sensor " << k;
    }
}

// Light falls off towards a corner within centimetres; patches here are 25 cm wide.
TEST(OtherRooms, a_hair_from_corners_light_falls_off_as_it_should) {
    const daylight::Sky sky = test::sunny({-0.1, 0.6, 0.8}); // on no window
    test::BoxRoom box;
    box.wall.reflectance = glm::vec3(0.7f);
    box.isGlass = [](dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    box.triangles = false;
    const geometry::PatchMesh few = test::boxRoom(box);
    box.triangles = true, box.cells = {16, 12, 20};
    std::vector<Sensor> sensors;
    for (const double d : {0.002, 0.015}) {
        sensors.push_back({{d, 2 * d, 5 - d}, {0, 1, 0}});
        sensors.push_back({{4 - d, 3 - 0.5 * d, 5 - d}, {0, 0, -1}});
        sensors.push_back({{d, d, 2.6}, {1, 0, 0}});
        sensors.push_back({{4 - d, d, d}, {0, 1, 0}});
    }
    DaylightTransport transport(test::device(), test::boxRoom(box));
    transport.setSensors(sensors);
    const Moment moment = transport.light(sky);
    test::PathTracer tracer(few, sky);
    double sum = 0, noise = 0;
    for (size_t k = 0; k < sensors.size(); ++k) {
        const auto truth = tracer.at(sensors[k], 45);
        const double off = photometric(moment.sensors[k].total()) / truth.lux - 1;
        std::printf("corner %2zu: %.2f lux, %+.2f %% (tracer %.2f %%)\n", k, truth.lux, 100 * off,
                    100 * truth.standardError / truth.lux);
        sum += off, noise += std::pow(truth.standardError / truth.lux, 2);
        EXPECT_LT(std::abs(off) * truth.lux,
                  static_cast<double>(moment.sensors[k].error) + 3 * truth.standardError);
        EXPECT_LT(std::abs(off), 0.03 + 3 * truth.standardError / truth.lux) << k;
    }
    const auto count = static_cast<double>(sensors.size());
    EXPECT_LT(std::abs(sum / count), 0.01 + 3 * std::sqrt(noise) / count);
}

// Patches of 1 m that the sun lights in part, and sensors in the edge of floor and wall beside that part:
// what they see of the wall gets its light from the lit part alone, not from the patch.
TEST(OtherRooms, beside_sunlit_parts_of_large_patches) {
    const daylight::Sky sky = test::sunny({0.5, 0.35, -0.5});
    test::BoxRoom box;
    box.wall.reflectance = glm::vec3(0.6f);
    box.isGlass = [](dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    box.triangles = false;
    const geometry::PatchMesh few = test::boxRoom(box);
    box.triangles = true;
    const std::vector<Sensor> sensors{{{0.004, 0.01, 1.1}, {0, 1, 0}},   {{0.01, 0.005, 0.95}, {1, 0, 0}},
                                      {{0.002, 0.012, 1.25}, {0, 1, 0}}, {{0.01, 0.01, 2.9}, {1, 0, 0}},
                                      {{0.01, 0.004, 3.1}, {0, 1, 0}},   {{0.015, 0.002, 3.3}, {1, 0, 0}}};
    DaylightTransport transport(test::device(), test::boxRoom(box));
    transport.setSensors(sensors);
    const Moment moment = transport.light(sky);
    test::PathTracer tracer(few, sky);
    for (size_t k = 0; k < sensors.size(); ++k) {
        const auto truth = tracer.at(sensors[k], 50);
        const double off = std::abs(photometric(moment.sensors[k].total()) - truth.lux);
        EXPECT_LT(truth.standardError, 0.03 * truth.lux);
        EXPECT_LT(off, 0.05 * truth.lux + 3 * truth.standardError) << k; // half of it and more without
        EXPECT_LT(off, static_cast<double>(moment.sensors[k].error) + 3 * truth.standardError) << k;
    }
}

} // namespace
} // namespace heliodon::compute
