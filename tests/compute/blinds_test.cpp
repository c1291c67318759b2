// Blinds before windows, from what falls on them to light in the room and to the year.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "compute/annual_daylight.h"
#include "compute/daylight_transport.h"
#include "compute/sun_hours.h"
#include "tests/compute/path_tracer.h"
#include "tests/compute/rooms.h"
#include "tests/compute/skies.h"
#include "tests/gpu/test_device.h"

namespace heliodon::compute {
namespace {

using test::overcast;
using test::sunny;

using geometry::Blind;

constexpr Blind kFabric{Blind::Kind::fabric, 0.3f, 0.5f};
constexpr Blind kSlats{Blind::Kind::slats, 0, 0.6f, 30};

// A box with a window of 2 m2 to -z.
geometry::PatchMesh windowRoom(const Blind& blind, bool glass = true, glm::vec3 wall = glm::vec3(0.5f),
                               glm::vec3 tint = glm::vec3(0.88f)) {
    test::BoxRoom box;
    box.wall.reflectance = wall;
    box.glass.transmittance = glass ? tint : glm::vec3(1);
    if (!glass) box.glass.refractiveIndex = 1;
    box.glass = daylight::withBlind(box.glass, blind);
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    return test::boxRoom(box);
}

daylight::Sky uniform(double luminance) {
    daylight::Sky sky = daylight::cieGeneralSky(5, {0, 1, 0}, luminance);
    sky.ground.luminance = luminance;
    return sky;
}

const std::vector<Sensor> kSensors{{{2, 1, 2}, {0, 1, 0}}, {{1, 2, 3}, {0, 0, -1}}, {{3, 0.1, 1}, {0, 1, 0}}};

Moment lightOf(const geometry::PatchMesh& mesh, const daylight::Sky& sky) {
    DaylightTransport transport(test::device(), mesh);
    transport.setSensors(kSensors);
    return transport.light(sky);
}

TEST(Blinds, a_fabric_under_an_even_sky_is_a_lamp) {
    const double luminance = 2000, glow = 0.3 * std::numbers::pi * luminance;
    const Moment blind = lightOf(windowRoom(kFabric, false), uniform(luminance));
    geometry::PatchMesh lamp = windowRoom({}, false);
    lamp.materials[1].transmittance = glm::vec3(0);
    lamp.materials[1].reflectance = glm::vec3(0.5f);
    lamp.materials[1].exitance = glm::vec3(static_cast<float>(glow));
    const Moment lit = lightOf(lamp, daylight::Sky{});
    for (size_t s = 0; s < kSensors.size(); ++s) {
        const double lux = photometric(lit.sensors[s].total());
        EXPECT_NEAR(photometric(blind.sensors[s].total()), lux, 1e-3 * lux);
        EXPECT_EQ(photometric(blind.sensors[s].sky), 0); // nothing passes straight
    }
    EXPECT_NEAR(blind.report.lumensIn, 2 * glow, 1e-3 * glow);
}

TEST(Blinds, what_the_sun_gives_a_blind_enters_or_is_absorbed) {
    const glm::dvec3 sun = glm::normalize(glm::dvec3(0.2, 0.5, -0.8));
    daylight::Sky sky;
    sky.sun = {sun, 80000};
    for (const Blind& blind : {kFabric, kSlats}) {
        const geometry::PatchMesh mesh = windowRoom(blind);
        const daylight::Window window(mesh.materials[1]);
        const Moment moment = lightOf(mesh, sky);
        const glm::dvec3 inwards(0, 0, 1);
        const double enters = window.straight(sun, inwards).y + window.scattered(sun, inwards).y;
        EXPECT_NEAR(moment.report.lumensIn, 2 * 80000 * -sun.z * enters, 1e-4 * moment.report.lumensIn);
        EXPECT_LT(moment.report.energyImbalance, 1e-3);
    }
}

TEST(Blinds, slats_wide_apart_are_hardly_there) {
    const Moment open = lightOf(windowRoom({}), overcast());
    Blind wide = kSlats;
    wide.slatAngleDeg = 0, wide.slatSpacing = 10, wide.reflectance = 0;
    const Moment slats = lightOf(windowRoom(wide), overcast());
    for (size_t s = 0; s < kSensors.size(); ++s) {
        const double share = photometric(slats.sensors[s].total()) / photometric(open.sensors[s].total());
        EXPECT_GT(share, 0.85); // F = 0.905 for light from everywhere
        EXPECT_LT(share, 1);
    }
}

// What windows send back is nothing where no light comes back to them; nor is its bound.
TEST(Blinds, in_a_black_room_nothing_is_left_to_solve) {
    const Moment moment = lightOf(windowRoom(kSlats, true, glm::vec3(0)), overcast());
    EXPECT_TRUE(moment.report.radiosity.converged);
    EXPECT_LT(moment.report.radiosity.bound, 1e-4);
}

TEST(Blinds, another_wing_shades_the_outside_of_a_window) {
    geometry::PatchMesh mesh = windowRoom(kFabric);
    const size_t own = mesh.patchCount();
    test::BoxRoom wing; // in front of the left half of the window
    wing.low = {-4, 0, -10}, wing.high = {2, 3, -6};
    test::addBox(mesh, wing, 1);
    const glm::dvec3 sun = glm::normalize(glm::dvec3(0, 0.01, -1));
    const SunPatches patches(mesh, sun);
    double lit = 0, whole = 0;
    for (size_t i = 0; i < own; ++i) {
        if (!mesh.materials[mesh.material[i]].isOpening()) continue;
        lit += geometry::patchArea(mesh, i) * patches.onOutside(i).y;
        whole += geometry::patchArea(mesh, i) * -sun.z;
    }
    EXPECT_NEAR(lit, 0.5 * whole, 1e-9 * whole);
}

TEST(Blinds, sky_elements_stand_for_the_sky) {
    const GlowingBlinds blinds(windowRoom(kSlats));
    ASSERT_EQ(blinds.groups().size(), 1u);
    const daylight::SkyPatches patches(2);
    const std::vector<float> coefficients = blinds.coefficients(0, patches, 1);
    for (const daylight::Sky& sky : {overcast(), uniform(1000), sunny({0.2, 0.5, 0.8})}) {
        const std::vector<double> luminances = patches.luminances(sky);
        double sum = 0;
        for (size_t e = 0; e < luminances.size(); ++e)
            sum += std::numbers::pi * double{coefficients[e]} * luminances[e];
        EXPECT_NEAR(sum, double{blinds.bySky(0, sky).y}, 0.01 * sum); // what cutting the sky costs
    }
    // An even sky: what the window passes of light from everywhere, scattered or straight.
    const daylight::Window& window = blinds.groups()[0].window;
    double straight = 0;
    const int n = 400;
    for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b) {
            const double sine = std::sqrt((a + 0.5) / n), turn = 2 * std::numbers::pi * (b + 0.5) / n;
            straight +=
                window
                    .straight({sine * std::cos(turn), sine * std::sin(turn), -std::sqrt(1 - sine * sine)},
                              {0, 0, 1})
                    .y /
                (n * n);
        }
    EXPECT_NEAR(double{blinds.bySky(0, uniform(1000)).y} / (1000 * std::numbers::pi) + straight,
                window.diffuseTransmittance().y, 1e-3);
}

// Whether a ray meets a box.
bool meets(const test::BoxRoom& box, glm::dvec3 from, glm::dvec3 direction) {
    const glm::dvec3 a = (box.low - from) / direction, b = (box.high - from) / direction;
    const glm::dvec3 in = glm::min(a, b), out = glm::max(a, b);
    return std::max({in.x, in.y, in.z, 0.0}) < std::min({out.x, out.y, out.z});
}

// A wing before the left half of the window, by rays through nine points of each patch.
TEST(Blinds, what_a_wing_hides_of_the_sky_is_not_scattered) {
    constexpr int kAcross = 60, kPoints = 3;
    test::BoxRoom wing;
    wing.low = {-4, 0, -10}, wing.high = {2, 6, -4};
    wing.wall.reflectance = glm::vec3(0);
    for (const Blind& blind : {kFabric, kSlats}) {
        geometry::PatchMesh mesh = windowRoom(blind);
        const size_t n = mesh.patchCount();
        test::addBox(mesh, wing, 1);
        const daylight::Window window(mesh.materials[1]);
        for (const daylight::Sky& sky : {overcast(), uniform(3000)}) {
            const Moment moment = lightOf(mesh, sky), open = lightOf(windowRoom(blind), sky);
            std::vector<std::pair<glm::dvec3, double>> rays; // what each gives of the exitance
            for (int u = 0; u < kAcross; ++u)
                for (int v = 0; v < kAcross; ++v) {
                    const double r = std::sqrt((u + 0.5) / kAcross),
                                 turn = 2 * std::numbers::pi * v / kAcross;
                    const glm::dvec3 towards(r * std::cos(turn), r * std::sin(turn), -std::sqrt(1 - r * r));
                    rays.emplace_back(towards, std::numbers::pi / (kAcross * kAcross) *
                                                   sky.luminance(towards) *
                                                   window.scattered(towards, {0, 0, 1}).y);
                }
            size_t lit = 0;
            for (size_t i = 0; i < n; ++i) {
                if (!mesh.materials[mesh.material[i]].isOpening()) continue;
                const auto corners = mesh.patch(i);
                const glm::dvec3 a = mesh.vertices[corners[0]], b = mesh.vertices[corners[1]] - a,
                                 c = mesh.vertices[corners[2]] - a;
                double glow = 0;
                for (int point = 0; point < kPoints * kPoints; ++point) {
                    const double along = std::sqrt((point / kPoints + 0.5) / kPoints),
                                 part = (point % kPoints + 0.5) / kPoints;
                    const glm::dvec3 from = a + along * ((1 - part) * b + part * c);
                    for (const auto& [towards, lux] : rays)
                        if (!meets(wing, from, towards)) glow += lux / (kPoints * kPoints);
                }
                EXPECT_NEAR(double{moment.glow[i].y}, glow, 0.03 * glow); // elements of 5 degrees
                EXPECT_LT(moment.glow[i].y, 0.9F * open.glow[i].y);
                ++lit;
            }
            EXPECT_EQ(moment.lobes.size(), blind.kind == Blind::Kind::slats ? lit * daylight::kSlatLobes : 0);
            EXPECT_LT(photometric(moment.sensors[0].total()), 0.9 * photometric(open.sensors[0].total()));
        }
    }
}

TEST(Blinds, hours_of_a_year_are_what_the_full_computation_gives) {
    const std::vector<daylight::Sky> skies{overcast(), sunny({0.2, 0.3, -0.8}), sunny({-0.6, 0.2, -0.4}),
                                           sunny({0, 0.01, -1}), sunny({0, 0.5, 1})};
    geometry::PatchMesh shaded = windowRoom(kSlats); // a wing before the left half of the window
    test::BoxRoom wing;
    wing.low = {-4, 0, -10}, wing.high = {2, 3, -6};
    test::addBox(shaded, wing, 1);
    for (const auto& mesh : {windowRoom(kFabric), windowRoom(kSlats), shaded,
                             windowRoom(kSlats, true, {0.8f, 0.5f, 0.2f}, {0.8f, 0.7f, 0.5f})}) {
        DaylightTransport transport(test::device(), mesh);
        AnnualDaylight annual(transport, skies, kSensors.size());
        std::vector<float> lux(kSensors.size() * skies.size()), sun(lux.size()), error(lux.size());
        annual.sensors(kSensors, lux, sun, error);
        const std::vector<Moment> full = transport.light(skies);
        for (size_t s = 0; s < kSensors.size(); ++s)
            for (size_t h = 0; h < skies.size(); ++h) {
                const double there = photometric(full[h].sensors[s].total());
                EXPECT_NEAR(lux[s * skies.size() + h], there, 0.01 * there)
                    << "sensor " << s << ", hour " << h;
            }
    }
}

// A year of windows in part shade is the most that hours hold; in small blocks it gives the same bits.
TEST(Blinds, a_year_in_blocks_of_bounded_memory_is_the_same_year) {
    geometry::PatchMesh mesh = windowRoom(kSlats, true, {0.8f, 0.5f, 0.2f}, {0.8f, 0.7f, 0.5f});
    test::BoxRoom wing;
    wing.low = {-4, 0, -10}, wing.high = {2, 3, -6};
    test::addBox(mesh, wing, 1);
    std::vector<daylight::Sky> skies;
    for (int k = 0; k < 300; ++k)
        skies.push_back(k % 7 == 0 ? overcast() : sunny({0.006 * (k - 150), 0.2 + 0.001 * k, -0.8}));
    DaylightTransport transport(test::device(), mesh);
    const auto year = [&](size_t sunBytes, std::vector<float>& lux) {
        AnnualDaylight annual(transport, skies, kSensors.size(), {}, sunBytes);
        std::vector<float> sun(kSensors.size() * skies.size()), error(sun.size());
        for (int again = 0; again < 2; ++again) { // the second begins with the block that the first left
            lux.assign(sun.size(), -1);
            annual.sensors(kSensors, lux, sun, error);
        }
        return annual.report();
    };
    std::vector<float> whole, inBlocks;
    const YearReport kept = year(AnnualDaylight::kSunBytes, whole);
    ASSERT_EQ(kept.sunBlocks, 1u);
    ASSERT_GT(kept.withSun, 250u);
    const size_t bound = kept.sunBytes / 10;
    const YearReport streamed = year(bound, inBlocks);
    EXPECT_EQ(inBlocks, whole);
    EXPECT_GE(streamed.sunBlocks, 8u);
    EXPECT_LE(streamed.sunBytes, bound + kept.sunBytes / 50); // an hour more
    EXPECT_EQ(kept.bytes - streamed.bytes, kept.sunBytes - streamed.sunBytes);
    EXPECT_EQ(streamed.withSun, kept.withSun);
    EXPECT_EQ(streamed.sunlitPatches, kept.sunlitPatches);
    // Windows in part shade take a number each, and one shape of light together.
    size_t windows = 0, unlike = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) windows += mesh.materials[mesh.material[i]].isOpening();
    SunHours(transport.parts(), mesh, skies, bound).forBlocks([&](const SunHours::Block& block) {
        for (const SunHours::Hour& hour : block.hours) {
            EXPECT_LE(hour.windows.size(), windows);
            EXPECT_EQ(hour.groups.size(), 1u);
            for (const SunHours::Lit& lit : hour.windows)
                unlike += std::abs(lit.lux.y / hour.windows[0].lux.y - 1) > 0.01F;
        }
    });
    EXPECT_GT(unlike, 20u);
}

