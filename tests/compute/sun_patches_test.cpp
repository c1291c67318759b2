#include "compute/sun_patches.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "compute/daylight/glazing.h"
#include "compute/daylight/window.h"
#include "compute/reference/sun.h"
#include "tests/compute/cases.h"
#include "tests/compute/rooms.h"

namespace heliodon::compute {
namespace {

const std::string kCases = std::string(HELIODON_TEST_DATA) + "/compute/daylight/";

double luminousFlux(const geometry::PatchMesh& mesh, const std::vector<glm::vec3>& sun) {
    double flux = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) flux += geometry::patchArea(mesh, i) * sun[i].y;
    return flux;
}

TEST(SunPatches, all_that_enters_a_window_lands_somewhere) {
    test::BoxRoom box;
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    const geometry::PatchMesh mesh = test::boxRoom(box);
    for (glm::dvec3 sun :
         {glm::dvec3(0.3, 0.5, -0.8), glm::dvec3(-0.7, 0.1, -0.4), glm::dvec3(0, 1, -0.05)}) {
        sun = glm::normalize(sun);
        const double expected =
            2 * -sun.z * daylight::glazingOf(box.glass).transmittance(-sun.z).y; // 2 m2 of glass
        EXPECT_NEAR(luminousFlux(mesh, SunPatches(mesh, sun).onPatches()), expected,
                    1e-6 * expected); // float32 results
    }
}

TEST(SunPatches, a_hair_decides_at_the_edge_of_a_beam_alone) {
    test::BoxRoom box;
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    const geometry::PatchMesh mesh = test::boxRoom(box);
    const SunPatches sun(mesh, glm::normalize(glm::dvec3(0.3, 0.5, -0.8)));
    const glm::dvec3 up(0, 1, 0), edge(1.4, 0, 1.6), inside(1.4, 0, 1.7), corner(1 - 0.6, 0, 1.6);
    const glm::vec3 beam = sun.beamAtPoint(inside, up).share;
    EXPECT_GT(beam.y, 0.4f);
    EXPECT_EQ(sun.beamAtPoint(edge, up).unsure, beam);
    EXPECT_EQ(sun.beamAtPoint(corner, up).unsure, beam);
    for (const glm::dvec3 p :
         {inside, edge + glm::dvec3(0, 0, 1e-3), edge - glm::dvec3(0, 0, 1e-3), edge + 0.1 * up})
        EXPECT_EQ(sun.beamAtPoint(p, up).unsure, glm::vec3(0)) << p.y << ' ' << p.z;
}

// As far from it as 0.001 degrees turn the building's diagonal, on either side, of a window and of a sheet
// that ends in the air.
TEST(SunPatches, a_beams_edge_is_as_wide_as_is_said) {
    test::BoxRoom box;
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    geometry::PatchMesh mesh = test::boxRoom(box);
    const auto v = static_cast<uint32_t>(mesh.vertices.size());
    for (const glm::dvec2 at : {glm::dvec2(1, 0.5), {3, 0.5}, {3, 1.2}, {1, 1.2}})
        mesh.vertices.push_back({at.x, 0.5, at.y});
    mesh.addPatch(std::vector{v, v + 1, v + 2, v + 3}, 0, geometry::Role::projection, 6, 0);
    mesh.addPatch(std::vector{v + 3, v + 2, v + 1, v}, 0, geometry::Role::projection, 7, 0);
    const glm::dvec3 towards = glm::normalize(glm::dvec3(0.3, 0.5, -0.8)), up(0, 1, 0);
    const SunPatches sun(mesh, towards);
    const double reach = glm::radians(1e-3) * glm::length(box.high - box.low);
    // A step of one along z on the floor, seen along the sun: so far from edges that run along x.
    const double step = towards.y / glm::length(glm::dvec2(towards.y, towards.z));
    for (const double z : {3.2, 2.0}) { // where the window's top and the sheet end
        const auto unsure = [&](double times) {
            return photometric(sun.beamAtPoint({0.9, 0, z + times * reach / step}, up).unsure);
        };
        for (const double side : {-1.0, 1.0}) {
            EXPECT_GT(unsure(0.6 * side), 0.4) << z; // moved to and fro, askew to the edge
            EXPECT_EQ(unsure(1.01 * side), 0) << z;
        }
    }
}

constexpr double kDiscTangent = 0.00465; // half the sun's disc

// Of a disc of radius one what lies on one side of a line `from` its middle.
double shareOfDisc(double from) {
    const double h = std::clamp(from, -1.0, 1.0);
    return 1 - (std::acos(h) - h * std::sqrt(1 - h * h)) / std::numbers::pi;
}

// A window's upper edge, of which the floor has the image 1.6 m off.
TEST(SunPatches, the_disc_of_the_sun_gives_beams_a_penumbra) {
    test::BoxRoom box;
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    const geometry::PatchMesh mesh = test::boxRoom(box);
    const glm::dvec3 towards = glm::normalize(glm::dvec3(0, 0.5, -0.8)), up(0, 1, 0);
    const SunScene scene(mesh, true);
    const SunPatches sun(scene, towards);
    const double beam = photometric(sun.beamAtPoint({2, 0, 2.4}, up).share), edge = 3.2;
    ASSERT_GT(beam, 0.4);
    const double step = towards.y, // as the sun sees it, of one along the floor
        radius = kDiscTangent * 2 / towards.y;
    for (double at = -1.6; at < 1.7; at += 0.1) {
        const glm::dvec3 p(2, 0, edge - at * radius / step);
        const auto [share, unsure] = sun.beamAtPoint(p, up);
        EXPECT_NEAR(photometric(share), beam * shareOfDisc(at), 0.02 * beam) << at;
        if (std::abs(at) < 0.95) {
            EXPECT_NEAR(photometric(unsure), 0.02 * beam, 1e-4) << at;
        } else if (std::abs(at) > 1.05) {
            EXPECT_EQ(photometric(unsure), 0) << at;
            EXPECT_EQ(share, SunPatches(mesh, towards).beamAtPoint(p, up).share) << at;
        }
    }
}

// A bar of a tenth of the disc's width takes as much of it wherever it stands before it.
TEST(SunPatches, a_thin_bar_far_off_dims_the_sun_and_does_not_hide_it) {
    test::BoxRoom box;
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9; };
    geometry::PatchMesh mesh = test::boxRoom(box);
    const glm::dvec3 towards = glm::normalize(glm::dvec3(0, 0.5, -0.8)), up(0, 1, 0);
    const double height = 0.5, away = height / towards.y, width = 0.2 * kDiscTangent * away;
    const double clear = photometric(SunPatches(mesh, towards).beamAtPoint({2, 0, 2}, up).share);
    const auto v = static_cast<uint32_t>(mesh.vertices.size());
    for (const glm::dvec2 at : {glm::dvec2(1, 0), {3, 0}, {3, width / towards.y}, {1, width / towards.y}})
        mesh.vertices.push_back({at.x, height, 1 + at.y});
    mesh.addPatch(std::vector{v, v + 1, v + 2, v + 3}, 0, geometry::Role::projection, 6, 0);
    mesh.addPatch(std::vector{v + 3, v + 2, v + 1, v}, 0, geometry::Role::projection, 7, 0);
    const SunScene scene(mesh, true);
    const SunPatches sun(scene, towards);
    const double image = 1 + height * 0.8 / 0.5, radius = kDiscTangent * away / towards.y;
    for (double at = -1.3; at < 1.35; at += 0.1) {
        const double hidden = shareOfDisc(at + 0.2) - shareOfDisc(at);
        const auto [share, unsure] = sun.beamAtPoint({2, 0, image - at * radius}, up);
        EXPECT_NEAR(photometric(share), clear * (1 - hidden), 0.03 * clear) << at;
    }
    const SunPatches point(mesh, towards); // of which all is hidden
    EXPECT_EQ(photometric(point.beamAtPoint({2, 0, image + 0.5 * width / towards.y}, up).share), 0);
}

