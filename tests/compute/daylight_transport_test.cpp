#include "compute/daylight_transport.h"

#include <unistd.h>

#include <filesystem>
#include <numbers>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <gtest/gtest.h>

#include "compute/convex_regions.h"
#include "compute/daylight/glazing.h"
#include "compute/form_factors.h"
#include "compute/sun_bounce.h"
#include "geometry/input_error.h"
#include "geometry/mesher.h"
#include "geometry/model_file.h"
#include "tests/compute/cases.h"
#include "tests/compute/rooms.h"
#include "tests/compute/skies.h"
#include "tests/gpu/test_device.h"

namespace heliodon::compute {
namespace {

using test::sunny;

const std::string kCases = std::string(HELIODON_TEST_DATA) + "/compute/daylight/";

struct Lit {
    test::DaylightCase room;
    Moment moment;
};

Lit lit(const std::string& name, size_t triangles) {
    Lit result{test::readCase(kCases + name), {}};
    const geometry::PatchMesh mesh = geometry::meshBuilding(
        geometry::importModel(kCases + name + "/model.obj", geometry::UpAxis::z), {triangles});
    DaylightTransport transport(test::device(), mesh);
    transport.setSensors(result.room.sensors);
    result.moment = transport.light(result.room.sky);
    return result;
}

// Rooms against Radiance, which is good to about 0.5 % itself (1 % with sun) beside its random error. CIE
// 171's rooms have no reflection: openings and glass alone, where Radiance cut the sky at 2 degrees.
class Rooms : public testing::TestWithParam<std::tuple<const char*, double, double>> {};

TEST_P(Rooms, sensors_agree_with_radiance_to_within_its_own_error) {
    const auto [name, rms, worst] = GetParam();
    const Lit result = lit(name, 600);
    const test::Deviation d = test::deviation(result.room, result.moment);
    EXPECT_LT(d.rmsBeyondNoise, rms) << "bias " << d.bias;
    EXPECT_LT(d.worstBeyondNoise, worst);
    EXPECT_GE(d.inside, 0.99);
    EXPECT_LT(result.moment.report.energyImbalance, 1e-5);
    EXPECT_LT(std::abs(result.moment.report.lumensLost), 0.002 * result.moment.report.lumensIn);
}

INSTANTIATE_TEST_SUITE_P(
    Radiance, Rooms,
    testing::Values(std::tuple("a0_furnace", 1e-4, 1e-4), std::tuple("a1_cube", 0.01, 0.05),
                    std::tuple("a2_cornell", 0.01, 0.05),
                    std::tuple("b_facade4x3_glass_overcast", 0.002, 0.003),
                    std::tuple("b_facade4x3_open_overcast", 0.001, 0.002),
                    std::tuple("b_roof1x1_glass_overcast", 0.003, 0.008),
                    std::tuple("b_roof1x1_open_overcast", 0.001, 0.002),
                    std::tuple("c_L_glass_overcast_mar21_13_g0.2", 0.01, 0.05),
                    std::tuple("c_L_unglazed_overcast_mar21_13_g0", 0.01, 0.05),
                    std::tuple("c_L_glass_clear_mar21_13_g0.2", 0.01, 0.05),
                    std::tuple("c_L_glass_perez_dec21_09_g0", 0.01, 0.12),
                    std::tuple("d_skylight_partition_overcast_mar21_13_g0.2", 0.01, 0.05),
                    std::tuple("g_white95_overcast_mar21_13_g0", 0.01, 0.05)),
    [](const auto& instance) {
        std::string name = std::get<0>(instance.param);
        std::replace(name.begin(), name.end(), '.', '_');
        return name;
    });

geometry::PatchMesh windowRoom(glm::vec3 wall = glm::vec3(0.5f)) {
    test::BoxRoom box;
    box.wall.reflectance = wall;
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    return test::boxRoom(box);
}

// Light of a sky through windowRoom's window at a point: the midpoint rule in azimuth, and in height along
// each of these from the sill up by steps that grow.
double throughWindow(const daylight::Sky& sky, glm::dvec3 from, glm::dvec3 normal, int around, int heights) {
    const daylight::Glazing glass = daylight::glazingOf(test::BoxRoom().glass);
    const double left = std::atan((1 - from.x) / from.z), right = std::atan((3 - from.x) / from.z);
    const auto height = [](double slope) { return slope / std::sqrt(1 + slope * slope); };
    double lux = 0;
    for (int j = 0; j < around; ++j) {
        const double turn = left + (right - left) * (j + 0.5) / around, away = from.z / std::cos(turn);
        const double low = height(std::max(0.0, 1 - from.y) / away), high = height((2 - from.y) / away);
        for (int k = 0; k < heights && high > low; ++k) {
            const double t = (k + 0.5) / heights, z = low + (high - low) * t * t * t;
            const double level = std::sqrt(1 - z * z);
            const glm::dvec3 d(level * std::sin(turn), z, -level * std::cos(turn));
            lux += 3 * (high - low) * t * t / heights * (right - left) / around * sky.luminance(d) *
                   std::max(0.0, glm::dot(d, normal)) * glass.transmittance(-d.z).x;
        }
    }
    return lux;
}

// Most light of the first three comes from a ribbon 0.6 degrees high; the last falls as 1 / z.
std::vector<daylight::Sky> skiesWithRibbon() {
    std::vector<daylight::Sky> skies;
    for (const double b : {0.02, 0.1, 0.3})
        skies.push_back(daylight::perezSky({2, b, 3, -2, 0.2}, glm::normalize(glm::dvec3(0.5, 0.03, -1)),
                                           0.01 * std::exp(10 - 100 * b)));
    skies.push_back(daylight::perezSky({-0.98, -0.02, 3, -2, 0.2}, skies[0].shapeDirection, 100));
    return skies;
}

TEST(DaylightTransport, sensors_see_a_ribbon_at_the_horizon) {
    DaylightTransport transport(test::device(), windowRoom(glm::vec3(0)));
    // Two that see all of it or none; the sill a hair below the ribbon's edge, above it, and above both.
    const std::vector<Sensor> sensors{{{2, 1.5, 2.5}, {0, 0, -1}},
                                      {{1.5, 1.2, 1}, {0, 1, 0}},
                                      {{2, 1 - 0.008 * 2.5, 2.5}, {0, 0, -1}},
                                      {{2, 1 - 0.011 * 2.5, 2.5}, {0, 0, -1}},
                                      {{2, 1 - 0.011 * 2.5, 2.5}, glm::normalize(glm::dvec3(0.8, 0.5, -1))},
                                      {{1.2, 1 - 0.03 * 3, 3}, {0, 0, -1}},
                                      {{2, 0.8, 2}, {0, 1, 0}}};
    transport.setSensors(sensors);
    std::vector<daylight::Sky> skies = skiesWithRibbon();
    // As high as the window shows, and brighter towards a sun on the horizon.
    skies.push_back(
        daylight::perezSky({-1, -0.02, 8, -3, 0.4}, glm::normalize(glm::dvec3(0.2, 0.02, -1)), 100));
    for (const daylight::Sky& sky : skies) {
        const Moment moment = transport.light(sky);
        for (size_t s = 0; s < sensors.size(); ++s) {
            const double lux = throughWindow(sky, sensors[s].position, sensors[s].normal, 100, 1000);
            EXPECT_NEAR(photometric(moment.sensors[s].sky) / lux, 1, 0.003) << sky.formula.b << ", " << s;
            EXPECT_LT(std::abs(photometric(moment.sensors[s].total()) - lux), moment.sensors[s].error) << s;
            EXPECT_LT(moment.sensors[s].error, 0.02 * lux);
        }
    }
}

// The floor sees none of the ribbon, the far wall all of it above the sill's height and little below.
TEST(DaylightTransport, patches_get_of_a_ribbon_at_the_horizon_what_they_see) {
    test::BoxRoom box;
    box.wall.reflectance = glm::vec3(0);
    box.cells = {4, 6, 5};
    box.triangles = false;
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    const geometry::PatchMesh mesh = test::boxRoom(box);
    DaylightTransport transport(test::device(), mesh);
    for (const daylight::Sky& sky : skiesWithRibbon()) {
        const Moment moment = transport.light(sky);
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            const glm::dvec3 middle = geometry::patchCentroid(mesh, i),
                             normal = geometry::patchNormal(mesh, i);
            if (normal.y < 0.5 && normal.z > -0.5) continue; // floor and far wall
            const auto corners = geometry::patchCorners(mesh, i);
            double lux = 0;
            const glm::dvec3 one = corners[1] - corners[0], other = corners[3] - corners[0];
            const int along = one.y == 0 ? 3 : 40, across = other.y == 0 ? 3 : 40; // many up the wall
            for (int k = 0; k < along * across; ++k) {
                const double u = (k % along + 0.5) / along, v = (k / along + 0.5) / across;
                lux +=
                    throughWindow(sky, corners[0] + u * one + v * other, normal, 20, 120) / (along * across);
            }
            const LightParts& parts = moment.patches[i];
            const double off = std::abs(photometric(parts.total()) - lux);
            EXPECT_LE(off, parts.error + 0.005 * lux)
                << sky.formula.b << ", " << i << ": " << photometric(parts.total()) << " for " << lux;
            if (std::abs(middle.y - 0.75) > 0.3) {
                EXPECT_LE(parts.error, 0.06 * lux) << sky.formula.b << ", " << i;
            }
        }
    }
}

// Each channel of a tinted pane between rooms passes what a grey pane like it does, by way of the walls that
// are taken apart beside a sensor too: also of sunlight that ends in the other room, in view of these.
TEST(DaylightTransport, tinted_panes_count_beside_walls) {
    // The low sun shines through both panes; its edges count alike in dark channels and in bright ones.
    for (const glm::dvec3 sun : {glm::dvec3(0.3, 0.6, -0.8), glm::dvec3(-0.7, 0.2, -0.5)}) {
        const auto luxBehind = [&](glm::vec3 glass) {
            geometry::PatchMesh mesh = test::twoRooms(true, glm::vec3(0.7f));
            for (geometry::Material& m : mesh.materials)
                if (m.isOpening()) m.transmittance = glass;
            DaylightTransport transport(test::device(), mesh);
            transport.setSensors({{{0.005, 0.01, 6.3}, {0, 1, 0}}});
            const Moment moment = transport.light(sunny(sun));
            EXPECT_EQ(transport.report().sensorsNearWalls, 1u);
            return moment.sensors[0].interreflected;
        };
        const glm::vec3 tint(0.2f, 0.5f, 0.8f), lux = luxBehind(tint);
        for (int c = 0; c < 3; ++c) {
            const float grey = luxBehind(glm::vec3(tint[c])).x;
            // The solver's tolerance leaves 4e-5 at the most.
            EXPECT_NEAR(lux[c], grey, 1e-4F * grey) << sun.y << " " << c;
        }
    }
}

TEST(DaylightTransport, parts_sum_to_what_patches_reflect) {
    const geometry::PatchMesh mesh = windowRoom({0.7f, 0.4f, 0.1f});
    DaylightTransport transport(test::device(), mesh);
    const Moment moment = transport.light(sunny());
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const glm::vec3 out = mesh.materials[mesh.material[i]].reflectance * moment.patches[i].total();
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(moment.lighting.exitance[i][c], out[c],
                        1e-3 * photometric(out) + 0.5); // solver's tolerance
    }
    EXPECT_EQ(transport.report().channels, 3u);
}