TEST(Blinds, drawn_and_opened_again_the_light_is_what_it_was) {
    const geometry::PatchMesh open = windowRoom({}), shut = windowRoom(kSlats);
    DaylightTransport transport(test::device(), open);
    transport.setSensors(kSensors);
    const Moment before = transport.light(overcast());
    transport.setMaterials(shut.materials);
    const Moment drawn = transport.light(overcast()), fresh = lightOf(shut, overcast());
    transport.setMaterials(open.materials);
    const Moment after = transport.light(overcast());
    for (size_t s = 0; s < kSensors.size(); ++s) {
        EXPECT_EQ(drawn.sensors[s].total(), fresh.sensors[s].total());
        EXPECT_EQ(after.sensors[s].total(), before.sensors[s].total());
        EXPECT_LT(photometric(drawn.sensors[s].total()), photometric(before.sensors[s].total()));
    }
}

// A quadrilateral with its face to the left of its corners.
void addQuad(geometry::PatchMesh& mesh, const std::array<glm::dvec3, 4>& corners, uint32_t material,
             bool turned) {
    const auto v = static_cast<uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
    std::vector<uint32_t> indices{v, v + 1, v + 2, v + 3};
    if (turned) std::reverse(indices.begin(), indices.end());
    mesh.addPatch(indices, material, geometry::Role::projection, 100, 0);
}

