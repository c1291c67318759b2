#include "compute/daylight/sky_patches.h"

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "compute/daylight/frame.h"
#include "compute/daylight/quadrature.h"
#include "tests/daylight/csv.h"

namespace heliodon::daylight {
namespace {

glm::dvec3 randomDirection(std::minstd_rand& random) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double y = unit(random), azimuth = 2 * kPi * unit(random);
    return {std::sqrt(1 - y * y) * std::cos(azimuth), y, std::sqrt(1 - y * y) * std::sin(azimuth)};
}

TEST(SkyPatches, solid_angles_fill_the_hemisphere) {
    for (const int mf : {1, 2, 3, 4, 8}) {
        const SkyPatches patches(mf);
        EXPECT_EQ(patches.patchCount(), static_cast<size_t>(144 * mf * mf + 1));
        double solid = 0, projected = 0;
        for (size_t i = 0; i < patches.patchCount(); ++i) {
            solid += patches.solidAngle(i);
            projected += patches.projectedSolidAngle(i);
        }
        EXPECT_NEAR(solid, 2 * kPi, 1e-11); // sum of up to 10^4 terms
        EXPECT_NEAR(projected, kPi, 1e-11);
    }
}

TEST(SkyPatches, agree_with_radiances_tables) {
    for (const int mf : {1, 2, 4}) {
        const test::Csv table("reinhart_mf" + std::to_string(mf) + "_patches.csv.gz");
        const SkyPatches patches(mf);
        ASSERT_EQ(table.rows.size(), patches.patchCount());
        for (size_t i = 0; i < table.rows.size(); ++i) {
            const glm::dvec3 centre = directionInWorld(
                {table.number(i, "az_centre_deg_N0_cw"), table.number(i, "alt_centre_deg")}, 90);
            EXPECT_LT(glm::length(patches.centre(i) - centre), 3e-8); // six decimals of a degree
            EXPECT_NEAR(patches.solidAngle(i), table.number(i, "solid_angle_sr"), 6e-10);
            EXPECT_NEAR(patches.projectedSolidAngle(i), table.number(i, "projected_solid_angle_sr"), 6e-10);
        }
    }
}

TEST(SkyPatches, a_direction_lies_in_its_patch) {
    std::minstd_rand random(3);
    for (const int mf : {1, 2, 4, 5}) {
        const SkyPatches patches(mf);
        std::vector<int> hits(patches.patchCount());
        for (size_t i = 0; i < patches.patchCount(); ++i) ASSERT_EQ(patches.elementOf(patches.centre(i)), i);
        const int n = 200'000;
        for (int k = 0; k < n; ++k) {
            const glm::dvec3 d = randomDirection(random);
            const size_t i = patches.elementOf(d);
            ASSERT_LT(i, patches.patchCount());
            ++hits[i];
            // Within the patch's half height of its centre's altitude.
            ASSERT_LE(std::abs(std::asin(d.y) - std::asin(std::min(1.0, patches.centre(i).y))),
                      0.5 * kPi / (7 * mf + 0.5) * 0.5 + 1e-9);
        }
        for (size_t i = 0; i < patches.patchCount(); ++i) {
            const double expected = n * patches.solidAngle(i) / (2 * kPi);
            EXPECT_NEAR(hits[i], expected, 6 * std::sqrt(expected) + 1); // six standard deviations
        }
        EXPECT_EQ(patches.elementOf({0.6, 0, 0.8}), patches.groundElement());
        EXPECT_EQ(patches.elementOf({0, -1, 0}), patches.groundElement());
        EXPECT_EQ(patches.elementOf({0, 1, 0}), patches.patchCount() - 1);
        // Just left and right of world -z, where the azimuth wraps.
        EXPECT_EQ(patches.elementOf(glm::normalize(glm::dvec3(-1e-9, 0.01, -1))), 0u);
        EXPECT_EQ(patches.elementOf(glm::normalize(glm::dvec3(1e-9, 0.01, -1))), 0u);
    }
}

TEST(SkyPatches, the_shader_formula_in_the_header_finds_the_same_patch) {
    std::minstd_rand random(4);
    const SkyPatches patches(2);
    const auto rows = patches.rows();
    const float alpha = static_cast<float>(kPi / 2 / 14.5);
    int differ = 0;
    for (int k = 0; k < 100'000; ++k) {
        const glm::dvec3 d = randomDirection(random);
        const auto x = static_cast<float>(d.x), y = static_cast<float>(d.y), z = static_cast<float>(d.z);
        const auto row = std::min(static_cast<uint32_t>(std::asin(y) / alpha), 14u);
        const uint32_t n = rows[row].patchCount;
        const float turns = std::atan2(x, -z) / static_cast<float>(2 * kPi);
        const auto column =
            static_cast<uint32_t>(turns * static_cast<float>(n) + static_cast<float>(n) + 0.5f) % n;
        if (rows[row].firstPatch + column != patches.elementOf(d)) ++differ;
    }
    EXPECT_LE(differ, 5); // only within a float's rounding of an edge
}

TEST(SkyPatches, mean_luminance_is_that_of_a_hundred_times_finer_sampling) {
    const glm::dvec3 low = directionInWorld({200, 7}, 90), high = directionInWorld({120, 61}, 90),
                     top{0, 1, 0};
    const SkyPatches patches(2);
    for (const auto& sun : {low, high, top})
        for (const Sky& sky :
             {cieGeneralSky(12, sun, 1000), cieGeneralSky(15, sun, 1000), cieIntermediateSky(sun, 1000),
              perezSky({-1.05, -0.3, 31, -7.2, 1.5}, sun, 1000), cieGeneralSky(1, sun, 1000)}) {
            const auto mean = patches.luminances(sky);
            for (size_t i = 0; i < patches.patchCount(); i += 7) {
                const auto& row = *std::find_if(patches.rows().rbegin(), patches.rows().rend(),
                                                [&](const SkyRow& r) { return r.firstPatch <= i; });
                double sum = 0;
                const int n = 64;
                for (int u = 0; u < n; ++u)
                    for (int v = 0; v < n; ++v) {
                        const double y = row.lowSine + (row.highSine - row.lowSine) * (u + 0.5) / n;
                        const double turn =
                            (static_cast<double>(i - row.firstPatch) - 0.5 + (v + 0.5) / n) / row.patchCount;
                        const double level = std::sqrt(1 - y * y);
                        sum += sky.luminance(
                            {level * std::sin(2 * kPi * turn), y, -level * std::cos(2 * kPi * turn)});
                    }
                // 5e-4 stated; the midpoint rule at the tip of a cone adds 1e-4.
                EXPECT_NEAR(mean[i] / (sum / (n * n)), 1, 6e-4) << sky.model << " patch " << i;
            }
        }
}

// Of a sky that is the same all round.
TEST(SkyPatches, ribbon_at_the_horizon_is_in_the_lowest_patches) {
    for (const int mf : {1, 2, 4}) {
        const SkyPatches patches(mf);
        for (const double b : {0.1, 0.2, 0.26, 0.33}) {
            const Sky sky = perezSky({0.25, b, 0, -1, 0}, {0, 1, 0}, 1);
            const SkyRow row = patches.rows()[0];
            double sum = 0;
            const int n = 100'000;
            for (int k = 0; k < n; ++k)
                sum += gradation(sky.formula, row.lowSine + (row.highSine - row.lowSine) * (k + 0.5) / n);
            const double mean = sum / n; // off by half a step at the ribbon's edge
            EXPECT_NEAR(patches.luminances(sky)[3] / mean, 1, 6e-4) << mf << " " << b;
        }
    }
}

// Lux, of the sky that was cut up.
double horizontalIlluminance(const SkyPatches& patches, const Sky& sky) {
    const std::vector<double> luminances = patches.luminances(sky);
    double sum = 0;
    for (size_t i = 0; i < patches.patchCount(); ++i) sum += luminances[i] * patches.projectedSolidAngle(i);
    return sum;
}

TEST(SkyPatches, cutting_up_the_sky_keeps_its_horizontal_illuminance) {
    for (const int mf : {1, 2, 4}) {
        const SkyPatches patches(mf);
        EXPECT_NEAR(horizontalIlluminance(patches, cieGeneralSky(5, {0, 1, 0}, 10)), 10 * kPi, 1e-9);
        double worst = 0, overcast = 0;
        for (const double altitude : {5.0, 30.0, 60.0, 85.0})
            for (int type = 1; type <= 16; ++type) {
                const Sky sky = cieGeneralSky(type, directionInWorld({77, altitude}, 90), 1000);
                const double cut = horizontalIlluminance(patches, sky);
                const double error = std::abs(cut / diffuseHorizontalIlluminance(sky) - 1);
                worst = std::max(worst, error);
                if (type == 16) overcast = error;
            }
        std::printf("subdivision %d: horizontal illuminance off by at most %.5f, overcast %.5f\n", mf, worst,
                    overcast);
        EXPECT_LT(overcast, 0.006 / (mf * mf));
        EXPECT_LT(worst, 0.05 / (mf * mf)); // second order in the patches' size
    }
}

TEST(SkyPatches, a_relight_takes_well_under_a_millisecond) {
    const SkyPatches patches(2);
    const Sky sky = cieGeneralSky(12, directionInWorld({77, 40}, 90), 1000);
    double sum = 0;
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < 20; ++i) sum += patches.luminances(sky)[7];
    const double ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count() / 20;
    EXPECT_GT(sum, 0);
    std::printf("577 patches: %.3f ms\n", ms);
}