// A box of 4 x 3 x 5 m with a window, in squares of 1 m over `times`.
geometry::PatchMesh squares(uint32_t times, bool inTriangles = false) {
    test::BoxRoom box;
    box.cells = {4 * times, 3 * times, 5 * times};
    box.triangles = inTriangles;
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    return test::boxRoom(box);
}

// Of each square the one of the coarser mesh, with squares of `size`, that it is a part of.
std::vector<size_t> wholes(const geometry::PatchMesh& fine, const geometry::PatchMesh& coarse, double size) {
    std::vector<size_t> whole(fine.patchCount());
    for (size_t i = 0; i < whole.size(); ++i)
        for (size_t j = 0; j < coarse.patchCount(); ++j) {
            const glm::dvec3 away = geometry::patchCentroid(fine, i) - geometry::patchCentroid(coarse, j);
            if (fine.surface[i] == coarse.surface[j] &&
                std::max({std::abs(away.x), std::abs(away.y), std::abs(away.z)}) < size / 2)
                whole[i] = j;
        }
    return whole;
}

TEST(DaylightTransport, light_on_patches_lies_in_its_stated_error) {
    const geometry::PatchMesh coarse = squares(3), fine = squares(6);
    DaylightTransport few(test::device(), coarse), many(test::device(), fine);
    const std::vector<size_t> whole = wholes(fine, coarse, 1.0 / 3);
    for (const daylight::Sky& sky : {test::overcast(), sunny(), sunny({0.5, 0.35, -0.5})}) {
        const Moment stated = few.light(sky), there = many.light(sky);
        std::vector<double> lux(coarse.patchCount(), 0), outside(lux);
        for (size_t i = 0; i < whole.size(); ++i) {
            lux[whole[i]] += photometric(there.patches[i].total()) / 4;
            outside[whole[i]] += photometric(there.patches[i].sky + there.patches[i].ground) / 4;
        }
        size_t inside = 0;
        double error = 0;
        for (size_t i = 0; i < lux.size(); ++i) {
            inside += std::abs(photometric(stated.patches[i].total()) - lux[i]) <=
                      static_cast<double>(stated.patches[i].error);
            error += static_cast<double>(stated.patches[i].error) / lux[i] / static_cast<double>(lux.size());
            // Beside the window, too, where four points a patch say little.
            EXPECT_NEAR(photometric(stated.patches[i].sky + stated.patches[i].ground), outside[i],
                        0.015 * lux[i])
                << i;
        }
        EXPECT_GE(static_cast<double>(inside), 0.97 * static_cast<double>(lux.size()));
        EXPECT_LT(error, 0.06); // says something
    }
}