// Slats of 6 cm before the open hole, each a sheet with two faces; before them a pane, where `glass`.
void addSlats(geometry::PatchMesh& mesh, double angleDeg, float reflectance, bool glass = false) {
    const auto slat = static_cast<uint32_t>(mesh.materials.size());
    mesh.materials.push_back({"slat", glm::vec3(reflectance)});
    const double width = 0.0625, angle = angleDeg * std::numbers::pi / 180;
    const glm::dvec3 along(3, 0, 0), across = width * glm::dvec3(0, std::sin(angle), std::cos(angle));
    for (int k = 0; k < 28; ++k)
        for (const double side : {1.0, -1.0}) {
            const glm::dvec3 low = glm::dvec3(0.5, 0.825 + 0.05 * k + 1e-5 * side, -0.034) - 0.5 * across;
            addQuad(mesh, {low, low + across, low + across + along, low + along}, slat, side < 0);
        }
    if (!glass) return;
    geometry::Material pane{"pane"};
    pane.transmittance = glm::vec3(0.88f);
    mesh.materials.push_back(pane);
    addQuad(mesh, {{{0.5, 0.8, -0.075}, {3.5, 0.8, -0.075}, {3.5, 2.2, -0.075}, {0.5, 2.2, -0.075}}},
            slat + 1, false);
}

