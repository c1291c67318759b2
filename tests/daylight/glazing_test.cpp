#include "compute/daylight/glazing.h"

#include <cmath>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "compute/daylight/quadrature.h"

namespace heliodon::daylight {
namespace {

geometry::Material pane(float tn, float n = 1.52f) {
    geometry::Material m;
    m.transmittance = glm::vec3(tn);
    m.refractiveIndex = n;
    return m;
}

// The formula as Radiance's documentation of `glass` prints it, constants for n = 1.52 included.
double radianceGlass(double c, double tn) {
    const double n = 1.52;
    const double t = (std::sqrt(0.8402528435 + 0.0072522239 * tn * tn) - 0.9166530661) / 0.0036261119 / tn;
    const double c2 = std::sqrt(1 - 1 / (n * n) + c * c / (n * n)), d = std::pow(t, 1 / c2);
    const double r1 = std::pow((c - n * c2) / (c + n * c2), 2),
                 r2 = std::pow((1 / c - n / c2) / (1 / c + n / c2), 2);
    return 0.5 * (1 - r1) * (1 - r1) * d / (1 - r1 * r1 * d * d) +
           0.5 * (1 - r2) * (1 - r2) * d / (1 - r2 * r2 * d * d);
}

TEST(Glazing, is_radiances_glass) {
    for (const double tn : {0.05, 0.3, 0.65, 0.88, 0.9}) {
        const double t = transmissivityFromNormal(tn, 1.52);
        EXPECT_NEAR(slabTransmittance(1, t, 1.52), tn, 1e-14);
        // Ten digits of the printed constants, of which the difference in the numerator leaves six.
        for (double c = 0.01; c <= 1; c += 0.01)
            EXPECT_NEAR(slabTransmittance(c, t, 1.52), radianceGlass(c, tn), 5e-7);
    }
    EXPECT_NEAR(transmissivityFromNormal(0.88, 1.52), 0.9584, 5e-5);
}

TEST(Glazing, without_absorption_follows_fresnel_alone) {
    // At Brewster's angle one polarisation passes whole: T = (1 + (1 - r1) / (1 + r1)) / 2.
    const double n = 1.52, c = std::cos(std::atan(n)), c2 = std::sqrt(1 - (1 - c * c) / (n * n));
    const double r1 = std::pow((c - n * c2) / (c + n * c2), 2);
    EXPECT_NEAR(slabTransmittance(c, 1, n), 0.5 * (1 + (1 - r1) / (1 + r1)), 1e-14);
    EXPECT_NEAR(maximumTransmittance(1.52), 0.91832, 5e-6);
    EXPECT_NEAR(slabTransmittance(1, 1, 1.52), maximumTransmittance(1.52), 1e-14);
}

// Light runs to and fro between the two panes of a window; geometry/double_glazing.h takes them as one slab.
TEST(Glazing, one_slab_stands_for_two) {
    const double n = 1.52;
    for (const auto& [a, b] : {std::pair(0.9, 0.9), {0.8, 0.8}, {0.88, 0.6}, {0.3, 0.3}, {0.88, 0.2}}) {
        const double ta = transmissivityFromNormal(a, n), tb = transmissivityFromNormal(b, n);
        const auto two = [&](double c) {
            return slabTransmittance(c, ta, n) * slabTransmittance(c, tb, n) /
                   (1 - slabReflectance(c, ta, n) * slabReflectance(c, tb, n));
        };
        const Glazing one = glazingOf(pane(static_cast<float>(a * b)));
        for (const auto& [degrees, least, most] :
             {std::tuple(0.0, 0.991, 0.999), {20.0, 0.991, 0.999}, {40.0, 0.991, 1.0}, {60.0, 1.04, 1.07}}) {
            const double c = std::cos(degrees * 3.141592653589793 / 180),
                         ratio = one.transmittance(c).x / two(c);
            EXPECT_GT(ratio, least) << a << ' ' << b << ' ' << degrees;
            EXPECT_LT(ratio, most) << a << ' ' << b << ' ' << degrees;
        }
        double diffuse = 0;
        for (const auto& [c, w] : kGauss24) diffuse += w * 2.0 * c * two(c);
        const double ratio = one.diffuseTransmittance().x / diffuse;
        EXPECT_GT(ratio, 1.02);
        EXPECT_LT(ratio, 1.031);
    }
}

TEST(Glazing, falls_to_nothing_at_grazing_and_never_passes_more_than_one) {
    for (const float tn : {0.01f, 0.5f, 0.88f, 1.0f}) {
        const Glazing glazing = glazingOf(pane(tn));
        EXPECT_EQ(glazing.transmittance(0).x, 0);
        double last = 0;
        for (double c = 1e-6; c <= 1; c += 1e-3) {
            const double t = glazing.transmittance(c).x;
            ASSERT_TRUE(t >= last && t <= 1) << c; // rises all the way to normal incidence
            last = t - 1e-3;                       // the lossless pane has a shallow maximum on the way
            EXPECT_EQ(t, glazing.transmittance(-c).x);
        }
    }
    EXPECT_FALSE(isPossible(pane(0.95f)));
    EXPECT_TRUE(isPossible(pane(0.9183f)));
    EXPECT_TRUE(isPossible(pane(1.0f, 1.0f)));
    EXPECT_NEAR(glazingOf(pane(0.95f)).transmittance(1).x, 0.91832, 5e-6);
}

TEST(Glazing, a_hole_passes_the_same_from_everywhere) {
    const Glazing hole = glazingOf(pane(1, 1));
    EXPECT_TRUE(hole.isHole());
    for (const double c : {0.0, 0.3, 1.0}) EXPECT_EQ(hole.transmittance(c).y, 1);
    EXPECT_EQ(hole.diffuseTransmittance().z, 1);
    // A slab of index just above 1 that absorbs nothing is a hole too.
    EXPECT_NEAR(slabTransmittance(0.3, 1, 1.0 + 1e-9), 1, 1e-12);
}

TEST(Glazing, tints_each_channel_by_itself) {
    geometry::Material m = pane(0.5f);
    m.transmittance = {0.8f, 0.5f, 0};
    const Glazing glazing = glazingOf(m);
    const glm::dvec3 t = glazing.transmittance(0.7);
    EXPECT_DOUBLE_EQ(t.x, glazingOf(pane(0.8f)).transmittance(0.7).y);
    EXPECT_DOUBLE_EQ(t.y, glazingOf(pane(0.5f)).transmittance(0.7).x);
    EXPECT_EQ(t.z, 0);
}

TEST(Glazing, diffuse_transmittance_is_the_mean_over_the_hemisphere) {
    for (const float tn : {0.2f, 0.65f, 0.88f}) {
        const Glazing glazing = glazingOf(pane(tn));
        double sum = 0;
        const int n = 200'000; // midpoint rule: 1e-10
        for (int i = 0; i < n; ++i) {
            const double c = (i + 0.5) / n;
            sum += 2 * c * glazing.transmittance(c).x / n;
        }
        EXPECT_NEAR(glazing.diffuseTransmittance().x, sum, 1e-7);
    }
    // Clear glass of 0.88 passes 0.80 of diffuse light (window handbooks: 0.91 to 0.92 of its normal value).
    EXPECT_NEAR(glazingOf(pane(0.88f)).diffuseTransmittance().x / 0.88, 0.915, 0.01);
}

} // namespace
} // namespace heliodon::daylight