// A model on the table that a file has rounded to six decimals, micrometres: its walls hide nothing of
// themselves, as that file has them and meshed anew. (They left a quarter of some light.)
TEST(DaylightTransport, rounded_corners_leave_the_light_as_it_is) {
    const geometry::PatchMesh mesh = geometry::meshBuilding(
        *geometry::closeSketch(
             geometry::readSketch(HELIODON_TEST_DATA "/geometry/sketches/i01_mixed.sketch.json"))
             .building,
        {500});
    const auto lux = [](const geometry::PatchMesh& of) {
        DaylightTransport transport(test::device(), of);
        std::vector<Sensor> sensors;
        for (const double x : {-0.25, -0.1, 0.05, 0.2})
            for (const double z : {-0.1, 0.0, 0.1}) sensors.push_back({{x, 0.0635, z}, {0, 1, 0}});
        transport.setSensors(sensors);
        std::vector<double> result;
        for (const LightParts& parts : transport.light(test::overcast()).sensors)
            result.push_back(photometric(parts.total()));
        return result;
    };
    const std::vector<double> before = lux(mesh);
    const auto expectAlike = [&](const geometry::PatchMesh& of, double within) {
        const std::vector<double> now = lux(of);
        for (size_t s = 0; s < now.size(); ++s) EXPECT_NEAR(now[s] / before[s], 1, within) << s;
    };
    geometry::PatchMesh rounded = mesh;
    for (glm::dvec3& vertex : rounded.vertices) vertex = glm::round(1e6 * vertex) / 1e6;
    expectAlike(rounded, 0.003);
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / fmt::format("heliodon-rounded-{}", ::getpid());
    std::filesystem::create_directory(folder);
    geometry::writeModel(rounded, folder / "rounded.obj");
    const geometry::PatchMesh anew =
        geometry::meshBuilding(geometry::importModel(folder / "rounded.obj"), {500});
    std::filesystem::remove_all(folder);
    EXPECT_NEAR(static_cast<double>(anew.patchCount()) / static_cast<double>(mesh.patchCount()), 1, 0.1);
    expectAlike(anew, 0.02);
    const auto blockers = [](const geometry::PatchMesh& of) { return blockingRegions(of, 16).size(); };
    EXPECT_LT(blockers(anew), 2 * blockers(mesh)); // walls are meshed in one plane each
    const auto closure = [](const geometry::PatchMesh& of) {
        return computeFormFactors(test::device(), of, {}).report.closureMax;
    };
    EXPECT_LT(closure(rounded), 0.01);
    EXPECT_LT(closure(anew), 0.01);
}