// Sheets in the sun light the ceiling far more than the floor; behind a pane that mirrors too.
TEST(Blinds, light_of_sheets_traced_one_by_one_lies_in_the_stated_error) {
    const std::vector<Sensor> sensors{{{2, 0.8, 3}, {0, 1, 0}},
                                      {{2, 2.99, 1.5}, {0, -1, 0}},
                                      {{2, 1.5, 2.5}, {0, 0, -1}},
                                      {{2, 2.99, 0.4}, {0, -1, 0}}}; // the last looks at slats edge-on
    for (const auto& [angle, glass] : {std::pair(0.0f, false), {60.0f, false}, {0.0f, true}, {45.0f, true}})
        for (const daylight::Sky& sky : {sunny({0.3, 0.6, -0.8}), overcast()}) {
            DaylightTransport transport(test::device(),
                                        windowRoom({Blind::Kind::slats, 0, 0.7f, angle, 0.8f}, glass));
            transport.setSensors(sensors);
            const Moment moment = transport.light(sky);
            geometry::PatchMesh sheets = windowRoom({}, false);
            addSlats(sheets, double{angle}, 0.7f, glass);
            test::PathTracer tracer(sheets, sky, glass);
            double modelled = 0, traced = 0;
            for (size_t s = 0; s < sensors.size(); ++s) {
                const auto truth = tracer.at(sensors[s], 25);
                const double lux = photometric(moment.sensors[s].total());
                EXPECT_NEAR(lux, truth.lux,
                            static_cast<double>(moment.sensors[s].error) + 3 * truth.standardError)
                    << "sensor " << s << ", angle " << angle;
                EXPECT_LT(static_cast<double>(moment.sensors[s].error), 0.09 * lux); // says something
                modelled += lux, traced += truth.lux;
            }
            EXPECT_NEAR(modelled, traced, 0.1 * traced); // about two of its standard errors
            // Upper faces in the sun light the ceiling.
            if (sky.hasSun() && angle == 0) {
                const double floor = photometric(moment.sensors[0].total()),
                             ceiling = photometric(moment.sensors[1].total());
                EXPECT_GT(ceiling, 2 * floor);
            }
        }
}