// As far from the shadow of a sheet just above the floor as 0.001 degrees turn the building's diagonal.
TEST(SunPatches, a_hair_decides_in_a_narrow_penumbra_alone) {
    test::BoxRoom box;
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    geometry::PatchMesh mesh = test::boxRoom(box);
    const double height = 2e-3, end = 2.4;
    const auto v = static_cast<uint32_t>(mesh.vertices.size());
    for (const glm::dvec2 at : {glm::dvec2(1, 2), {3, 2}, {3, end}, {1, end}})
        mesh.vertices.push_back({at.x, height, at.y});
    mesh.addPatch(std::vector{v, v + 1, v + 2, v + 3}, 0, geometry::Role::projection, 6, 0);
    mesh.addPatch(std::vector{v + 3, v + 2, v + 1, v}, 0, geometry::Role::projection, 7, 0);
    const glm::dvec3 towards = glm::normalize(glm::dvec3(0, 0.5, -0.8)), up(0, 1, 0);
    const SunScene scene(mesh, true);
    const SunPatches sun(scene, towards);
    const double hair = glm::radians(1e-3) * glm::length(box.high - box.low);
    const auto unsure = [&](double hairs) { // beyond the shadow, as the sun sees it
        const glm::dvec3 p(2, 0, end + height * 0.8 / 0.5 + hairs * hair / towards.y);
        return photometric(sun.beamAtPoint(p, up).unsure);
    };
    const double beam = photometric(sun.beamAtPoint({2, 0, end + 0.1}, up).share);
    ASSERT_GT(beam, 0.4);
    for (const double side : {-1.0, 1.0}) {
        EXPECT_NEAR(unsure(0.6 * side), beam, 1e-6) << side;
        EXPECT_EQ(unsure(1.1 * side), 0) << side;
    }
}