// In a furnace light is the same everywhere, also where patches see much of one another.
TEST(DaylightTransport, even_light_in_corners_is_no_error) {
    test::BoxRoom box;
    box.wall.exitance = glm::vec3(100);
    const geometry::PatchMesh mesh = test::boxRoom(box);
    DaylightTransport transport(test::device(), mesh);
    const Moment moment = transport.light(daylight::Sky{});
    for (const LightParts& parts : moment.patches) {
        EXPECT_LT(std::abs(photometric(parts.total()) - 200), parts.error); // exitance / (1 - reflectance)
        EXPECT_LT(parts.error, 0.015 * 200);
    }
}

// The patch beside it is the brightest by far, and what a solver may leave over is told against that one.
TEST(DaylightTransport, light_of_a_tiny_lamp_beside_a_wall_is_kept) {
    for (const float rho : {0.2f, 0.7f}) {
        test::BoxRoom box{.cells = {7, 7, 7}};
        box.wall.reflectance = glm::vec3(rho);
        geometry::PatchMesh mesh = test::boxRoom(box);
        const size_t room = mesh.corners.size();
        test::BoxRoom lamp{.low = {0.01, 1.3, 2.2}, .high = {0.02, 1.31, 2.21}, .cells = {1, 1, 1}};
        lamp.wall = {.name = "lamp", .reflectance = glm::vec3(0.5f), .exitance = glm::vec3(1e6f)};
        test::addBox(mesh, lamp);
        std::reverse(mesh.corners.begin() + static_cast<long>(room), mesh.corners.end()); // faces outwards
        DaylightTransport transport(test::device(), mesh);
        for (int again = 0; again < 2; ++again) {
            const MomentReport report = transport.light(daylight::Sky{}).report;
            EXPECT_LT(report.energyImbalance, 5e-7) << rho; // rounding
            EXPECT_TRUE(report.radiosity.converged) << rho;
        }
    }
}