// Right above and below steep slats all light arrives at elevations between a few nodes, where it bends.
TEST(Blinds, beside_steep_slats_the_stated_error_holds) {
    constexpr double kLuminance = 1000;
    const auto wall = [](double y, double up) {
        std::vector<Sensor> sensors;
        for (const double z : {0.02, 0.03, 0.05, 0.08, 0.12, 0.2, 0.3, 0.5, 1.0, 2.0})
            sensors.push_back({{2, y, z}, {0, up, 0}});
        return sensors;
    };
    std::vector<Sensor> sensors = wall(2.999, -1);
    std::ranges::copy(wall(0.001, 1), std::back_inserter(sensors));
    for (const float angle : {82.0f, -75.0f, 45.0f}) {
        const Blind blind{Blind::Kind::slats, 0, 0.5f, angle, 0.9f};
        DaylightTransport transport(test::device(), windowRoom(blind, false, glm::vec3(0)),
                                    {.errorByPlace = true});
        transport.setSensors(sensors);
        const Moment moment = transport.light(uniform(kLuminance));
        const daylight::Slats slats(double{angle}, 0.9, 0.5);
        for (size_t s = 0; s < sensors.size(); ++s) {
            // What leaves a blind one way, under an even sky, is what comes in the other way and passes: the
            // channel is its own mirror image.
            double lux = 0;
            constexpr int kAcross = 40, kUp = 400;
            for (int i = 0; i < kAcross; ++i)
                for (int k = 0; k < kUp; ++k) {
                    const glm::dvec3 at(1 + 2 * (i + 0.5) / kAcross, 1 + (k + 0.5) / kUp, 0),
                        way = sensors[s].position - at;
                    const double profile = -std::atan2(way.y, way.z), square = glm::dot(way, way);
                    lux += kLuminance * (slats.straight(profile) + slats.scattered(profile)) *
                           -glm::dot(way, sensors[s].normal) * way.z / (square * square) * 2 /
                           (kAcross * kUp);
                }
            const LightParts& parts = moment.sensors[s];
            EXPECT_NEAR(photometric(parts.total()), lux, double{parts.error})
                << angle << " degrees, sensor " << s;
            if (sensors[s].position.z >= 1) { // and says something
                EXPECT_LT(double{parts.error}, 0.12 * lux) << angle << " degrees, sensor " << s;
            }
        }
    }
}

