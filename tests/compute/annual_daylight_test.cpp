#include "compute/annual_daylight.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "compute/straight_sky.h"
#include "tests/compute/rooms.h"
#include "tests/compute/skies.h"
#include "tests/gpu/test_device.h"

namespace heliodon::compute {
namespace {

using test::overcast;
using test::sunny;

// A box with a window to -z.
geometry::PatchMesh windowRoom(glm::vec3 wall, glm::vec3 glass) {
    test::BoxRoom box;
    box.wall.reflectance = wall;
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    geometry::PatchMesh mesh = test::boxRoom(box);
    for (geometry::Material& m : mesh.materials)
        if (m.isOpening()) m.transmittance = glass;
    return mesh;
}

// Night, cloud, sun through the window from three sides, sun behind the room.
const std::vector<daylight::Sky> kSkies{daylight::Sky{},          overcast(),
                                        sunny({0.2, 0.5, -0.8}),  sunny({-0.6, 0.2, -0.4}),
                                        sunny({0.1, 0.15, -0.9}), sunny({0, 0.5, 1})};
const std::vector<Sensor> kSensors{{{2, 1, 2}, {0, 1, 0}}, {{1, 2, 3}, {0, 0, -1}}, {{3, 0.1, 1}, {0, 1, 0}}};

struct Arrays {
    std::vector<float> lux, sun, error;
    YearReport report;
};

Arrays yearOf(DaylightTransport& transport, const std::vector<daylight::Sky>& skies,
              const std::vector<Sensor>& sensors = kSensors) {
    AnnualDaylight annual(transport, skies, sensors.size());
    Arrays a;
    for (auto* values : {&a.lux, &a.sun, &a.error}) values->resize(sensors.size() * skies.size());
    annual.sensors(sensors, a.lux, a.sun, a.error);
    a.report = annual.report();
    return a;
}

void expectFull(const geometry::PatchMesh& mesh, const std::vector<daylight::Sky>& skies = kSkies,
                double most = 0.01, const std::vector<Sensor>& sensors = kSensors) {
    DaylightTransport transport(test::device(), mesh);
    const Arrays year = yearOf(transport, skies, sensors);
    const std::vector<Moment> full = transport.light(skies);
    for (size_t s = 0; s < sensors.size(); ++s)
        for (size_t h = 0; h < skies.size(); ++h) {
            const LightParts& parts = full[h].sensors[s];
            const double lux = photometric(parts.total());
            // Form factors from one point a patch keep reciprocity to about 1 %.
            EXPECT_NEAR(year.lux[s * skies.size() + h], lux, most * lux) << "sensor " << s << ", hour " << h;
            EXPECT_NEAR(year.sun[s * skies.size() + h], photometric(parts.sun),
                        1e-5 * photometric(parts.sun));
            EXPECT_LE(std::abs(year.lux[s * skies.size() + h] - lux),
                      year.error[s * skies.size() + h] + 1e-3 * lux);
        }
}

TEST(AnnualDaylight, hours_are_what_the_full_computation_gives) {
    expectFull(windowRoom(glm::vec3(0.6f), glm::vec3(0.8f)));
}

// A sky that is brightest round a low sun, straight before the window.
TEST(AnnualDaylight, sky_round_the_sun_is_seen_as_it_is) {
    std::vector<daylight::Sky> skies;
    for (const double x : {-0.2, 0.0, 0.3})
        skies.push_back(
            daylight::perezSky({-1, -0.3, 12, -5, 0.5}, glm::normalize(glm::dvec3(x, 0.1, -1)), 1e3));
    expectFull(windowRoom(glm::vec3(0.6f), glm::vec3(0.8f)), skies, 0.004);
    skies = {daylight::cieIntermediateSky(glm::normalize(glm::dvec3(0.1, 0.2, -1)), 2e3)};
    expectFull(windowRoom(glm::vec3(0.6f), glm::vec3(0.8f)), skies, 0.004);
}

// Samples all over the hemisphere, as crowded as those of the cells of a wall beside a sensor are.
TEST(AnnualDaylight, samples_of_sky_count_by_the_luminance_at_each) {
    std::minstd_rand random(7);
    std::uniform_real_distribution<float> place(-1, 1);
    std::vector<NearLight> near(2);
    for (int k = 0; k < 20000; ++k)
        near[0].sky.push_back({glm::normalize(glm::vec3(place(random), 0.5f * place(random), -1)),
                               glm::vec3(1 + place(random), 0.5f, 1 - place(random))});
    SkyView none;
    none.first.resize(near.size() + 1, 0);
    std::vector<daylight::Sky> skies{overcast(), sunny({0.2, 0.1, -1})};
    skies.push_back(daylight::perezSky({-1, -0.3, 12, -5, 0.5}, glm::normalize(glm::dvec3(0, 0.1, -1)), 1e3));
    skies.push_back(daylight::cieIntermediateSky(glm::normalize(glm::dvec3(0.1, 0.2, -1)), 2e3));
    // Black up to 1.6 degrees.
    skies.push_back(
        daylight::perezSky({-0.222, 0.041, 12, -5, 0.5}, glm::normalize(glm::dvec3(0, 0.035, -1)), 1e3));
    // Those of a slit at the horizon as well, which see nothing else.
    for (int k = 0; k < 200; ++k)
        near[1].sky.push_back(
            {glm::normalize(glm::vec3(place(random), 0.03f + 0.01f * place(random), -1)), glm::vec3(1)});
    std::vector<float> taken(near.size() * skies.size(), 0);
    const StraightHours hours(skies, {0, 1, 2, 3, 4});
    StraightSky(hours, none, near).addTo(taken);
    for (size_t s = 0; s < near.size(); ++s)
        for (size_t h = 0; h < skies.size(); ++h) {
            double lux = 0;
            for (const SkySample& sample : near[s].sky)
                lux += photometric(sample.weight) *
                       skies[h].luminance(glm::normalize(glm::dvec3(sample.direction)));
            EXPECT_NEAR(taken[s * skies.size() + h], lux, (s == 0 ? 1e-4 : 1e-3) * lux) << s << " " << h;
        }
    EXPECT_GT(hours.bytes(), sizeof(daylight::SkyTables));
    const StraightHours forgetful(skies, {0, 1, 2, 3, 4}, 0);
    EXPECT_LT(forgetful.bytes(), sizeof(daylight::SkyTables));
    std::vector<float> again(taken.size(), 0);
    StraightSky(forgetful, none, near).addTo(again);
    EXPECT_EQ(again, taken);
    std::ranges::fill(again, 0.0F);
    StraightSky(hours, none, near).addTo(again, {}, VectorWidth::baseline);
    EXPECT_EQ(again, taken);
}

TEST(AnnualDaylight, coloured_walls_and_tinted_glass_too) {
    expectFull(windowRoom({0.8f, 0.5f, 0.2f}, {0.8f, 0.7f, 0.5f}));
}

TEST(AnnualDaylight, rooms_behind_other_windows_too) {
    geometry::PatchMesh mesh = windowRoom(glm::vec3(0.6f), glm::vec3(0.8f));
    test::BoxRoom box{.low = {0, 0, -7}, .high = {5, 4, -2}, .cells = {5, 4, 5}};
    box.isGlass = [](glm::dvec3 p) { return p.z > -2 - 1e-9 && p.y > 1 && p.y < 3; };
    test::addBox(mesh, box, 1);
    expectFull(mesh, {overcast(), sunny({0.2, 0.4, 0.7}), sunny({0.2, 0.5, -0.8})}, 0.02);
    // Edges of sunlight seen through glass are averaged over patches, here of 1 m.
    expectFull(test::twoRooms(true), kSkies, 0.02);
    mesh = test::twoRooms(true, {0.7f, 0.5f, 0.3f});
    for (geometry::Material& m : mesh.materials)
        if (m.isOpening()) m.transmittance = {0.2f, 0.5f, 0.8f};
    expectFull(mesh, kSkies, 0.02, {{{2, 0.8, 7}, {0, 1, 0}}, {{1, 1.5, 9}, {0, 0, 1}}});
}

TEST(AnnualDaylight, sensors_a_hair_from_walls_too) {
    const std::vector<Sensor> corners{{{0.004, 0.01, 2.3}, {0, 1, 0}}, // beside sun on the floor
                                      {{0.01, 0.003, 1.9}, {1, 0, 0}},
                                      {{3.99, 2.997, 4.995}, {0, 0, -1}}};
    std::vector<daylight::Sky> skies = kSkies;
    skies.push_back(sunny({0.5, 0.35, -0.5}));
    geometry::PatchMesh mesh = windowRoom({0.8f, 0.5f, 0.2f}, {0.8f, 0.7f, 0.5f});
    mesh.materials[0].exitance = glm::vec3(5);
    expectFull(mesh, skies, 0.02, corners);
    DaylightTransport transport(test::device(), mesh);
    transport.setSensors(corners);
    transport.light(skies[0]);
    EXPECT_EQ(transport.report().sensorsNearWalls, corners.size());
}

// A spot of sun at the foot of the far wall, on patches of which the sensors see a part.
TEST(AnnualDaylight, sunlit_patches_that_a_horizon_cuts_count_by_what_is_above) {
    const std::vector<Sensor> nearFarWall{{{2.2, 1, 4.3}, {0, 0, -1}},
                                          {{1.4, 0.7, 4.4}, {0, 0, -1}},
                                          {{2.5, 0.8, 4.7}, {0, 0, -1}},
                                          {{2.5, 0.8, 4.3}, {0, 0, 1}}};
    expectFull(windowRoom(glm::vec3(0.6f), glm::vec3(0.8f)),
               {overcast(), sunny({0, 0.45, -0.945}), sunny({0.1, 0.2, -0.96}), sunny({-0.1, 0.5, -0.95})},
               0.01, nearFarWall);
}

// Coloured walls behind clear glass, too: one channel of light stands for three, whatever walls make of it.
TEST(AnnualDaylight, sun_that_ends_in_a_slot_too) {
    for (const glm::vec3 rho : {glm::vec3(0.6f), glm::vec3(0.1f, 0.6f, 0.6f), glm::vec3(0, 0.6f, 0)}) {
        geometry::PatchMesh mesh = test::slottedRoom(4, 12, 2, 1);
        mesh.materials[1].reflectance = rho;
        expectFull(mesh, {sunny({0.3, 0.6, -1}), sunny({0.1, 1.2, 1})}, 0.01,
                   {{{1, 0.8, 1}, {0, 1, 0}}, {{0.4, 0.8, 0.5}, {0, 1, 0}}, {{1.5, 0.5, 1.6}, {0, 1, 0}}});
    }
    // Small patches, lit where the ceiling hides them.
    expectFull(test::slottedRoom(2, 16, 6, 1), {sunny({0, 1.7, 1})}, 0.01, {{{1, 1, 1.88}, {0, 0.8, 0.6}}});
}

// An hour whose sun lights small patches of a slot, among hours whose sun lights patches that look a hundred
// times as large: it has the same bits whatever hours it shares a block of memory with.
TEST(AnnualDaylight, what_edges_of_sunlight_count_does_not_depend_on_other_hours) {
    const std::vector<Sensor> sensors{{{1, 1, 1.88}, {0, 0.8, 0.6}}};
    const daylight::Sky rare = sunny({0, 1.7, 1});
    std::vector<daylight::Sky> skies;
    for (int k = 0; k < 20; ++k) skies.push_back(sunny({0.04 * (k - 10), 1.2, 0.02 * k - 0.2}));
    skies.insert(skies.begin() + 10, rare);
    DaylightTransport transport(test::device(), test::slottedRoom(2, 16, 6, 1));
    const auto year = [&](const std::vector<daylight::Sky>& of, size_t sunBytes, size_t blocks) {
        AnnualDaylight annual(transport, of, sensors.size(), {}, sunBytes);
        std::vector<float> lux(of.size()), sun(lux), error(lux);
        annual.sensors(sensors, lux, sun, error);
        EXPECT_EQ(annual.report().sunBlocks, blocks);
        return lux;
    };
    const std::vector<float> whole = year(skies, AnnualDaylight::kSunBytes, 1);
    EXPECT_EQ(year(skies, 1, skies.size()), whole);
    const float alone = year({rare}, AnnualDaylight::kSunBytes, 1)[0];
    EXPECT_NEAR(whole[10], alone, 1e-5F * alone);
}

TEST(AnnualDaylight, sun_that_may_be_just_beside_a_beam_is_told) {
    const geometry::PatchMesh mesh = windowRoom(glm::vec3(0.6f), glm::vec3(0.8f));
    const daylight::Sky sky = sunny({0.2, 0.5, -0.8});
    const SunPatches beam(mesh, sky.sun.direction);
    const auto at = [](double x) { return glm::dvec3(x, 0.1, 1.5); };
    const auto sun = [&](double x) { return photometric(beam.beamAtPoint(at(x), {0, 1, 0}).share); };
    double lit = 2, dark = 4;
    ASSERT_GT(sun(lit), 0);
    ASSERT_EQ(sun(dark), 0);
    while (dark - lit > 1e-6) (sun((lit + dark) / 2) > 0 ? lit : dark) = (lit + dark) / 2;
    DaylightTransport transport(test::device(), mesh);
    AnnualDaylight annual(transport, {sky}, 2);
    std::vector<float> lux(2), direct(2), error(2);
    annual.sensors(std::vector<Sensor>{{at(dark), {0, 1, 0}}, {at(dark + 0.1), {0, 1, 0}}}, lux, direct,
                   error);
    EXPECT_EQ(direct[0], 0);
    ASSERT_EQ(annual.beamEdges().size(), 1u);
    const double there = sky.sun.normalIlluminance * sun(lit);
    EXPECT_NEAR(annual.beamEdges().at(0), there, 1e-4 * there);
    EXPECT_GT(error[0], there);
    EXPECT_LT(error[1], 0.1 * there);
}

TEST(AnnualDaylight, the_suns_disc_has_a_penumbra_in_years_and_in_moments) {
    const geometry::PatchMesh mesh = windowRoom(glm::vec3(0.6f), glm::vec3(0.8f));
    const daylight::Sky sky = sunny({0.2, 0.5, -0.8});
    const SunScene scene(mesh, true);
    const SunPatches beam(scene, sky.sun.direction);
    const std::vector<Sensor> sensors{{{2.625, 0.1, 1.5}, {0, 1, 0}}, {{2.5, 0.1, 1.5}, {0, 1, 0}}};
    const double half = sky.sun.normalIlluminance *
                        photometric(beam.beamAtPoint(sensors[0].position, sensors[0].normal).share);
    DaylightTransport transport(test::device(), mesh, {.sunDisc = true});
    AnnualDaylight annual(transport, {sky}, 2);
    std::vector<float> lux(2), direct(2), error(2);
    annual.sensors(sensors, lux, direct, error);
    EXPECT_NEAR(direct[0], 0.5 * direct[1], 0.02 * direct[1]);
    EXPECT_NEAR(direct[0], half, 1e-5 * half);
    const Moment moment = transport.light(sky);
    EXPECT_NEAR(photometric(moment.sensors[0].sun), half, 1e-5 * half);
    EXPECT_GT(moment.sensors[0].error, 0.02 * direct[1]);
}

// Sensors go through the edges of sunlight sixteen at a time: the last ones are fewer, and one of them is in
// no room.
TEST(AnnualDaylight, sensors_get_what_they_get_in_any_company) {
    std::vector<Sensor> sensors;
    for (int k = 0; k < 20; ++k)
        sensors.push_back({{0.6 + 0.14 * k, 0.3 + 0.02 * k, 0.9 + 0.18 * k}, {0.3, 1, -0.1 * k}});
    sensors[17].position.y = -4;
    const std::vector<Sensor> last(sensors.begin() + 16, sensors.end());
    DaylightTransport transport(test::device(), windowRoom(glm::vec3(0.6f), glm::vec3(0.8f)));
    const Arrays all = yearOf(transport, kSkies, sensors), few = yearOf(transport, kSkies, last);
    for (size_t s = 16; s < sensors.size(); ++s)
        for (size_t h = 0; h < kSkies.size(); ++h) {
            const float lux = all.lux[s * kSkies.size() + h];
            EXPECT_NEAR(lux, few.lux[(s - 16) * kSkies.size() + h], 1e-5 * lux) << s << ", hour " << h;
            EXPECT_EQ(lux > 0, s != 17 && h > 0);
        }
    expectFull(windowRoom(glm::vec3(0.6f), glm::vec3(0.8f)), kSkies, 0.01, sensors);
}

// Far down in a slot much thinner than its patches, slopes leave next to nothing on either side of nought.
TEST(AnnualDaylight, no_light_is_negative_in_a_slot) {
    test::BoxRoom slot{.low = {0, 0, 0}, .high = {3, 2, 0.002}, .cells = {6, 3, 1}};
    slot.wall.reflectance = glm::vec3(0.95f);
    slot.isGlass = [](glm::dvec3 p) { return p.y > 2 - 1e-9; };
    std::vector<Sensor> sensors;
    for (int k = 0; k < 24; ++k)
        sensors.push_back({{0.1 + 0.12 * k, 0.05 + 0.02 * k, k % 2 ? 1e-4 : 19e-4}, {0, 0, k % 2 ? 1 : -1}});
    std::vector<daylight::Sky> skies{overcast()};
    for (const double height : {0.05, 0.5, 3.0})
        for (const double x : {-1.0, 0.0, 0.4}) skies.push_back(sunny({x, height, 0.01}));
    DaylightTransport transport(test::device(), test::boxRoom(slot));
    const Arrays year = yearOf(transport, skies, sensors);
    for (size_t at = 0; at < year.lux.size(); ++at) {
        EXPECT_GE(year.lux[at], year.sun[at]);
        EXPECT_GE(year.error[at], 0);
    }
}

TEST(AnnualDaylight, surfaces_that_emit_light_the_night) {
    geometry::PatchMesh mesh = windowRoom(glm::vec3(0.6f), glm::vec3(0.8f));
    mesh.materials[0].exitance = glm::vec3(50);
    expectFull(mesh);
}

TEST(AnnualDaylight, hours_that_need_no_sun_or_no_sky_are_counted) {
    DaylightTransport transport(test::device(), windowRoom(glm::vec3(0.6f), glm::vec3(0.8f)));
    const YearReport report = yearOf(transport, kSkies).report;
    EXPECT_EQ(report.hours, 6u);
    EXPECT_EQ(report.lit, 5u);
    EXPECT_EQ(report.withSun, 3u);
    EXPECT_EQ(report.sunOutside, 1u);
    EXPECT_EQ(report.sunless, 1u);
    EXPECT_EQ(report.checkedHours, 5u); // all that are lit
    EXPECT_LT(report.checkRms, 0.01);
}

std::vector<daylight::Sky> skiesWithRibbons() {
    std::vector<daylight::Sky> skies = kSkies;
    for (const double b : {0.02, 0.3}) {
        skies.push_back(daylight::perezSky({2, b, 3, -2, 0.2}, glm::normalize(glm::dvec3(0.5, 0.03, -1)),
                                           10 * std::exp(-100 * b)));
        skies.back().sun = {skies.back().shapeDirection, 500};
    }
    return skies;
}

// Of sky elements, which are 6 degrees high, a ribbon fills a tenth: the sensor below the sill sees a little.
TEST(AnnualDaylight, skies_with_a_ribbon_at_the_horizon_are_solved_in_full) {
    const std::vector<daylight::Sky> skies = skiesWithRibbons();
    const geometry::PatchMesh mesh = windowRoom(glm::vec3(0.6f), glm::vec3(0.8f));
    expectFull(mesh, skies, 0.01,
               {{{2, 1, 2}, {0, 1, 0}}, {{2, 0.97, 3}, {0, 0, -1}}, {{0.01, 0.9, 2}, {1, 0, 0}}});
    DaylightTransport transport(test::device(), mesh);
    EXPECT_EQ(yearOf(transport, skies).report.solved, 2u);
    EXPECT_EQ(yearOf(transport, skies).report.lit, 7u);
}

// Most of the work here, and all of it in the first call.
TEST(AnnualDaylight, skies_with_a_ribbon_are_solved_once_for_all_sensors) {
    const std::vector<daylight::Sky> skies = skiesWithRibbons();
    DaylightTransport transport(test::device(), windowRoom(glm::vec3(0.6f), glm::vec3(0.8f)));
    std::vector<double> told;
    AnnualDaylight annual(transport, skies, kSensors.size(), [&](double share) { told.push_back(share); });
    std::vector<float> lux(skies.size()), sun(lux.size()), error(lux.size());
    for (const Sensor& sensor : kSensors) {
        annual.sensors({&sensor, 1}, lux, sun, error);
        EXPECT_GT(told.back(), 0.8);
        for (size_t h = kSkies.size(); h < skies.size(); ++h) {
            const LightParts full = transport.light(skies[h]).sensors[0];
            EXPECT_NEAR(lux[h], photometric(full.total()), 1e-5 * photometric(full.total()));
            EXPECT_NEAR(sun[h], photometric(full.sun), 1e-6 * photometric(full.sun));
            EXPECT_NEAR(error[h], full.error, 1e-2F * full.error);
        }
    }
    const auto first = std::find_if(told.begin(), told.end(), [](double share) { return share > 0.8; });
    ASSERT_TRUE(first != told.begin() && first != told.end());
    EXPECT_LT(*(first - 1), 0.2);
    EXPECT_NEAR(told.back(), 1, 1e-9);
}

TEST(AnnualDaylight, a_part_of_the_year_and_the_rest_are_all_of_it) {
    DaylightTransport transport(test::device(), windowRoom(glm::vec3(0.6f), glm::vec3(0.8f)));
    YearReport parts = yearOf(transport, {kSkies.begin(), kSkies.begin() + 3}).report;
    parts += yearOf(transport, {kSkies.begin() + 3, kSkies.end()}).report;
    const YearReport whole = yearOf(transport, kSkies).report;
    EXPECT_EQ(parts.hours, whole.hours);
    EXPECT_EQ(parts.lit, whole.lit);
    EXPECT_EQ(parts.withSun, whole.withSun);
    EXPECT_EQ(parts.checkedHours, whole.checkedHours);
    EXPECT_NEAR(parts.checkRms, whole.checkRms, 0.05 * whole.checkRms);
}

TEST(AnnualDaylight, a_room_without_openings_is_dark_all_year) {
    DaylightTransport transport(test::device(), test::boxRoom({}));
    const Arrays year = yearOf(transport, kSkies);
    for (float lux : year.lux) EXPECT_EQ(lux, 0);
    EXPECT_EQ(year.report.lit, 0u);
    EXPECT_EQ(year.report.withSun, 0u);
}

// Sensors one by one, each hour's sun made anew for each.
TEST(AnnualDaylight, what_is_told_of_its_work_ends_with_all) {
    DaylightTransport transport(test::device(), windowRoom(glm::vec3(0.6f), glm::vec3(0.8f)));
    std::vector<double> told;
    AnnualDaylight annual(
        transport, kSkies, kSensors.size(), [&](double share) { told.push_back(share); }, 1);
    std::vector<float> lux(kSkies.size()), sun(lux.size()), error(lux.size());
    for (const Sensor& sensor : kSensors) {
        EXPECT_TRUE(told.empty() || told.back() < 0.8);
        annual.sensors({&sensor, 1}, lux, sun, error);
    }
    EXPECT_EQ(annual.report().sunBlocks, 3u);
    EXPECT_NEAR(told.back(), 1, 1e-9);
}

TEST(AnnualDaylight, no_hours_and_no_sensors_are_fine) {
    DaylightTransport transport(test::device(), windowRoom(glm::vec3(0.6f), glm::vec3(0.8f)));
    EXPECT_TRUE(yearOf(transport, {}).lux.empty());
    EXPECT_TRUE(yearOf(transport, kSkies, {}).lux.empty());
}

TEST(HostGather, is_the_plain_product) {
    std::minstd_rand random(5);
    std::uniform_real_distribution<float> value(0, 1);
    for (const uint32_t n : {1u, 8u, 37u})
        for (const uint32_t columns : {0u, 1u, 11u}) {
            std::vector<float> factors(n * n), in(columns * n), out(in.size());
            for (float& x : factors) x = value(random);
            for (float& x : in) x = value(random);
            HostGather(factors, n).gather(in, out, columns);
            for (uint32_t c = 0; c < columns; ++c)
                for (uint32_t i = 0; i < n; ++i) {
                    double want = 0;
                    for (uint32_t j = 0; j < n; ++j) want += double{factors[i * n + j]} * in[c * n + j];
                    EXPECT_NEAR(out[c * n + i], want, 1e-5); // float sums of up to 37 terms below 1
                }
        }
}

// Tiles are of every height up to that of the widest processor.
TEST(PanelProduct, is_the_plain_sum_to_the_bit_whatever_the_processor) {
    std::minstd_rand random(3);
    std::uniform_real_distribution<float> value(-1, 1);
    std::vector<std::array<size_t, 3>> shapes{{1, 1, 1}, {8, 64, 16}, {3, 0, 9}};
    for (size_t rows = 1; rows < 28; ++rows) shapes.push_back({rows, 300, 19});
    for (const auto [rows, depth, columns] : shapes) {
        std::vector<float> a(rows * depth), out(rows * columns);
        Panels panels(depth, columns);
        for (float& x : a) x = value(random);
        for (size_t k = 0; k < depth; ++k)
            for (size_t c = 0; c < columns; ++c) panels.at(k, c) = value(random);
        for (const VectorWidth width : {VectorWidth::baseline, VectorWidth::avx2, VectorWidth::avx512}) {
            if (width > widestVectors()) break;
            multiply(a, rows, panels, out, width);
            for (size_t r = 0; r < rows; ++r)
                for (size_t c = 0; c < columns; ++c) {
                    float sum = 0;
                    for (size_t k = 0; k < depth;) {
                        float block = 0;
                        for (const size_t end = std::min(depth, k + Panels::kBlock); k < end; ++k)
                            block += a[r * depth + k] * panels.at(k, c);
                        sum += block;
                    }
                    ASSERT_EQ(out[r * columns + c], sum) << rows << " x " << depth << " x " << columns;
                }
        }
    }
}

} // namespace
} // namespace heliodon::compute
