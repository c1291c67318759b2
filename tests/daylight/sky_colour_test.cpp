#include "compute/daylight/sky_colour.h"

#include <cmath>

#include <gtest/gtest.h>

#include "compute/daylight/frame.h"

namespace heliodon::daylight {
namespace {

double photometric(glm::dvec3 rgb) {
    return 0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z;
}

// Correlated colour temperature after McCamy 1992, good to some 100 K between 2800 and 10000 K.
double kelvinOf(glm::dvec3 rgb) {
    const double x = 0.4124 * rgb.x + 0.3576 * rgb.y + 0.1805 * rgb.z, y = photometric(rgb),
                 z = 0.0193 * rgb.x + 0.1192 * rgb.y + 0.9505 * rgb.z, all = x + y + z;
    const double n = (x / all - 0.3320) / (0.1858 - y / all);
    return ((449 * n + 3525) * n + 6823.3) * n + 5520.33;
}

TEST(SkyColour, daylight_of_6504_kelvin_is_white) {
    const glm::dvec3 d65 = daylightColour(6504);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(d65[i], 1, 2e-3); // the locus passes D65 within 1e-4 of x and y
    EXPECT_NEAR(kelvinOf(daylightColour(5000)), 5000, 60);
    EXPECT_NEAR(kelvinOf(daylightColour(9000)), 9000, 150);
}

TEST(SkyColour, photometric_part_is_one_and_no_channel_is_negative) {
    for (double k = 1000; k < 40000; k *= 1.1) EXPECT_NEAR(photometric(daylightColour(k)), 1, 1e-12);
    for (double h = -5; h <= 90; h += 0.5) {
        const glm::dvec3 sun = sunColour(h);
        EXPECT_NEAR(photometric(sun), 1, 1e-12);
        EXPECT_GE(std::min({sun.x, sun.y, sun.z}), -1e-12) << h;
    }
    for (double x = 0.05; x < 0.7; x += 0.05)
        for (double y = 0.05; x + y < 0.95; y += 0.05) {
            const glm::dvec3 rgb = rgbOfChromaticity(x, y);
            EXPECT_NEAR(photometric(rgb), 1, 1e-9);
            EXPECT_GE(std::min({rgb.x, rgb.y, rgb.z}), -1e-9);
        }
}

TEST(SkyColour, the_sun_warms_as_it_sinks) {
    double last = 1e9;
    for (double h = 90; h >= 0; h -= 1) {
        const glm::dvec3 sun = sunColour(h);
        EXPECT_LT(sun.z / sun.x, last) << h;
        last = sun.z / sun.x + 1e-9;
    }
    // The direct spectrum of ASTM G173 (air mass 1.5, a sun at 41.8 degrees) has about 5000 K; photographers'
    // tables give 3000 to 4300 K some ten degrees up and under 2500 K at sunset.
    EXPECT_NEAR(kelvinOf(sunColour(41.8)), 5000, 300);
    EXPECT_NEAR(kelvinOf(sunColour(10)), 3650, 650);
    EXPECT_LT(kelvinOf(sunColour(1)), 2500);
}

TEST(SkyColour, clear_skies_are_blue_and_overcast_ones_white) {
    SunPosition sun;
    sun.azimuthDeg = 200;
    sun.altitudeDeg = 45;
    const SkyColour clear(clearSky(sun)), overcast(overcastSky(sun)), hazy(intermediateSky(sun));
    const glm::dvec3 blue = daylightColour(6500 + 1.1985e8 / std::pow(2000, 1.2)),
                     white = daylightColour(6500);
    EXPECT_LT(glm::length(clear.ofLuminance(2000) - blue), 1e-12);
    EXPECT_LT(glm::length(overcast.ofLuminance(2000) - white), 1e-12);
    EXPECT_GT(hazy.ofLuminance(2000).z, white.z);
    EXPECT_LT(hazy.ofLuminance(2000).z, blue.z);
    EXPECT_GT(clear.ofLuminance(2000).z, 1.5);
    EXPECT_GT(clear.ofLuminance(2000).z, clear.ofLuminance(20000).z);
    EXPECT_NEAR(overcast.ofLuminance(5000).z, 1, 0.01);
    EXPECT_LT(clear.ofSun().z, 0.9);
}

TEST(SkyColour, colouring_leaves_every_elements_luminance_as_it_was) {
    SunPosition sun;
    sun.azimuthDeg = 120;
    sun.altitudeDeg = 12;
    const SkyPatches patches(2);
    for (const Sky& sky : {clearSky(sun), overcastSky(sun), cieTypicalSky(13, sun), Sky{}}) {
        const auto grey = patches.luminances(sky);
        const auto coloured = colouredLuminances(sky, patches, grey);
        ASSERT_EQ(coloured.size(), grey.size());
        for (size_t i = 0; i < grey.size(); ++i)
            ASSERT_NEAR(photometric(coloured[i]), grey[i], 1e-9 * (1 + grey[i]));
    }
}

} // namespace
} // namespace heliodon::daylight