// What windows give, each node of theirs, arrives somewhere in a closed room.
TEST(Blinds, lobes_keep_the_light_of_windows) {
    const geometry::PatchMesh mesh = windowRoom(kSlats);
    DaylightTransport transport(test::device(), mesh);
    const SlatLobes& slats = transport.parts().slats;
    ASSERT_FALSE(slats.empty());
    std::vector<double> arriving(slats.rows(), 0);
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        for (const SlatLobes::Share& share : slats.of(i))
            arriving[share.row] += geometry::patchArea(mesh, i) * double{share.factor};
    for (size_t w = 0; w < slats.windows().size(); ++w) {
        const double area = geometry::patchArea(mesh, slats.windows()[w].patch);
        for (size_t lobe = 0; lobe < daylight::kSlatLobes; ++lobe) {
            const double whole = daylight::lobeShare(lobe) * area;
            EXPECT_NEAR(arriving[w * daylight::kSlatLobes + lobe], whole, 1e-3 * whole) << lobe;
        }
    }
}

// The middles of the four triangles that a triangle falls into.
std::vector<Sensor> placesOn(const geometry::PatchMesh& mesh, size_t patch) {
    const auto corners = mesh.patch(patch);
    const glm::dvec3 normal = geometry::patchNormal(mesh, patch),
                     middle = geometry::patchCentroid(mesh, patch);
    std::vector<Sensor> places{{middle, normal}};
    for (uint32_t v : corners) places.push_back({0.5 * (middle + mesh.vertices[v]), normal});
    return places;
}

TEST(Blinds, light_of_sheets_on_patches_lies_in_the_stated_error) {
    for (const float angle : {0.0f, 45.0f}) {
        const daylight::Sky sky = sunny({0.3, 0.6, -0.8});
        const geometry::PatchMesh room = windowRoom({Blind::Kind::slats, 0, 0.7f, angle, 0.8f}, false);
        DaylightTransport transport(test::device(), room);
        const Moment moment = transport.light(sky);
        geometry::PatchMesh sheets = windowRoom({}, false);
        addSlats(sheets, double{angle}, 0.7f);
        test::PathTracer tracer(sheets, sky);
        double stated = 0, traced = 0;
        for (size_t i = 3; i < room.patchCount(); i += 14) {
            if (room.materials[room.material[i]].isOpening()) continue;
            double lux = 0, squares = 0;
            const std::vector<Sensor> places = placesOn(room, i);
            for (const Sensor& place : places) {
                const auto truth = tracer.at(place, 12);
                lux += truth.lux / 4, squares += truth.standardError * truth.standardError / 16;
            }
            const LightParts& parts = moment.patches[i];
            EXPECT_NEAR(photometric(parts.total()), lux,
                        static_cast<double>(parts.error) + 3 * std::sqrt(squares))
                << "patch " << i << ", angle " << angle;
            stated += static_cast<double>(parts.error), traced += lux;
        }
        EXPECT_LT(stated, 0.1 * traced); // says something
    }
}

} // namespace
} // namespace heliodon::compute
