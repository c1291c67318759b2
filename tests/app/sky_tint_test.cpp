#include "engine/app/sky_tint.h"

#include <gtest/gtest.h>

#include "tests/compute/rooms.h"
#include "tests/gpu/test_device.h"

namespace heliodon::app {
namespace {

TEST(SkyTint, grey_rooms_keep_their_lux_and_sunlight_is_warmer_than_skylight) {
    test::BoxRoom box;
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9 && p.x > 1 && p.x < 3 && p.y > 1 && p.y < 2; };
    geometry::PatchMesh mesh = test::boxRoom(box);
    compute::DaylightTransport transport(test::device(), mesh);
    const glm::dvec3 towards = glm::normalize(glm::dvec3(0.2, 0.3, -0.8));
    daylight::Sky sky = daylight::cieClearSky(towards, 3000);
    sky.sun = {towards, 60000};
    daylight::lightGround(sky, 0.2);
    const compute::Moment plain = transport.light(sky);
    compute::Moment tinted = plain;
    tintLight(transport, std::span(&sky, 1), std::span(&tinted, 1));
    float warmest = 0, coolest = 1e9f;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const glm::vec3 a = plain.lighting.exitance[i], b = tinted.lighting.exitance[i];
        // Four solutions, each within the solver's 1e-4 of its largest exitance.
        EXPECT_NEAR(compute::photometric(b), compute::photometric(a), 2e-3 * compute::photometric(a) + 2);
        if (b.z > 0) warmest = std::max(warmest, b.x / b.z), coolest = std::min(coolest, b.x / b.z);
    }
    EXPECT_GT(warmest, 1.05f); // where the sun falls
    EXPECT_LT(coolest, warmest);
    const glm::vec3 sun = tinted.lighting.sunNormalIlluminance;
    EXPECT_GT(sun.x, sun.z);
    EXPECT_NEAR(compute::photometric(sun), 60000, 1);
    EXPECT_EQ(tinted.patches[3].total(), plain.patches[3].total());
}

} // namespace
} // namespace heliodon::app