TEST(SkyPatches, the_ground_is_the_last_element_and_a_dark_sky_is_black) {
    Sky sky = cieGeneralSky(16, {0, 1, 0}, 1000);
    sky.ground.luminance = 77;
    const SkyPatches patches(1);
    EXPECT_EQ(patches.luminances(sky).size(), 146u);
    EXPECT_EQ(patches.luminances(sky).back(), 77);
    for (const double l : patches.luminances(Sky{})) EXPECT_EQ(l, 0);
}

TEST(SkyPatches, turning_north_turns_the_pattern) {
    // A quarter turn maps the patches on to each other: every row's count is a multiple of 4 for
    // subdivision 2.
    const SkyPatches patches(2);
    SunPosition sun;
    sun.azimuthDeg = 100;
    sun.altitudeDeg = 35;
    SkySetting turned;
    turned.northDeg = 0;
    const auto before = patches.luminances(clearSky(sun)), after = patches.luminances(clearSky(sun, turned));
    for (size_t i = 0; i < patches.patchCount(); ++i) {
        const glm::dvec3 c = patches.centre(i);
        EXPECT_NEAR(after[patches.elementOf({-c.z, c.y, c.x})] / before[i], 1, 1e-9);
    }
}

// Where two Gauss rules agree, the finer is the mean: here of the formula itself, patch by patch, of skies
// from even to so steep round the sun that no pieces tell them.
TEST(SkyPatches, luminances_are_means_of_the_formula_whatever_its_course_round_the_sun) {
    const SkyPatches patches(4);
    constexpr auto kCoarse = gaussLegendre<2>();
    constexpr auto kFine = gaussLegendre<3>();
    const auto meanOf = [&](const Sky& sky, const SkyRow& row, uint32_t column, const auto& rule) {
        double sum = 0;
        for (const auto& u : rule)
            for (const auto& v : rule) {
                const double y = std::lerp(row.lowSine, row.highSine, u.x), level = std::sqrt(1 - y * y),
                             azimuth = 2 * kPi * (column + v.x - 0.5) / row.patchCount;
                sum += u.weight * v.weight *
                       sky.luminance({level * std::sin(azimuth), y, -level * std::cos(azimuth)});
            }
        return sum;
    };
    for (const auto& [c, d, e] : {std::array{0.0, -1.0, 0.0},
                                  {2.0, -1.0, 0.3},
                                  {-0.5, 0.3, 0.5},
                                  {0.0, -1.0, 0.4},
                                  {10.0, -3.0, 0.45},
                                  {24.0, -8.0, 0.0},
                                  {24.0, -22.0, 0.0},
                                  {24.0, -60.0, 0.0}}) {
        const Sky sky = perezSky({-0.9, -0.3, c, d, e}, glm::normalize(glm::dvec3(0.4, 0.3, -0.8)), 1000);
        const std::vector<double> luminances = patches.luminances(sky);
        size_t agreed = 0;
        for (const SkyRow& row : patches.rows().first(patches.rows().size() - 1))
            for (uint32_t column = 0; column < row.patchCount; ++column) {
                const double mean = meanOf(sky, row, column, kFine);
                if (std::abs(meanOf(sky, row, column, kCoarse) - mean) > 2e-4 * mean) continue;
                EXPECT_NEAR(luminances[row.firstPatch + column], mean, 1e-5 * mean) << d << " " << column;
                ++agreed;
            }
        EXPECT_GT(agreed, 1500u) << d;
    }
}

} // namespace
} // namespace heliodon::daylight