TEST(SunPatches, a_sun_behind_the_house_does_not_enter) {
    test::BoxRoom box;
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9; };
    const geometry::PatchMesh mesh = test::boxRoom(box);
    const SunPatches sun(mesh, glm::normalize(glm::dvec3(0, 0.5, 1)));
    EXPECT_FALSE(sun.canEnter());
    EXPECT_EQ(luminousFlux(mesh, sun.onPatches()), 0);
    EXPECT_FALSE(SunPatches(test::boxRoom({}), {0, 1, 0}).canEnter());
}

TEST(SunPatches, agrees_with_rays_in_an_L_shaped_room_with_a_partition) {
    const auto room = test::readCase(kCases + "d_skylight_partition_overcast_mar21_13_g0.2");
    const geometry::PatchMesh mesh = test::subdivided(room.faces, 0.9);
    for (glm::dvec3 sun :
         {glm::dvec3(-0.26, 0.70, 0.66), glm::dvec3(-0.5, 0.3, 0.2), glm::dvec3(0.2, 0.9, 0.3)}) {
        sun = glm::normalize(sun);
        const auto exact = SunPatches(mesh, sun).onPatches();
        size_t lit = 0;
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            // 512 low-discrepancy rays: a straight shadow edge leaves about 1/512 * 5 of the patch open.
            EXPECT_NEAR(exact[i].y, reference::sunOnPatch(mesh, i, sun, 512).y, 0.012) << "patch " << i;
            lit += exact[i].y > 0;
        }
        EXPECT_GT(lit, 5u);
    }
}

TEST(SunPatches, an_interior_window_counts_once_and_each_pane_on_the_way_counts) {
    const geometry::PatchMesh mesh = test::twoRooms(true);
    const glm::dvec3 sun = glm::normalize(glm::dvec3(0, 0.05, -1));
    const double pane = daylight::glazingOf(test::BoxRoom{}.glass).transmittance(-sun.z).y;
    const SunPatches patches(mesh, sun);
    ASSERT_TRUE(patches.canEnter());
    const glm::vec3 outer = patches.beamAtPoint({2.1, 1.2, 4.9}, sun).share,
                    far = patches.beamAtPoint({2.1, 1.2, 9.9}, sun).share;
    EXPECT_NEAR(outer.y, pane, 1e-6);
    EXPECT_NEAR(far.y, pane * pane, 1e-6);
    const auto lit = patches.onPatches();
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        if (mesh.room[i] == 1 && geometry::patchCentroid(mesh, i).z > 9.99 &&
            geometry::patchCentroid(mesh, i).y < 2) {
            EXPECT_NEAR(lit[i].y, -sun.z * pane * pane, 1e-6); // the top of the window lights up to y = 2.5
        }
}