// What sunlight sends on from patches that it lights in part: on patches of 1 m against the same room in
// patches of 25 cm, which hardly err themselves.
TEST(SunBounce, is_what_a_mesh_four_times_as_fine_gives) {
    const geometry::PatchMesh coarse = squares(1), fine = squares(4);
    TransportOptions options;
    options.formFactors.maxError = 1e-4;
    DaylightTransport few(test::device(), coarse, options), many(test::device(), fine, options);
    const size_t n = coarse.patchCount();
    const std::vector<size_t> whole = wholes(fine, coarse, 1);
    const std::vector<float> values = few.formFactors().values.download<float>(n * n);
    std::vector<float> rowSums(n, 0);
    for (size_t k = 0; k < n * n; ++k) rowSums[k / n] += values[k];
    // Light of the first bounce.
    const auto bounced = [](DaylightTransport& transport, const geometry::PatchMesh& mesh,
                            const Moment& moment) {
        const std::vector<float> factors =
            transport.formFactors().values.download<float>(mesh.patchCount() * mesh.patchCount());
        std::vector<double> light(mesh.patchCount());
        for (size_t i = 0; i < light.size(); ++i)
            for (size_t j = 0; j < light.size(); ++j)
                light[i] += double{factors[i * light.size() + j]} *
                            photometric(mesh.materials[mesh.material[j]].reflectance * moment.patches[j].sun);
        return light;
    };
    for (const glm::dvec3 towards : {glm::dvec3(0.5, 0.35, -0.5), {-0.7, 0.5, -0.6}, {0.1, 0.2, -0.9}}) {
        const daylight::Sky sky = sunny(towards);
        const std::vector<double> even = bounced(few, coarse, few.light(sky)),
                                  parts = bounced(many, fine, many.light(sky));
        std::vector<double> exact(n, 0);
        for (size_t i = 0; i < parts.size(); ++i) exact[whole[i]] += parts[i] / 16;
        std::vector<SunlitParts> partly;
        SunPatches(coarse, sky.sun.direction).onPatches(&partly);
        ASSERT_FALSE(partly.empty());
        std::vector<glm::vec3> more(n, glm::vec3(0)), sent = more;
        const NearPairs pairs(coarse, few.formFactors().values);
        SunBounce(few.parts().points, pairs, rowSums).addTo(more, sent, partly, sky.sun.normalIlluminance);
        for (size_t k = 0; k < n * n; ++k) more[k / n] += values[k] * sent[k % n];
        double before = 0, after = 0, made = 0, all = 0;
        for (size_t i = 0; i < n; ++i) {
            before += std::pow(even[i] - exact[i], 2);
            after += std::pow(even[i] + photometric(more[i]) - exact[i], 2);
            made += geometry::patchArea(coarse, i) * photometric(more[i]);
            all += geometry::patchArea(coarse, i) * even[i];
        }
        EXPECT_GT(before, 0);
        EXPECT_LT(std::sqrt(after), 0.25 * std::sqrt(before));
        EXPECT_NEAR(made, 0, 1e-5 * all); // float sums
    }
}

