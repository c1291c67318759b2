// What `lux_error` knows of meshes that are coarse where light changes fast.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <gtest/gtest.h>

#include "compute/daylight_transport.h"
#include "geometry/building.h"
#include "geometry/mesher.h"
#include "tests/compute/rooms.h"
#include "tests/compute/skies.h"
#include "tests/gpu/test_device.h"

namespace heliodon::compute {
namespace {

// Behind a partition 0.25 m from a wall it is dark below and bright above; patches there are as large as the
// way is wide, and a sensor on the wall hardly sees any other.
geometry::Building roomWithPartition() {
    using geometry::HeightClass;
    geometry::Sketch sketch;
    const auto add = [&](glm::dvec2 a, glm::dvec2 b, HeightClass height) {
        geometry::Wall& wall = sketch.walls.emplace_back();
        wall.id = std::to_string(sketch.walls.size());
        wall.a = a, wall.b = b, wall.heightClass = height;
    };
    add({-9, -8}, {9, -8}, HeightClass::red);
    add({9, -8}, {9, 8}, HeightClass::red);
    add({9, 8}, {-9, 8}, HeightClass::red);
    add({-9, 8}, {-9, -8}, HeightClass::red);
    add({-8, 6.8}, {-5, 6.8}, HeightClass::green);
    geometry::WindowMarker& window = sketch.windows.emplace_back();
    window.id = "w", window.wall = "4", window.pos = 9, window.width = 2.5;
    window.kind = geometry::WindowKind::picture;
    return std::move(*geometry::closeSketch(sketch).building);
}

} // namespace

// A slot one patch deep takes light at its top for light all over its walls and sends twice too much of it
// into the room, which the stated error has to know.
TEST(LightError, knows_what_a_slot_as_deep_as_its_patches_leaves_open) {
    const std::vector<Sensor> sensors{{{1, 0.8, 1}, {0, 1, 0}},
                                      {{0.4, 0.8, 0.5}, {0, 1, 0}},
                                      {{1.5, 0.5, 1.6}, {0, 1, 0}},
                                      {{0.3, 1, 1.7}, {0, 1, 0}}};
    const std::vector<daylight::Sky> skies{test::overcast(), test::sunny({0.3, 0.6, -1})};
    DaylightTransport few(test::device(), test::slottedRoom(4, 8, 1, 1)),
        many(test::device(), test::slottedRoom(8, 36, 12, 3));
    few.setSensors(sensors), many.setSensors(sensors);
    const std::vector<Moment> stated = few.light(skies), there = many.light(skies);
    double most = 0;
    for (size_t k = 0; k < skies.size(); ++k)
        for (size_t s = 0; s < sensors.size(); ++s) {
            const double lux = photometric(stated[k].sensors[s].total()),
                         exact = photometric(there[k].sensors[s].total());
            EXPECT_NEAR(lux, exact, stated[k].sensors[s].error) << k << " " << s;
            EXPECT_LT(stated[k].sensors[s].error, lux); // says something
            most = std::max(most, std::abs(lux / exact - 1));
        }
    EXPECT_GT(most, 0.3); // else there is nothing to know
}

// Below a small skylight light peaks where four patches meet: none of them has a slope, and each is brighter
// at one end than at the other, of which a sensor beside them sees more.
TEST(LightError, knows_light_that_peaks_between_patches) {
    const auto room = [](uint32_t cells) {
        test::BoxRoom box{.low = {0, 0, 0}, .high = {2, 0.25, 2}, .cells = {cells, cells / 8, cells}};
        box.isGlass = [](glm::dvec3 p) {
            return p.y > 0.25 - 1e-9 && std::abs(p.x - 1) < 0.125 && std::abs(p.z - 1.5) < 0.125;
        };
        return test::boxRoom(box);
    };
    const geometry::PatchMesh fine = room(16), coarse = room(8);
    geometry::PatchMesh mesh; // with the fine one's ceiling, which has the skylight
    mesh.materials = fine.materials;
    for (const geometry::PatchMesh* from : {&fine, &coarse})
        for (size_t i = 0; i < from->patchCount(); ++i) {
            if ((geometry::patchCentroid(*from, i).y > 0.25 - 1e-9) != (from == &fine)) continue;
            std::vector<uint32_t> corners;
            for (const glm::dvec3& p : geometry::patchCorners(*from, i)) {
                corners.push_back(static_cast<uint32_t>(mesh.vertices.size()));
                mesh.vertices.push_back(p);
            }
            mesh.addPatch(corners, from->material[i], from->role[i], from->surface[i], from->room[i]);
        }
    DaylightTransport few(test::device(), mesh), many(test::device(), fine);
    const std::vector<Sensor> sensors{
        {{1, 0.07, 1.72}, {0, 0, -1}}, {{0.8, 0.11, 1.72}, {0, 0, -1}}, {{1, 0.11, 1.72}, {0, 0, -1}}};
    few.setSensors(sensors), many.setSensors(sensors);
    const Moment stated = few.light(test::overcast()), there = many.light(test::overcast());
    for (size_t s = 0; s < sensors.size(); ++s) {
        const double lux = photometric(stated.sensors[s].total());
        EXPECT_NEAR(lux, photometric(there.sensors[s].total()), stated.sensors[s].error) << s;
        EXPECT_LT(stated.sensors[s].error, 0.06 * lux) << s; // says something
    }
}

// Under a sill the floor is dark at the wall and bright half a metre from it. A sensor that looks into the
// room there sees patches of the floor by their far ends, which lie near its horizon and fill little of its
// view.
TEST(LightError, knows_patches_that_sensors_under_a_sill_see_by_one_end) {
    const auto room = [](uint32_t cells) {
        test::BoxRoom box{.low = {0, 0, 0}, .high = {4, 3, 4}, .cells = {cells, cells * 3 / 4, cells}};
        box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
        return test::boxRoom(box);
    };
    DaylightTransport few(test::device(), room(8)), many(test::device(), room(16));
    const std::vector<Sensor> sensors{
        {{2.4, 0.1, 0.2}, {0, 0, 1}}, {{2.4, 0.2, 0.2}, {0, 0, 1}}, {{2, 0.2, 0.2}, {0, 0, 1}}};
    few.setSensors(sensors), many.setSensors(sensors);
    const Moment stated = few.light(test::overcast()), there = many.light(test::overcast());
    for (size_t s = 0; s < sensors.size(); ++s) {
        const double lux = photometric(stated.sensors[s].total());
        EXPECT_NEAR(lux, photometric(there.sensors[s].total()), stated.sensors[s].error) << s;
        EXPECT_LT(stated.sensors[s].error, 0.12 * lux) << s; // says something
    }
}

TEST(LightError, knows_that_errors_of_few_patches_do_not_even_out) {
    const geometry::Building room = roomWithPartition();
    DaylightTransport few(test::device(), geometry::meshBuilding(room, {300})),
        many(test::device(), geometry::meshBuilding(room, {2000}));
    std::vector<Sensor> sensors;
    for (const glm::dvec2 at : {glm::dvec2(-7.17, 1.16), {-7.17, 2}, {-6.6, 1.16}, {-6.6, 2}})
        sensors.push_back({geometry::kMetresPerInch * glm::dvec3(at, -7.68), {0, 0, 1}});
    few.setSensors(sensors), many.setSensors(sensors);
    const std::vector<daylight::Sky> skies{test::overcast(), test::sunny({0.3, 0.7, 0.8})};
    const std::vector<Moment> stated = few.light(skies), there = many.light(skies);
    for (size_t k = 0; k < skies.size(); ++k)
        for (size_t s = 0; s < sensors.size(); ++s) {
            const double lux = photometric(stated[k].sensors[s].total());
            EXPECT_NEAR(lux, photometric(there[k].sensors[s].total()), stated[k].sensors[s].error)
                << k << " " << s;
            EXPECT_LT(stated[k].sensors[s].error, 0.45 * lux) << k << " " << s; // says something
        }
}

} // namespace heliodon::compute
