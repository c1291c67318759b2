#include "compute/daylight/window.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "compute/daylight/frame.h"

namespace heliodon::daylight {
namespace {

struct Shares {
    double straight = 0, scattered = 0, reflected = 0;
    SlatLight onward{}, back{};     // of scattered and reflected, where to
    std::array<double, 90> steps{}; // of scattered, luminance x pi every 2 degrees of elevation
    double sideways = 0;            // of scattered, more than 60 degrees along the slats
};

void addTo(SlatLight& light, double up, double out, double share) {
    const BetweenNodes at = betweenNodes(std::atan2(up, out));
    light[at.lower] += share * (1 - at.part) / nodeShare(at.lower);
    light[at.lower + 1] += share * at.part / nodeShare(at.lower + 1);
}

// Of a Lambertian face's light, every 2 degrees of elevation.
double shareOfStep(size_t step) {
    const double low = std::numbers::pi * (static_cast<double>(step) / 90 - 0.5);
    return 0.5 * (std::sin(low + radians(2)) - std::sin(low));
}

// Means about the nodes of what runs linearly between them, as `addTo` counts rays.
SlatLight meansOf(const SlatLight& light) {
    SlatLight means{};
    const int steps = 100 * (kSlatNodes - 1);
    for (int k = 0; k < steps; ++k) {
        const double elevation = std::numbers::pi * ((k + 0.5) / steps - 0.5);
        const BetweenNodes at = betweenNodes(elevation);
        addTo(means, std::sin(elevation), std::cos(elevation),
              ((1 - at.part) * light[at.lower] + at.part * light[at.lower + 1]) * 0.5 * std::cos(elevation) *
                  std::numbers::pi / steps);
    }
    return means;
}

// Rays through a stack of slats, one by one, Lambertian and in three dimensions; shares no code with Slats.
// Slats are the segments with middles at (0, k spacing), x outwards, y up, z along; a ray starts on the plane
// through the outer edges at a random height. A pane outside reflects as a slab of this transmissivity does,
// so far off that where light comes back has nothing to do with where it left.
Shares traced(double angleDeg, double spacing, double rho, double profile, double along, int rays,
              std::optional<double> pane = {}) {
    std::minstd_rand random(7);
    std::uniform_real_distribution<double> unit(0, 1);
    const double a = radians(angleDeg);
    const glm::dvec3 outer(0.5 * std::cos(a), -0.5 * std::sin(a), 0), normal(std::sin(a), std::cos(a), 0);
    Shares shares;
    for (int n = 0; n < rays; ++n) {
        glm::dvec3 at(outer.x, spacing * (n + unit(random)) / rays + outer.y, 0);
        glm::dvec3 towards = -glm::dvec3(std::cos(profile), std::sin(profile), along);
        bool touched = false;
        int on = -1000000; // the slat that it starts from
        for (;;) {
            // Heights over slat planes: plane k is normal . p = k spacing cos a.
            const double rise = glm::dot(towards, normal),
                         height = glm::dot(at, normal) / (spacing * std::cos(a));
            double nearest = 1e300;
            int hit = on;
            const int first = static_cast<int>(std::floor(height)) - 40;
            for (int k = first; k < first + 81 && std::abs(rise) > 1e-12; ++k) {
                if (k == on) continue;
                const double t = (k * spacing * std::cos(a) - glm::dot(at, normal)) / rise;
                if (t <= 0 || t >= nearest) continue;
                const glm::dvec3 p = at + t * towards - glm::dvec3(0, k * spacing, 0);
                if (std::abs(glm::dot(p, outer)) < 0.25) nearest = t, hit = k; // |outer|^2
            }
            if (nearest > 1e299) {
                if (towards.x > 0 && pane &&
                    unit(random) < slabReflectance(towards.x / glm::length(towards), *pane, 1.52)) {
                    at = {outer.x, spacing * unit(random) + outer.y, 0};
                    towards.x = -towards.x;
                    on = -1000000;
                    continue;
                }
                (towards.x < 0 ? (touched ? shares.scattered : shares.straight) : shares.reflected) +=
                    1.0 / rays;
                if (touched)
                    addTo(towards.x < 0 ? shares.onward : shares.back, towards.y, std::abs(towards.x),
                          1.0 / rays);
                if (touched && towards.x < 0) {
                    const double elevation = std::atan2(towards.y, -towards.x);
                    const auto step = static_cast<size_t>(90 * (elevation / std::numbers::pi + 0.5));
                    shares.steps[std::min<size_t>(step, 89)] += 1 / (rays * shareOfStep(step));
                    if (std::abs(towards.z) > std::tan(radians(60)) * std::hypot(towards.x, towards.y))
                        shares.sideways += 1.0 / rays;
                }
                break;
            }
            if (unit(random) >= rho) break;
            touched = true;
            at += nearest * towards;
            on = hit;
            const glm::dvec3 up = rise < 0 ? normal : -normal;
            const double sine = std::sqrt(unit(random)), turn = 2 * std::numbers::pi * unit(random);
            const glm::dvec3 across(up.y, -up.x, 0);
            towards = sine * std::cos(turn) * across + glm::dvec3(0, 0, sine * std::sin(turn)) +
                      std::sqrt(1 - sine * sine) * up;
        }
    }
    return shares;
}

TEST(Slats, agree_with_traced_rays) {
    for (const auto& [angle, spacing, rho] :
         {std::tuple(0.0, 0.8, 0.5), {45.0, 0.8, 0.7}, {-30.0, 1.2, 0.9}, {70.0, 0.8, 0.8}, {20.0, 0.4, 0.3}})
        for (const double profileDeg : {-50.0, 0.0, 10.0, 35.0, 70.0})
            for (const double along : {0.0, 0.8}) {
                const Slats slats(angle, spacing, rho);
                const double profile = radians(profileDeg);
                const int rays = 100'000; // shares are random to 0.0016 at most
                const Shares s = traced(angle, spacing, rho, profile, along, rays);
                EXPECT_NEAR(slats.straight(profile), s.straight, 5e-5) << angle << ' ' << profileDeg;
                EXPECT_NEAR(slats.scattered(profile), s.scattered, 0.006) << angle << ' ' << profileDeg;
                EXPECT_NEAR(slats.reflected(profile), s.reflected, 0.006) << angle << ' ' << profileDeg;
                const SlatLight on = meansOf(slats.scatteredLight(profile)),
                                back = meansOf(slats.reflectedLight(profile));
                double onMean = 0, backMean = 0;
                for (size_t node = 0; node < kSlatNodes; ++node) {
                    onMean += nodeShare(node) * on[node], backMean += nodeShare(node) * back[node];
                    // Noise: the root of what a node gets, over the root of its rays.
                    const auto noise = [&](double light) {
                        return 4 * std::sqrt(std::max(light, 0.01) / (rays * nodeShare(node))) + 0.005;
                    };
                    EXPECT_NEAR(on[node], s.onward[node], noise(on[node]))
                        << angle << ' ' << profileDeg << ' ' << node;
                    EXPECT_NEAR(back[node], s.back[node], noise(back[node]))
                        << angle << ' ' << profileDeg << ' ' << node;
                }
                EXPECT_NEAR(onMean, slats.scattered(profile), 1e-3);
                EXPECT_NEAR(backMean, slats.reflected(profile), 1e-3);
            }
}

// Slats seen edge-on hide their bright faces within a few degrees: the light between nodes bends with them.
TEST(Slats, light_bends_where_slats_are_seen_edge_on) {
    for (const double angle : {30.0, 45.0, 60.0, 70.0}) {
        const int rays = 300'000;
        const double profile = radians(40);
        const Shares s = traced(angle, 0.8, 0.7, profile, 0, rays);
        const SlatLight light = Slats(angle, 0.8, 0.7).scatteredLight(profile);
        double lower = 0, furthest = 0; // light from straight down on, told over traced
        for (size_t step = 0; step < s.steps.size(); ++step) {
            for (const double part : {0.125, 0.375, 0.625, 0.875}) {
                const BetweenNodes at =
                    betweenNodes(std::numbers::pi * ((static_cast<double>(step) + part) / 90 - 0.5));
                lower += 0.25 * shareOfStep(step) *
                         ((1 - at.part) * light[at.lower] + at.part * light[at.lower + 1]);
            }
            lower -= shareOfStep(step) * s.steps[step];
            furthest = std::max(furthest, std::abs(lower));
        }
        EXPECT_LT(furthest, 0.001) << angle; // the noise of the rays is 0.0003 to 0.0006
    }
}

// The sun on level slats lights their upper faces, which only what is above them sees.
TEST(Slats, send_the_sun_up) {
    const SlatLight light = Slats(0, 0.8, 0.7).scatteredLight(radians(45));
    double up = 0, down = 0;
    for (size_t node = 0; node < kSlatNodes / 2; ++node)
        down += light[node], up += light[kSlatNodes - 1 - node];
    EXPECT_GT(down, 0); // by way of the neighbour
    EXPECT_GT(up, 2 * down);
}

TEST(Slats, light_from_everywhere_is_the_mean_of_light_from_each_direction) {
    for (const double angle : {0.0, 30.0, -60.0}) {
        const Slats slats(angle, 0.8, 0.6);
        double through = 0, back = 0;
        const int n = 20'000; // by the sine of the profile angle: what arrives there is even in it
        for (int k = 0; k < n; ++k) {
            const double profile = std::asin(2 * (k + 0.5) / n - 1);
            through += (slats.straight(profile) + slats.scattered(profile)) / n;
            back += slats.reflected(profile) / n;
        }
        EXPECT_NEAR(through, slats.diffuseTransmittance(), 5e-4); // strips of constant light
        EXPECT_NEAR(back, slats.diffuseReflectance(), 5e-4);
    }
}

TEST(Slats, keep_all_energy) {
    // Nothing is absorbed where (nearly) all is reflected; black slats scatter nothing.
    for (const double angle : {0.0, 45.0, -80.0})
        for (const double profile : {-1.2, 0.0, 0.3, 1.0}) {
            const Slats white(angle, 0.8, 0.999999), black(angle, 0.8, 0);
            EXPECT_NEAR(white.straight(profile) + white.scattered(profile) + white.reflected(profile), 1,
                        1e-3);
            EXPECT_NEAR(white.diffuseTransmittance() + white.diffuseReflectance(), 1, 1e-3);
            EXPECT_EQ(black.scattered(profile) + black.reflected(profile), 0);
            const Slats grey(angle, 0.8, 0.5);
            EXPECT_LE(grey.straight(profile) + grey.scattered(profile) + grey.reflected(profile), 1);
        }
}

TEST(Slats, open_and_closed_are_the_limits) {
    // Level slats and level light: nothing in the way. Light along tilted slats too.
    EXPECT_EQ(Slats(0, 0.8, 0.5).straight(0), 1);
    EXPECT_NEAR(Slats(40, 0.8, 0.5).straight(radians(-40)), 1, 1e-12);
    // Wide apart: as if they were not there. All but shut: nearly nothing passes.
    EXPECT_GT(Slats(0, 10, 0).diffuseTransmittance(), 0.9);
    EXPECT_EQ(Slats(85, 0.8, 0.5).straight(0.5), 0);
    EXPECT_LT(Slats(85, 0.8, 0.5).diffuseTransmittance(), 0.02);
    // Black: the closed form of two parallel strips, F = sqrt(1 + (w/s)^2) - w/s.
    const double ratio = 1 / 0.8;
    EXPECT_NEAR(Slats(0, 0.8, 0).diffuseTransmittance(), std::sqrt(1 + ratio * ratio) - ratio, 1e-12);
    // Cut-off of level slats: tan(profile) = spacing / width.
    EXPECT_EQ(Slats(0, 0.8, 0).straight(std::atan(0.8) + 1e-9), 0);
    EXPECT_GT(Slats(0, 0.8, 0).straight(std::atan(0.8) - 1e-3), 0);
}

geometry::Material glass(float refractiveIndex = 1.52f) {
    geometry::Material m;
    m.transmittance = glm::vec3(refractiveIndex == 1 ? 1.0f : 0.88f);
    m.refractiveIndex = refractiveIndex;
    return m;
}

const glm::dvec3 kInwards(0, 0, 1);

TEST(Window, without_a_blind_is_its_glass) {
    const Window window(glass());
    const glm::dvec3 sun = glm::normalize(glm::dvec3(0.3, 0.5, -0.8));
    EXPECT_EQ(window.straight(sun, kInwards), glazingOf(glass()).transmittance(-sun.z));
    EXPECT_EQ(window.scattered(sun, kInwards), glm::dvec3(0));
    EXPECT_EQ(window.straight(-sun, kInwards), glm::dvec3(0)); // from inside
    EXPECT_EQ(window.diffuseTransmittance(), glazingOf(glass()).diffuseTransmittance());
}

TEST(Window, a_fabric_in_a_hole_passes_and_reflects_what_it_says) {
    geometry::Blind fabric{geometry::Blind::Kind::fabric, 0.3f, 0.5f};
    const geometry::Material m = withBlind(glass(1), fabric);
    const Window window(m);
    EXPECT_NEAR(window.scattered(glm::normalize(glm::dvec3(0.3, 0.5, -0.8)), kInwards).y, 0.3, 1e-7);
    EXPECT_EQ(window.straight({0, 0, -1}, kInwards), glm::dvec3(0));
    EXPECT_NEAR(window.diffuseTransmittance().y, 0.3, 1e-7);
    EXPECT_NEAR(m.reflectance.y, 0.5, 1e-7);
}

TEST(Window, glass_and_blind_keep_all_energy) {
    // Glass that absorbs nothing and a blind that absorbs nothing: what falls in from everywhere is passed or
    // sent back; from the room all returns but what the same path lets out.
    geometry::Material clear = glass();
    clear.transmittance = glm::vec3(static_cast<float>(maximumTransmittance(1.52)));
    for (const geometry::Blind& blind : {geometry::Blind{geometry::Blind::Kind::fabric, 0.4f, 0.6f},
                                         geometry::Blind{geometry::Blind::Kind::slats, 0, 0.999999f, 30}}) {
        const Window window(withBlind(clear, blind));
        // By reciprocity the diffuse transmittance is the same both ways, but for the glass's direction
        // dependence, which the blind's scatter levels out.
        EXPECT_NEAR(window.roomReflectance().y + window.diffuseTransmittance().y, 1, 0.01);
    }
    for (const double c : {0.1, 0.5, 1.0})
        EXPECT_NEAR(slabReflectance(c, 1, 1.52) + slabTransmittance(c, 1, 1.52), 1, 1e-12);
}

TEST(Window, slats_behind_glass_agree_with_traced_rays) {
    for (const auto& [angle, rho] : {std::pair(0.0f, 0.7f), {45.0f, 0.8f}, {-30.0f, 0.9f}}) {
        const Window window(withBlind(glass(), {geometry::Blind::Kind::slats, 0, rho, angle, 0.8f}));
        for (const glm::dvec3& direction :
             {glm::dvec3(0, 0, -1), {0.4, 0.7, -0.8}, {0, -0.5, -1}, {0.5, 2, -1}}) {
            const glm::dvec3 towards = glm::normalize(direction);
            const int rays = 100'000;
            const Shares s =
                traced(angle, 0.8, rho, std::atan2(towards.y, -towards.z),
                       towards.x / std::hypot(towards.y, towards.z), rays, window.glazing().transmissivity.y);
            const double through = window.glazing().transmittance(-towards.z).y,
                         scattered = window.scattered(towards, kInwards).y / through;
            EXPECT_NEAR(scattered, s.scattered, 0.006);
            const Window::Lobes lobes = window.lobes(towards, kInwards);
            double mean = 0;
            SlatLight all;
            for (size_t node = 0; node < kSlatNodes; ++node)
                all[node] = (lobes[node] + lobes[kSlatNodes + node]).y / through + scattered;
            all = meansOf(all);
            for (size_t node = 0; node < kSlatNodes; ++node) {
                const double light = all[node];
                EXPECT_NEAR(light, s.onward[node],
                            4 * std::sqrt(std::max(light, 0.01) / (rays * nodeShare(node))) + 0.008)
                    << angle << ' ' << direction.y << ' ' << node;
                mean += nodeShare(node) * (lobes[node] + lobes[kSlatNodes + node]).y;
            }
            EXPECT_NEAR(mean, 0, 1e-12);
        }
    }
}

// What glass mirrors between the slats goes sideways more than straight on: of a Lambertian face's light 5.8
// % run more than 60 degrees along the slats.
TEST(Window, glass_mirrors_sideways_more_than_straight_on) {
    for (const float angle : {45.0f, 60.0f}) {
        const Window window(withBlind(glass(), {geometry::Blind::Kind::slats, 0, 0.7f, angle, 0.8f}));
        const glm::dvec3 towards = glm::normalize(glm::dvec3(0, 0.8, -0.5));
        const Shares s = traced(double{angle}, 0.8, 0.7, std::atan2(towards.y, -towards.z), 0, 300'000,
                                window.glazing().transmissivity.y);
        const double through = window.glazing().transmittance(-towards.z).y,
                     even = window.scattered(towards, kInwards).y / through;
        const Window::Lobes lobes = window.lobes(towards, kInwards);
        double sideways = 0, all = 0;
        for (int i = 0; i < 180; ++i)
            for (int k = 0; k < 180; ++k) {
                const double elevation = radians(i - 89.5), turn = radians((k + 0.5) / 2);
                const glm::dvec3 way(std::sin(turn), std::cos(turn) * std::sin(elevation),
                                     std::cos(turn) * std::cos(elevation));
                const BetweenNodes at = betweenNodes(elevation);
                const auto between = [&](size_t first) {
                    return ((1 - at.part) * lobes[first + at.lower].y +
                            at.part * lobes[first + at.lower + 1].y) /
                           through;
                };
                const double light = even + between(0) + window.mirrored(way, kInwards) * between(kSlatNodes);
                const double share = std::cos(elevation) * std::cos(turn) * std::cos(turn) * radians(1) *
                                     radians(0.5) * 2 / std::numbers::pi;
                all += share * light;
                if (turn > radians(60)) sideways += share * light;
            }
        EXPECT_NEAR(all, s.scattered, 0.004);
        EXPECT_NEAR(sideways / all, s.sideways / s.scattered, 0.004) << angle;
        EXPECT_GT(sideways / all, 0.07);
    }
}

TEST(Window, slats_of_skylights_run_along_x) {
    geometry::Blind slats{geometry::Blind::Kind::slats, 0, 0.5f, 0};
    const Window window(withBlind(glass(1), slats));
    const glm::dvec3 down(0, -1, 0);
    EXPECT_EQ(window.straight({0, 1, 0}, down).y, 1);
    EXPECT_NEAR(window.straight(glm::normalize(glm::dvec3(1, 1, 0)), down).y, 1, 1e-12); // along them
    EXPECT_LT(window.straight(glm::normalize(glm::dvec3(0, 1, 1)), down).y, 0.01);       // across
}

} // namespace
} // namespace heliodon::daylight