// Where sunlight ends on a slot's own walls, patches as deep as the slot do not know how little of it gets
// down: what they send far is less than their mean would. In dark walls what sensors see of it is exact; in
// bright ones what such patches reflect on is 5.2 % too much at the worst sensor, 5.0 % against a mesh of
// the room three times as fine.
TEST(SunBounce, little_of_what_ends_at_the_top_of_a_slot_gets_into_the_room) {
    const std::vector<Sensor> sensors{
        {{1, 0.8, 1}, {0, 1, 0}}, {{0.4, 0.8, 0.5}, {0, 1, 0}}, {{1.5, 0.5, 1.6}, {0, 1, 0}}};
    const geometry::PatchMesh bright = test::slottedRoom(4, 12, 2, 1);
    std::vector<geometry::Material> dark = bright.materials;
    dark[0].reflectance = dark[1].reflectance = glm::vec3(1e-3F);
    DaylightTransport few(test::device(), bright), many(test::device(), test::slottedRoom(4, 60, 18, 4));
    few.setSensors(sensors), many.setSensors(sensors);
    for (const bool isDark : {false, true}) {
        if (isDark) few.setMaterials(dark), many.setMaterials(dark);
        for (const glm::dvec3 towards : {glm::dvec3(0.3, 0.6, -1), {0.1, 1.2, 1}}) {
            daylight::Sky sky;
            sky.sun = {glm::normalize(towards), 50000};
            const Moment stated = few.light(sky), there = many.light(sky);
            for (size_t s = 0; s < sensors.size(); ++s) {
                const double lux = photometric(stated.sensors[s].total()),
                             exact = photometric(there.sensors[s].total());
                if (isDark)
                    EXPECT_NEAR(lux, exact, 5e-4 * exact + 1e-5) << s;
                else
                    EXPECT_NEAR(lux, exact, 0.055 * exact) << s;
                EXPECT_NEAR(lux, exact, stated.sensors[s].error) << s;
            }
        }
    }
}

// A sensor that sees the lower rows of patches on a slot's wall, the last of which the sun lights where the
// ceiling hides it: each fills less than a thousandth of the view, but the room has hardly any other light.
TEST(SunBounce, small_patches_of_a_slot_do_not_shine_where_they_are_dark) {
    const Sensor sensor{{1, 1, 1.88}, {0, 0.8, 0.6}};
    daylight::Sky sky;
    sky.sun = {glm::normalize(glm::dvec3(0, 1.7, 1)), 50000}; // down to 13 cm; 12 are seen
    const auto lux = [&](uint32_t deep) {
        DaylightTransport transport(test::device(), test::slottedRoom(2, 16, deep, 1));
        transport.setSensors({sensor});
        return photometric(transport.light(sky).sensors[0].total());
    };
    // 2.1 % is what six rows reflect on too much; twelve are within 0.2 % of 24.
    const double exact = lux(12);
    EXPECT_NEAR(lux(6), exact, 0.03 * exact);
}

// What a grid and corners have at a point of a triangle, to the nearest place.
glm::vec3 detailAt(const LightDetail& detail, const PatchGlow& glow, const geometry::PatchMesh& mesh,
                   glm::dvec3 point) {
    const glm::vec3* lux = &detail.corners[mesh.firstCorner[glow.patch]];
    const std::vector<glm::dvec3> corner = geometry::patchCorners(mesh, glow.patch);
    const auto places = PatchGlow::places(corner[0], corner[1], corner[2]);
    const size_t nearest = static_cast<size_t>(
        std::ranges::min_element(places, {}, [&](glm::dvec3 at) { return glm::length(at - point); }) -
        places.begin());
    return glow.lux[nearest] + PatchGlow::places(lux[0], lux[1], lux[2])[nearest];
}

// Triangles of 1 m with what they have of their light within themselves come much nearer to squares of 25 cm
// than their means do, and never have more of it than all of their light.
TEST(SunGlow, is_the_light_within_a_patch_that_finer_patches_have) {
    const geometry::PatchMesh coarse = squares(1, true), fine = squares(4);
    DaylightTransport few(test::device(), coarse, {.forPictures = true}), many(test::device(), fine);
    for (const glm::dvec3 towards : {glm::dvec3(0.5, 0.35, -0.5), {-0.7, 0.5, -0.6}}) {
        const Lighting light = few.light(sunny(towards)).lighting,
                       exact = many.light(sunny(towards)).lighting;
        ASSERT_EQ(light.detail.mean.size(), coarse.patchCount());
        ASSERT_FALSE(light.detail.grids.empty());
        double before = 0, after = 0;
        for (const PatchGlow& glow : light.detail.grids) {
            const uint32_t i = glow.patch;
            const float rho = coarse.materials[coarse.material[i]].reflectance.y;
            const double mean = photometric(light.exitance[i] - rho * light.sunIlluminance[i]);
            EXPECT_LE(rho * photometric(light.detail.mean[i]), 1.02 * mean);
            const std::vector<glm::dvec3> corner = geometry::patchCorners(coarse, i);
            for (size_t k = 0; k < fine.patchCount(); ++k) {
                const glm::dvec3 at = geometry::patchCentroid(fine, k);
                if (fine.surface[k] != coarse.surface[i] ||
                    glm::length(glm::cross(corner[1] - corner[0], at - corner[0])) +
                            glm::length(glm::cross(corner[2] - corner[1], at - corner[1])) +
                            glm::length(glm::cross(corner[0] - corner[2], at - corner[2])) >
                        1.001 * 2 * geometry::patchArea(coarse, i))
                    continue;
                const double there = photometric(exact.exitance[k] - rho * exact.sunIlluminance[k]);
                const double within =
                    rho * photometric(detailAt(light.detail, glow, coarse, at) - light.detail.mean[i]);
                before += std::pow(mean - there, 2), after += std::pow(mean + within - there, 2);
            }
        }
        EXPECT_GT(before, 0);
        EXPECT_LT(std::sqrt(after), 0.65 * std::sqrt(before));
    }
    EXPECT_TRUE(DaylightTransport(test::device(), coarse)
                    .light(sunny({0.5, 0.35, -0.5}))
                    .lighting.detail.grids.empty());
}

