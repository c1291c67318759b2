// Only what a scene needs is modelled: each rule beside the full computation, and the light at its edges.
#include <cmath>

#include <gtest/gtest.h>

#include "compute/annual_daylight.h"
#include "compute/daylight/glazing.h"
#include "compute/daylight/window.h"
#include "compute/daylight_transport.h"
#include "compute/reference/form_factor_rows.h"
#include "compute/reference/sun.h"
#include "tests/compute/rooms.h"
#include "tests/compute/skies.h"
#include "tests/gpu/test_device.h"

namespace heliodon::compute {
namespace {

using test::overcast;
using test::sunny;

geometry::PatchMesh windowRoom() {
    test::BoxRoom box;
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    return test::boxRoom(box);
}

const std::vector<Sensor> kSensors{{{2, 1, 2}, {0, 1, 0}}, {{1, 2, 3}, {0, 0, -1}}, {{3, 0.1, 4}, {0, 1, 0}}};

bool skips(const std::vector<std::string>& skipped, const std::string& what) {
    return std::any_of(skipped.begin(), skipped.end(),
                       [&](const std::string& s) { return s.find(what) != std::string::npos; });
}

struct Both {
    DaylightTransport brief, full;
    explicit Both(const geometry::PatchMesh& mesh)
        : brief(test::device(), mesh), full(test::device(), mesh, {.skipNothing = true}) {
        brief.setSensors(kSensors), full.setSensors(kSensors);
    }
};

// Every figure of the moment, to within the tolerance of two solutions (each 1e-4 of the brightest patch).
void expectSame(const Moment& brief, const Moment& full) {
    double most = 0;
    for (const LightParts& p : full.patches) most = std::max(most, photometric(p.total()));
    ASSERT_EQ(brief.patches.size(), full.patches.size());
    const auto same = [&](const LightParts& a, const LightParts& b) {
        for (int c = 0; c < 3; ++c) {
            EXPECT_FLOAT_EQ(a.sun[c], b.sun[c]);
            EXPECT_FLOAT_EQ(a.sky[c], b.sky[c]);
            EXPECT_FLOAT_EQ(a.ground[c], b.ground[c]);
            EXPECT_NEAR(a.interreflected[c], b.interreflected[c], 2e-4 * most);
        }
    };
    for (size_t i = 0; i < brief.patches.size(); ++i) same(brief.patches[i], full.patches[i]);
    for (size_t s = 0; s < brief.sensors.size(); ++s) same(brief.sensors[s], full.sensors[s]);
}

void expectRule(const geometry::PatchMesh& mesh, const daylight::Sky& sky, const std::string& reason) {
    Both both(mesh);
    const Moment brief = both.brief.light(sky), full = both.full.light(sky);
    EXPECT_TRUE(skips(brief.report.skipped, reason)) << reason;
    EXPECT_FALSE(skips(full.report.skipped, reason)) << reason;
    expectSame(brief, full);
}

TEST(Skips, a_sun_below_the_horizon) {
    expectRule(windowRoom(), sunny({0.2, 0.5, -0.8}, 0), "sun: below the horizon");
}

TEST(Skips, an_overcast_sky_has_no_sun_to_clip) {
    expectRule(windowRoom(), overcast(), "sun: below the horizon or behind cloud");
}

TEST(Skips, a_dark_sky) {
    expectRule(windowRoom(), daylight::Sky{}, "sky and ground: dark");
    expectRule(windowRoom(), daylight::Sky{}, "interreflection: no light");
}

TEST(Skips, a_sun_that_shines_on_no_opening) {
    expectRule(windowRoom(), sunny({0, 0.5, 1}), "sun: shines on no opening");
    // Clipped all the same, by SunPatches and by rays.
    const geometry::PatchMesh mesh = windowRoom();
    const glm::dvec3 behind = glm::normalize(glm::dvec3(0, 0.5, 1));
    const SunScene scene(mesh);
    for (const glm::vec3& lit : SunPatches(scene, behind, true).onPatches()) EXPECT_EQ(lit, glm::vec3(0));
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        EXPECT_EQ(reference::sunOnPatch(mesh, i, behind, 16), glm::dvec3(0));
}

TEST(Skips, a_room_without_openings) {
    test::BoxRoom box;
    box.wall.exitance = glm::vec3(100);
    expectRule(test::boxRoom(box), sunny({0.2, 0.5, -0.8}), "sky and ground: no opening");
    expectRule(test::boxRoom(box), sunny({0.2, 0.5, -0.8}), "sun: no opening");
    EXPECT_TRUE(skips(Both(test::boxRoom(box)).brief.report().skipped, "sky coefficients: no opening"));
}

TEST(Skips, colour_where_all_is_grey) {
    expectRule(windowRoom(), sunny({0.2, 0.5, -0.8}), "colour: all materials are grey");
}

// Both kernels that have the rule.
TEST(Skips, occlusion_in_a_convex_room) {
    const geometry::PatchMesh mesh = windowRoom();
    const size_t n = mesh.patchCount();
    // The oracle asks every blocker.
    const reference::FormFactorRows oracle(mesh);
    const std::pair<FormFactorOptions, double> kernels[]{
        {{.kernel = "exact", .maxError = 1e-4}, 1e-5}, {{.kernel = "hierarchical", .maxError = 2e-3}, 2e-3}};
    for (const auto& [options, most] : kernels) {
        const FormFactors F = computeFormFactors(test::device(), mesh, options);
        EXPECT_TRUE(skips(F.report.skipped, "occlusion")) << options.kernel;
        const auto values = F.values.download<float>(n * n);
        for (const size_t i : {size_t{0}, size_t{17}, n - 1}) {
            const auto row = oracle.row(i);
            for (size_t j = 0; j < n; ++j)
                EXPECT_NEAR(values[i * n + j], row.factors[j], most)
                    << options.kernel << ": " << i << " to " << j;
        }
    }
    // A column in the room is in the way, and the rule does not hold.
    test::BoxRoom column;
    column.low = {2.2, 0.5, 2.2}, column.high = {2.4, 2, 2.4}, column.cells = {1, 1, 1};
    geometry::PatchMesh hall = mesh, pillar = test::boxRoom(column);
    for (size_t i = 0; i < pillar.patchCount(); ++i) { // its outside
        std::vector<uint32_t> corners;
        for (uint32_t c : pillar.patch(i)) {
            corners.insert(corners.begin(), static_cast<uint32_t>(hall.vertices.size()));
            hall.vertices.push_back(pillar.vertices[c]);
        }
        hall.addPatch(corners, 0, geometry::Role::projection, 99, 0);
    }
    for (const auto& [options, most] : kernels)
        EXPECT_FALSE(skips(computeFormFactors(test::device(), hall, options).report.skipped, "occlusion"));
}

// Nothing is asked of the sky before blinds where nothing stands there; a slab far aside, which hides none of
// it, is asked of and changes nothing.
TEST(Skips, hidden_sky_where_nothing_stands_before_blinds) {
    test::BoxRoom box;
    box.glass = daylight::withBlind(box.glass, {geometry::Blind::Kind::fabric, 0.3f, 0.5f});
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    const geometry::PatchMesh mesh = test::boxRoom(box);
    geometry::PatchMesh aside = mesh;
    test::BoxRoom slab;
    slab.low = {-2, -1, -1e-3}, slab.high = {-1, -0.9, 1}, slab.cells = {1, 1, 1};
    test::addBox(aside, slab, 1);
    DaylightTransport alone(test::device(), mesh), both(test::device(), aside);
    EXPECT_TRUE(alone.parts().hiddenSky.patches().empty());
    const Moment a = alone.light(overcast()), b = both.light(overcast());
    ASSERT_FALSE(a.glow.empty());
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        EXPECT_NEAR(a.glow[i].y, b.glow[i].y, 1e-3 * double{a.glow[i].y});
}

// The year leaves out the sun of hours behind cloud and of hours that it cannot enter in, and dark hours.
TEST(Skips, hours_of_a_year) {
    Both both(windowRoom());
    const std::vector<daylight::Sky> skies{daylight::Sky{}, overcast(), sunny({0, 0.5, 1}),
                                           sunny({0.2, 0.5, -0.8}), overcast()};
    AnnualDaylight annual(both.brief, skies, kSensors.size());
    std::vector<float> lux(kSensors.size() * skies.size()), sun(lux.size()), error(lux.size());
    annual.sensors(kSensors, lux, sun, error);
    EXPECT_EQ(annual.report().lit, 4u);
    EXPECT_EQ(annual.report().sunless, 2u);
    EXPECT_EQ(annual.report().sunOutside, 1u);
    const std::vector<Moment> full = both.full.light(skies);
    for (size_t s = 0; s < kSensors.size(); ++s)
        for (size_t h = 0; h < skies.size(); ++h)
            EXPECT_LE(std::abs(double{lux[s * skies.size() + h]} - photometric(full[h].sensors[s].total())),
                      double{error[s * skies.size() + h]})
                << "sensor " << s << ", hour " << h;
}

// ---- Edges of the rules ----

double flux(const geometry::PatchMesh& mesh, const std::vector<glm::vec3>& light) {
    double sum = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) sum += geometry::patchArea(mesh, i) * light[i].y;
    return sum;
}

TEST(Edges, the_sun_on_the_horizon_shines_straight_in) {
    const geometry::PatchMesh mesh = windowRoom();
    const double pane = daylight::glazingOf(mesh.materials[1]).transmittance(1).y;
    const SunPatches level(mesh, {0, 0, -1});
    ASSERT_TRUE(level.canEnter());
    EXPECT_NEAR(flux(mesh, level.onPatches()), 2 * pane, 1e-5); // 2 m2 of window, on the wall opposite
    EXPECT_NEAR(level.beamAtPoint({2, 1.5, 4.9}, {0, 0, -1}).share.y, pane, 1e-6);
    EXPECT_EQ(level.beamAtPoint({2, 0, 2}, {0, 1, 0}).share.y, 0); // along the floor
    // At sunrise, a hair higher, the same light falls.
    const SunPatches rising(mesh, glm::normalize(glm::dvec3(0, 1e-6, -1)));
    EXPECT_NEAR(flux(mesh, rising.onPatches()), 2 * pane, 1e-5);
    DaylightTransport transport(test::device(), mesh);
    const double at = photometric(transport.light(sunny({0, 0, -1})).patches[30].total()),
                 above = photometric(transport.light(sunny({0, 1e-6, -1})).patches[30].total());
    EXPECT_GT(at, 0);
    EXPECT_NEAR(at, above, 1e-3 * at);
}

TEST(Edges, a_sun_along_the_windows_plane_gives_nothing_and_near_it_next_to_nothing) {
    const geometry::PatchMesh mesh = windowRoom();
    EXPECT_FALSE(SunPatches(mesh, glm::normalize(glm::dvec3(0.3, 0.9, 0))).canEnter());
    double last = 1;
    for (const double tilt : {1e-1, 1e-3, 1e-6}) {
        const glm::dvec3 sun = glm::normalize(glm::dvec3(0.3, 0.9, -tilt));
        const double entered = flux(mesh, SunPatches(mesh, sun).onPatches());
        EXPECT_NEAR(entered, 2 * -sun.z * daylight::glazingOf(mesh.materials[1]).transmittance(-sun.z).y,
                    1e-5 * -sun.z);
        EXPECT_LT(entered, last);
        last = entered;
    }
}

TEST(Edges, a_room_lit_only_through_another_gets_its_share) {
    const geometry::PatchMesh mesh = test::twoRooms(true);
    Both both(mesh);
    for (const daylight::Sky& sky : {overcast(), sunny({0, 0.3, -1}), sunny({0.2, 0.5, 1})}) {
        const Moment brief = both.brief.light(sky), full = both.full.light(sky);
        expectSame(brief, full);
        EXPECT_LT(brief.report.energyImbalance, 2e-3);
        double behind = 0;
        for (size_t i = 0; i < mesh.patchCount(); ++i)
            if (mesh.room[i] == 1)
                behind += geometry::patchArea(mesh, i) * photometric(brief.patches[i].total());
        EXPECT_GT(behind, 0.05 * brief.report.lumensIn);
    }
}

TEST(Edges, rooms_joined_by_glass_alone_are_dark) {
    Both both(test::twoRooms(false));
    const Moment brief = both.brief.light(sunny({0, 0.3, -1}));
    EXPECT_TRUE(skips(brief.report.skipped, "no opening leads outside"));
    expectSame(brief, both.full.light(sunny({0, 0.3, -1})));
    for (const LightParts& p : brief.patches) EXPECT_EQ(photometric(p.total()), 0);
}

} // namespace
} // namespace heliodon::compute