// A room 2 m from the window of another one, with windows before and behind: all three panes dim.
geometry::PatchMesh enfilade(const geometry::Blind& blind = {}) {
    test::BoxRoom box;
    geometry::PatchMesh mesh;
    const auto window = [](glm::dvec3 p) { return p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    box.isGlass = [&](glm::dvec3 p) { return window(p) && p.z > 5 - 1e-9; };
    box.glass = daylight::withBlind(box.glass, blind);
    test::addBox(mesh, box, 0);
    test::BoxRoom other;
    other.low.z = 7, other.high.z = 9, other.cells = {4, 3, 2};
    other.glass.transmittance = glm::vec3(0.9f, 0.6f, 0.3f);
    other.isGlass = [&](glm::dvec3 p) { return window(p) && (p.z < 7 + 1e-9 || p.z > 9 - 1e-9); };
    test::addBox(mesh, other, 1);
    return mesh;
}

TEST(SunPatches, windows_of_a_room_on_the_way_dim_from_both_sides) {
    const geometry::PatchMesh mesh = enfilade();
    const glm::dvec3 sun = glm::normalize(glm::dvec3(0.04, 0.06, 1));
    const SunPatches patches(mesh, sun);
    const glm::dvec3 through = daylight::glazingOf(mesh.materials[1]).transmittance(sun.z) *
                               daylight::glazingOf(mesh.materials[3]).transmittance(sun.z) *
                               daylight::glazingOf(mesh.materials[3]).transmittance(sun.z);
    const glm::vec3 point = patches.beamAtPoint({2, 1.2, 3}, sun).share;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(double{point[c]}, through[c], 1e-6);
    const auto lit = patches.onPatches();
    size_t few = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        EXPECT_NEAR(lit[i].y, reference::sunOnPatch(mesh, i, sun, 512).y, 0.012) << "patch " << i;
        few += mesh.room[i] == 0 && lit[i].y > 0;
    }
    EXPECT_GT(few, 3u);
}

TEST(SunPatches, what_falls_on_a_blind_has_passed_the_windows_before_it) {
    const geometry::PatchMesh mesh = enfilade({geometry::Blind::Kind::fabric, 0.3f, 0.5f});
    const SunPatches patches(mesh, {0, 0, 1});
    const glm::dvec3 pane = daylight::glazingOf(mesh.materials[3]).transmittance(1);
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        if (mesh.material[i] == 1) {
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(patches.onOutside(i)[c], pane[c] * pane[c], 1e-9);
        }
}

// A work plane under a skylight and beside a partition: what its lit parts cover is what points of it get.
TEST(SunPatches, any_polygon_in_the_air_has_its_lit_parts) {
    const auto room = test::readCase(kCases + "d_skylight_partition_overcast_mar21_13_g0.2");
    const geometry::PatchMesh mesh = test::subdivided(room.faces, 0.9);
    glm::dvec3 low(1e300), high(-1e300);
    for (const glm::dvec3& v : mesh.vertices) low = glm::min(low, v), high = glm::max(high, v);
    const double y = low.y + 0.3 * (high.y - low.y);
    const std::array plane{glm::dvec3(low.x, y, low.z), glm::dvec3(low.x, y, high.z),
                           glm::dvec3(high.x, y, high.z), glm::dvec3(high.x, y, low.z)};
    const SunPatches sun(mesh, glm::normalize(glm::dvec3(-0.26, 0.70, 0.66)));
    const auto parts = sun.onPolygon(plane);
    size_t lit = 0;
    for (int i = 0; i < 40; ++i)
        for (int j = 0; j < 40; ++j) {
            const glm::dvec3 p(glm::mix(low.x, high.x, (i + 0.43) / 40), y,
                               glm::mix(low.z, high.z, (j + 0.57) / 40));
            glm::vec3 covered(0);
            for (const SunlitParts::Part& part : parts) {
                bool inside = true;
                for (size_t k = 0; k < part.polygon.size(); ++k) {
                    const glm::dvec3 side = part.polygon[(k + 1) % part.polygon.size()] - part.polygon[k];
                    inside &= glm::cross(side, p - part.polygon[k]).y >= 0;
                }
                if (inside) covered += part.light;
            }
            EXPECT_NEAR(covered.y, sun.beamAtPoint(p, {0, 1, 0}).share.y, 1e-6) << p.x << ' ' << p.z;
            lit += covered.y > 0;
        }
    EXPECT_GT(lit, 20u);
    EXPECT_LT(lit, 800u);
    EXPECT_TRUE(sun.onPolygon(std::array{plane[3], plane[2], plane[1], plane[0]}).empty()); // from below
}

TEST(SunPatches, points_in_sun_and_shade_are_those_of_the_reference_sensors) {
    const auto room = test::readCase(kCases + "c_L_glass_clear_mar21_13_g0.2");
    const geometry::PatchMesh mesh = test::subdivided(room.faces, 0.5);
    const SunPatches sun(mesh, room.sky.sun.direction);
    const auto& reference = room.columns.at("lux_sun_direct");
    for (size_t s = 0; s < reference.size(); ++s) {
        const double lux = room.sky.sun.normalIlluminance *
                           sun.beamAtPoint(room.sensors[s].position, room.sensors[s].normal).share.y;
        EXPECT_NEAR(lux, reference[s], 0.002 * reference[s])
            << "sensor " << s; // Radiance's glass, bins of its own
    }
}

} // namespace
} // namespace heliodon::compute