// At the middles of triangles, most of which see the window, what sensors have there; also where light bends.
TEST(SkyDetail, is_the_direct_light_that_sensors_see) {
    const geometry::PatchMesh mesh = squares(1, true);
    DaylightTransport transport(test::device(), mesh, {.forPictures = true});
    std::vector<Sensor> sensors;
    for (size_t p = 0; p < mesh.patchCount(); ++p)
        sensors.push_back({geometry::patchCentroid(mesh, p), geometry::patchNormal(mesh, p)});
    transport.setSensors(sensors);
    const Moment moment = transport.light(test::overcast());
    const LightDetail& detail = moment.lighting.detail;
    ASSERT_FALSE(detail.grids.empty());
    EXPECT_LT(detail.grids.size(), mesh.patchCount());
    double usual = 0;
    for (const LightParts& parts : moment.sensors) usual += photometric(parts.sky + parts.ground);
    usual /= static_cast<double>(mesh.patchCount());
    std::vector<const PatchGlow*> gridOf(mesh.patchCount());
    for (const PatchGlow& grid : detail.grids) gridOf[grid.patch] = &grid;
    for (size_t p = 0; p < mesh.patchCount(); ++p) {
        if (mesh.materials[mesh.material[p]].isOpening()) continue;
        PatchGlow grid{static_cast<uint32_t>(p), {}};
        if (gridOf[p]) grid = *gridOf[p];
        const double there = photometric(moment.sensors[p].sky + moment.sensors[p].ground);
        EXPECT_NEAR(photometric(detailAt(detail, grid, mesh, sensors[p].position)), there,
                    0.08 * (there + usual)); // without a grid 0.05 may stay, under an even sky
    }
}

TEST(DaylightTransport, grey_scenes_take_one_channel_and_give_the_same_light) {
    DaylightTransport grey(test::device(), windowRoom());
    DaylightTransport coloured(test::device(), windowRoom({0.5f, 0.5f, 0.5001f}));
    const Moment one = grey.light(sunny()), three = coloured.light(sunny());
    for (size_t i = 0; i < one.patches.size(); ++i) {
        EXPECT_NEAR(one.lighting.exitance[i].y, three.lighting.exitance[i].y,
                    2e-4 * one.lighting.exitance[i].y +
                        0.2); // two solutions, each within 1e-4 of the largest
        EXPECT_EQ(one.lighting.exitance[i].x, one.lighting.exitance[i].z);
    }
}

TEST(DaylightTransport, moments_together_are_moments_alone) {
    DaylightTransport transport(test::device(), windowRoom({0.7f, 0.4f, 0.1f}));
    transport.setSensors({{{2, 1, 2}, {0, 1, 0}}, {{1, 2, 3}, {0, 0, -1}}});
    std::vector<daylight::Sky> skies{sunny(), sunny({-0.6, 0.2, -0.4}),
                                     daylight::cieGeneralSky(16, {0, 1, 0}, 5000)};
    const std::vector<Moment> together = transport.light(skies);
    for (size_t k = 0; k < skies.size(); ++k) {
        const Moment alone = transport.light(skies[k]);
        for (size_t s = 0; s < 2; ++s) {
            const double lux = photometric(alone.sensors[s].total());
            EXPECT_NEAR(photometric(together[k].sensors[s].total()), lux, 1e-3 * lux);
        }
    }
}

