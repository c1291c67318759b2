#include "compute/window_links.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "compute/daylight_transport.h"
#include "tests/compute/rooms.h"
#include "tests/compute/skies.h"
#include "tests/gpu/test_device.h"

namespace heliodon::compute {
namespace {

using glm::dvec3;

// Two boxes whose walls at z = 5 are open holes, `gap` apart; one room each. As good as one long box.
geometry::PatchMesh openBoxes(double gap, uint32_t times) {
    geometry::PatchMesh mesh;
    for (uint32_t room = 0; room < 2; ++room) {
        test::BoxRoom box;
        box.cells = {4 * times, 3 * times, 5 * times};
        box.glass.transmittance = glm::vec3(1), box.glass.refractiveIndex = 1;
        if (room) box.low.z = 5 + gap, box.high.z = 10 + gap;
        box.isGlass = [gap](dvec3 p) { return p.z > 5 - 1e-9 && p.z < 5 + gap + 1e-9; };
        test::addBox(mesh, box, room);
    }
    return mesh;
}

TEST(WindowLinks, two_rooms_behind_open_holes_are_one_long_room) {
    const double gap = 1e-4;
    geometry::PatchMesh two = openBoxes(gap, 2);
    test::BoxRoom box;
    box.high.z = 10, box.cells = {8, 6, 20};
    geometry::PatchMesh one = test::boxRoom(box);
    const auto lamp = [](geometry::PatchMesh& mesh) { // the end at z = 0
        mesh.materials.push_back({"lamp", glm::vec3(0.5f)});
        mesh.materials.back().exitance = glm::vec3(1000);
        for (size_t i = 0; i < mesh.patchCount(); ++i)
            if (geometry::patchCentroid(mesh, i).z < 1e-9)
                mesh.material[i] = static_cast<uint32_t>(mesh.materials.size() - 1);
    };
    lamp(two), lamp(one);
    DaylightTransport split(test::device(), two), whole(test::device(), one);
    const std::vector<Sensor> sensors{{{2, 1, 7}, {0, 1, 0}},
                                      {{2, 1.5, 9.5}, {0, 0, -1}},
                                      {{0.5, 2, 6}, {1, 0, 0}},
                                      {{2, 1.5, 1}, {0, 0, 1}},
                                      {{1, 0.8, 3}, {0, 1, 0}}};
    split.setSensors(sensors), whole.setSensors(sensors);
    const Moment halves = split.light(daylight::Sky{}), all = whole.light(daylight::Sky{});
    for (size_t k = 0; k < sensors.size(); ++k) {
        const double lux = photometric(all.sensors[k].total());
        EXPECT_GT(lux, 10);
        // One point a patch beside the holes, half a metre wide.
        EXPECT_NEAR(photometric(halves.sensors[k].total()), lux, 0.02 * lux) << k;
        EXPECT_NEAR(photometric(halves.sensors[k].total()), lux,
                    static_cast<double>(halves.sensors[k].error + all.sensors[k].error));
    }
    EXPECT_LT(halves.report.energyImbalance, 1e-5);
}

// Slats in one of two windows that face each other: what passes them straight is seen from either side, the
// same both ways.
TEST(WindowLinks, one_sees_through_slats_from_both_sides) {
    const geometry::PatchMesh open = openBoxes(1, 2);
    for (const float angle : {0.0f, 30.0f, -40.0f}) {
        geometry::PatchMesh mesh = open; // slats in the window of room 1
        mesh.materials[3] =
            daylight::withBlind(mesh.materials[3], {geometry::Blind::Kind::slats, 0, 0.5f, angle, 0.8f});
        const PointScene clear(open), scene(mesh);
        const size_t n = mesh.patchCount();
        const daylight::Window window(mesh.materials[3]);
        const auto row = [&](const PointScene& of, size_t i) {
            std::vector<float> values(n, 0);
            std::vector<TintedShare> tinted;
            of.seePatchesBeyond(PointView(of.blockers(), geometry::patchCentroid(mesh, i),
                                          geometry::patchNormal(mesh, i), mesh.room[i]),
                                mesh.room[i], values.data(), tinted);
            return values;
        };
        double compared = 0, passed = 0;
        for (size_t i = 0; i < n; i += 7) {
            const std::vector<float> whole = row(clear, i), slatted = row(scene, i);
            for (size_t j = 0; j < n; ++j) {
                if (whole[j] < 2e-5f) continue;
                // Light runs out of room 1; its window looks to -z, into the room is +z.
                const glm::dvec3 out =
                    glm::normalize((geometry::patchCentroid(mesh, i) - geometry::patchCentroid(mesh, j)) *
                                   (mesh.room[i] == 0 ? 1.0 : -1.0));
                const double share = double{slatted[j]} / double{whole[j]};
                // Directions to a patch half a metre wide differ.
                EXPECT_NEAR(share, window.straight(out, {0, 0, 1}).y, 0.12) << i << ' ' << j << ' ' << angle;
                compared += 1, passed += share;
            }
        }
        EXPECT_GT(compared, 100);
        EXPECT_GT(passed, 0.05 * compared);
        EXPECT_LT(passed, 0.8 * compared);
    }
}

TEST(WindowLinks, exchange_is_mutual_and_comes_out_again_to_the_bit) {
    const geometry::PatchMesh mesh = openBoxes(0.3, 1);
    const size_t n = mesh.patchCount();
    FormFactors factors = computeFormFactors(test::device(), mesh, {});
    const std::vector<float> before = factors.values.download<float>(n * n);
    const PointScene scene(mesh);
    const WindowLinks links(scene, factors.values);
    const std::vector<float> with = factors.values.download<float>(n * n);
    double largest = 0;
    for (size_t i = 0; i < n; ++i) {
        double sum = 0;
        for (size_t j = 0; j < n; ++j) {
            const double there = double{with[i * n + j]} - double{before[i * n + j]},
                         back = double{with[j * n + i]} - double{before[j * n + i]};
            EXPECT_NEAR(geometry::patchArea(mesh, i) * there, geometry::patchArea(mesh, j) * back, 1e-7);
            EXPECT_TRUE(there == 0 || mesh.room[i] != mesh.room[j]);
            sum += there;
            largest = std::max(largest, there);
        }
        EXPECT_NEAR(links.rowSums()[i].x, sum, 1e-5);
    }
    EXPECT_GT(largest, 1e-3);
    links.remove(factors.values);
    EXPECT_EQ(factors.values.download<float>(n * n), before);
}

TEST(WindowLinks, glass_may_change) {
    geometry::PatchMesh mesh = openBoxes(0.3, 1), dim = mesh;
    for (geometry::Material& m : dim.materials)
        if (m.isOpening()) m.transmittance = glm::vec3(0.3f), m.refractiveIndex = 1.52f;
    const daylight::Sky sky = test::sunny({0.9, 0.3, 0.1});
    for (geometry::PatchMesh* m : {&mesh, &dim}) {
        m->materials[0].exitance = glm::vec3(100);
        m->materials[2].exitance = glm::vec3(0);
    }
    DaylightTransport changed(test::device(), mesh), fresh(test::device(), dim);
    changed.setSensors({{{2, 1, 7}, {0, 1, 0}}}), fresh.setSensors({{{2, 1, 7}, {0, 1, 0}}});
    const float bright = changed.light(sky).sensors[0].interreflected.y;
    changed.setMaterials(dim.materials);
    const float lux = fresh.light(sky).sensors[0].interreflected.y;
    EXPECT_LT(lux, 0.5f * bright);
    EXPECT_NEAR(changed.light(sky).sensors[0].interreflected.y, lux, 1e-3f * lux);
}

// Each channel is a grey room of its own.
TEST(WindowLinks, tinted_panes_between_coloured_rooms_keep_channels_apart) {
    const glm::vec3 wall(0.7f, 0.5f, 0.3f), glass(0.2f, 0.5f, 0.8f);
    geometry::PatchMesh mesh = test::twoRooms(true, wall, 1);
    for (geometry::Material& m : mesh.materials)
        if (m.isOpening()) m.transmittance = glass;
    // In the room behind, in the first, by the glass in a corner.
    const std::vector<Sensor> sensors{
        {{2, 0.8, 7}, {0, 1, 0}}, {{1, 1.5, 2}, {0, 0, 1}}, {{0.01, 0.01, 5.02}, {0, 1, 0}}};
    const daylight::Sky sky = test::sunny({0.4, 0.3, -0.8});
    DaylightTransport coloured(test::device(), mesh);
    coloured.setSensors(sensors);
    const Moment moment = coloured.light(sky);
    EXPECT_LT(moment.report.energyImbalance, 1e-5);
    for (int c = 0; c < 3; ++c) {
        geometry::PatchMesh grey = mesh;
        for (geometry::Material& m : grey.materials)
            m.reflectance = glm::vec3(m.reflectance[c]), m.transmittance = glm::vec3(m.transmittance[c]);
        DaylightTransport alone(test::device(), grey);
        alone.setSensors(sensors);
        const Moment one = alone.light(sky);
        for (size_t s = 0; s < sensors.size(); ++s) {
            const float lux = one.sensors[s].interreflected[c];
            EXPECT_GT(lux, 1);
            EXPECT_NEAR(moment.sensors[s].interreflected[c], lux, 2e-3f * lux) << s << ", channel " << c;
        }
        // The solver's tolerance is a share of the brightest patch, in the other room.
        for (size_t i = 0; i < mesh.patchCount(); ++i)
            EXPECT_NEAR(moment.patches[i].interreflected[c], one.patches[i].interreflected[c],
                        2e-3f * one.patches[i].interreflected[c] + 0.5f);
    }
}

TEST(WindowLinks, rooms_that_see_no_other_have_none) {
    const geometry::PatchMesh mesh = test::boxRoom({});
    FormFactors factors = computeFormFactors(test::device(), mesh, {});
    EXPECT_TRUE(WindowLinks(PointScene(mesh), factors.values).rowSums().empty());
}

} // namespace
} // namespace heliodon::compute
