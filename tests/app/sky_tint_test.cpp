#include "engine/app/sky_tint.h"

#include <gtest/gtest.h>

#include "compute/daylight/sky_colour.h"
#include "tests/compute/rooms.h"
#include "tests/gpu/test_device.h"

namespace heliodon::app {
namespace {

geometry::PatchMesh windowedBox() {
    test::BoxRoom box;
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    return test::boxRoom(box);
}

daylight::Sky clearSky() {
    const glm::dvec3 towards = glm::normalize(glm::dvec3(0.2, 0.3, -0.8));
    daylight::Sky sky = daylight::cieClearSky(towards, 3000);
    sky.sun = {towards, 60000};
    daylight::lightGround(sky, 0.2);
    return sky;
}

TEST(SkyTint, grey_rooms_keep_their_lux_and_sunlight_is_warmer_than_skylight) {
    geometry::PatchMesh mesh = windowedBox();
    compute::DaylightTransport transport(test::device(), mesh);
    const daylight::Sky sky = clearSky();
    const compute::Moment plain = transport.light(sky);
    compute::Moment tinted = plain;
    tintLight(transport, std::span(&sky, 1), std::span(&tinted, 1));
    float warmest = 0, coolest = 1e9f;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const glm::vec3 a = plain.lighting.exitance[i], b = tinted.lighting.exitance[i];
        // Colours have Y = 1 to 1e-5; what the solver leaves is in both alike.
        EXPECT_NEAR(compute::photometric(b), compute::photometric(a), 1e-4 * compute::photometric(a)) << i;
        if (b.z > 0) warmest = std::max(warmest, b.x / b.z), coolest = std::min(coolest, b.x / b.z);
    }
    EXPECT_GT(warmest, 1.05f); // where the sun falls
    EXPECT_LT(coolest, warmest);
    const glm::vec3 sun = tinted.lighting.sunNormalIlluminance;
    EXPECT_GT(sun.x, sun.z);
    EXPECT_NEAR(compute::photometric(sun), 60000, 1);
    EXPECT_EQ(tinted.patches[3].total(), plain.patches[3].total());
}

// Each source apart, in its colour, adds up to the tinted whole, whatever shines, in coloured rooms that emit
// light, too.
TEST(SkyTint, is_the_sum_of_what_sun_sky_and_ground_give_in_their_colours) {
    geometry::PatchMesh mesh = windowedBox();
    for (geometry::Material& material : mesh.materials)
        if (!material.isOpening()) material.reflectance *= glm::vec3(0.9f, 0.7f, 0.5f);
    mesh.materials[0].exitance = glm::vec3(300, 200, 100);
    compute::TransportOptions fine;
    fine.radiosity.tolerance = 1e-6;
    compute::DaylightTransport transport(test::device(), mesh, fine);
    const auto only = [](daylight::Sky sky, int what) {
        if (!(what & 1)) sky.sun.normalIlluminance = 0;
        if (!(what & 2)) sky.formula.scale = 0;
        if (!(what & 4)) sky.ground.luminance = 0;
        return sky;
    };
    const daylight::SkyPatches patches(2);
    for (const int what : {0, 1, 2, 3, 4, 5, 6, 7}) {
        const daylight::Sky sky = only(clearSky(), what);
        const std::vector<double> plain = patches.luminances(sky);
        const std::vector<glm::dvec3> coloured = daylight::colouredLuminances(sky, patches, plain);
        glm::dvec3 onPlane(0);
        double lux = 0;
        for (size_t i = 0; i < patches.patchCount(); ++i) {
            onPlane += patches.projectedSolidAngle(i) * coloured[i];
            lux += patches.projectedSolidAngle(i) * plain[i];
        }
        const std::pair<int, glm::vec3> sources[]{
            {1, glm::vec3(daylight::SkyColour(sky).ofSun())},
            {2, glm::vec3(onPlane / std::max(lux, 1e-9))},
            {4, glm::vec3(coloured.back() / std::max(plain.back(), 1e-9))}};
        const std::vector<glm::vec3> own = transport.light(only(sky, 0)).lighting.exitance;
        std::vector<glm::vec3> sum = own;
        for (const auto& [source, colour] : sources) {
            if (!(what & source)) continue;
            const std::vector<glm::vec3> light = transport.light(only(sky, source)).lighting.exitance;
            for (size_t i = 0; i < sum.size(); ++i) sum[i] += colour * (light[i] - own[i]);
        }
        compute::Moment moment = transport.light(sky);
        tintLight(transport, std::span(&sky, 1), std::span(&moment, 1));
        const std::vector<glm::vec3>& whole = moment.lighting.exitance;
        float brightest = 0;
        for (const glm::vec3& light : whole) brightest = std::max({brightest, light.x, light.y, light.z});
        // Up to four solutions, each within 1e-6, times colours up to 2.
        for (size_t i = 0; i < sum.size(); ++i)
            EXPECT_LT(glm::length(whole[i] - sum[i]), 1e-5f * brightest) << what << ", patch " << i;
    }
}

} // namespace
} // namespace heliodon::app