TEST(DaylightTransport, a_day_of_moments_is_each_moment_alone) {
    DaylightTransport day(test::device(), windowRoom({0.7f, 0.4f, 0.1f}));
    uint32_t first = 0, last = 0;
    for (int k = 0; k < 40; ++k) {
        const daylight::Sky sky = sunny({-0.5 + 0.02 * k, 0.3 + 0.01 * k, -0.8});
        const Moment moment = day.light(sky);
        EXPECT_TRUE(moment.report.radiosity.converged);
        EXPECT_LE(moment.report.radiosity.bound, 1e-4);
        (k == 0 ? first : last) = moment.report.radiosity.passes;
        if (k % 13 != 0) continue;
        DaylightTransport fresh(test::device(), windowRoom({0.7f, 0.4f, 0.1f}));
        const Moment alone = fresh.light(sky);
        double most = 0;
        for (const glm::vec3& b : alone.lighting.exitance) most = std::max(most, photometric(b));
        for (size_t i = 0; i < alone.patches.size(); ++i) // two solutions, each within the tolerance
            EXPECT_NEAR(photometric(moment.lighting.exitance[i]), photometric(alone.lighting.exitance[i]),
                        2e-4 * most);
    }
    EXPECT_LT(last, first); // what was solved before is of use
}

// Answers that resemble one another leave little but rounding of what is new in each.
TEST(DaylightTransport, moments_close_together_keep_within_their_bound) {
    const geometry::PatchMesh room =
        geometry::readPatches(kCases + "c_L_glass_clear_mar21_13_g0.2/model.obj");
    TransportOptions precise;
    precise.radiosity.tolerance = 1e-6;
    DaylightTransport day(test::device(), room), exact(test::device(), room, precise);
    for (int round = 0; round < 48; ++round) {
        std::vector<daylight::Sky> skies;
        for (int k = 0; k < 8; ++k) {
            const double angle = 0.3 + 0.00436 * (8 * round + k);
            skies.push_back(sunny({-std::cos(angle), 0.8 * std::sin(angle), 0.6 * std::sin(angle)}));
        }
        const Moment moment = day.light(skies).back();
        if (round % 8 != 7) continue;
        exact.setMaterials(room.materials); // forgets what was solved before
        const Moment alone = exact.light(skies.back());
        double most = 0, off = 0;
        for (size_t i = 0; i < alone.patches.size(); ++i)
            for (int c = 0; c < 3; ++c) {
                const double b = alone.lighting.exitance[i][c];
                most = std::max(most, b), off = std::max(off, std::abs(b - moment.lighting.exitance[i][c]));
            }
        EXPECT_TRUE(moment.report.radiosity.converged);
        EXPECT_LT(moment.report.radiosity.bound, 2e-4);
        EXPECT_LE(off, (moment.report.radiosity.bound + alone.report.radiosity.bound) * most) << round;
    }
}

TEST(DaylightTransport, what_a_moment_does_not_need_is_skipped_with_a_reason) {
    DaylightTransport transport(test::device(), windowRoom());
    const auto skips = [](const Moment& moment, const std::string& what) {
        return std::any_of(moment.report.skipped.begin(), moment.report.skipped.end(),
                           [&](const std::string& s) { return s.starts_with(what); });
    };
    const Moment night = transport.light(daylight::Sky{});
    EXPECT_TRUE(skips(night, "sky") && skips(night, "sun") && skips(night, "interreflection"));
    EXPECT_EQ(photometric(night.patches[5].total()), 0);
    EXPECT_EQ(night.report.radiosity.passes, 0u);
    EXPECT_TRUE(skips(transport.light(daylight::cieGeneralSky(16, {0, 1, 0}, 5000)), "sun"));
    EXPECT_TRUE(skips(transport.light(sunny({0, 0.5, 1})), "sun: shines on no opening"));
    DaylightTransport closed(test::device(), test::boxRoom({}));
    EXPECT_TRUE(skips(closed.light(sunny()), "sky and ground: no opening"));
}

TEST(DaylightTransport, new_materials_give_what_a_new_transport_gives) {
    geometry::PatchMesh mesh = windowRoom();
    DaylightTransport transport(test::device(), mesh);
    transport.setSensors({{{2, 1, 2}, {0, 1, 0}}});
    mesh.materials[0].reflectance = {0.8f, 0.6f, 0.4f};
    mesh.materials[1].transmittance = {0.5f, 0.6f, 0.7f};
    transport.setMaterials(mesh.materials);
    DaylightTransport fresh(test::device(), mesh);
    fresh.setSensors({{{2, 1, 2}, {0, 1, 0}}});
    EXPECT_EQ(transport.light(sunny()).sensors[0].total(), fresh.light(sunny()).sensors[0].total());
}

TEST(DaylightTransport, impossible_reflectances_are_refused) {
    for (float bad : {1.0f, -0.1f, std::nanf("")})
        EXPECT_THROW(DaylightTransport(test::device(), windowRoom({0.5f, bad, 0.5f})), geometry::InputError);
}

} // namespace
} // namespace heliodon::compute
