#include "compute/daylight/sky.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <glm/geometric.hpp>

#include "compute/daylight/frame.h"
#include "compute/daylight/horizon_ribbon.h"
#include "compute/daylight/quadrature.h"

namespace heliodon::daylight {

namespace {

// CIE S 011/E:2003, table 1.
constexpr std::array<std::array<double, 5>, 15> kCieTypes{{{4.0, -0.70, 0, -1.0, 0},
                                                           {4.0, -0.70, 2, -1.5, 0.15},
                                                           {1.1, -0.80, 0, -1.0, 0},
                                                           {1.1, -0.80, 2, -1.5, 0.15},
                                                           {0.0, -1.00, 0, -1.0, 0},
                                                           {0.0, -1.00, 2, -1.5, 0.15},
                                                           {0.0, -1.00, 5, -2.5, 0.30},
                                                           {0.0, -1.00, 10, -3.0, 0.45},
                                                           {-1.0, -0.55, 2, -1.5, 0.15},
                                                           {-1.0, -0.55, 5, -2.5, 0.30},
                                                           {-1.0, -0.55, 10, -3.0, 0.45},
                                                           {-1.0, -0.32, 10, -3.0, 0.45},
                                                           {-1.0, -0.32, 16, -3.0, 0.30},
                                                           {-1.0, -0.15, 16, -3.0, 0.30},
                                                           {-1.0, -0.15, 24, -2.8, 0.15}}};

double intermediateShape(double z, double sunZ, double cosine) {
    const double n = std::acos(std::clamp(z, 0.0, 1.0)), t = std::acos(std::clamp(sunZ, -1.0, 1.0));
    const double g = std::acos(std::clamp(cosine, -1.0, 1.0));
    return ((1.35 * std::sin(5.631 - 3.59 * n) + 3.12) * std::sin(4.396 - 2.6 * t) + 6.37 - n) / 2.326 *
           std::exp(-0.563 * g * ((2.629 - n) * (1.562 - t) + 0.812));
}

// The height z below which the gradation 1 + a exp(b / z) is negative, which some fits of Perez have; else 0.
double darkBelow(const SkyFormula& f) {
    const bool fallsBelowZero = !f.intermediate && f.g1 == 0 && f.b > 0 && f.a < 0 && f.a > -1;
    return fallsBelowZero ? f.b / std::log(-1.0 / f.a) : 0;
}

// Makes the zenith's luminance `zenith`; a shape that is black there stays black.
void scaleToZenith(Sky& sky, double zenith) {
    sky.formula.scale = 1;
    const double shape = sky.luminance({0, 1, 0});
    sky.formula.scale = shape > 0 ? zenith / shape : 0;
}

} // namespace

double gradation(const SkyFormula& f, double z) {
    const double exponential = f.a == 0 ? 0 : f.a * std::exp(f.b / std::max(z, f.zFloor));
    return f.g0 + f.g1 * z + exponential;
}

double indicatrix(const SkyFormula& f, double cosine) {
    if (f.c == 0 && f.e == 0) return f.i0;
    return f.i0 + f.c * std::exp(f.d * std::acos(std::clamp(cosine, -1.0, 1.0))) + f.e * cosine * cosine;
}

double luminance(const SkyFormula& f, double gradation, double cosine) {
    return f.scale * std::max(0.0, gradation * indicatrix(f, cosine));
}

double Sky::luminance(glm::dvec3 direction) const {
    const double z = direction.y;
    if (z <= 0) return ground.luminance;
    if (formula.scale <= 0) return 0;
    const double cosine = glm::dot(direction, shapeDirection);
    return formula.intermediate
               ? formula.scale * std::max(0.0, intermediateShape(z, shapeDirection.y, cosine))
               : daylight::luminance(formula, gradation(formula, z), cosine);
}

Sky cieGeneralSky(int type, glm::dvec3 sunDirection, double zenithLuminance) {
    if (type < 1 || type > 16) throw std::invalid_argument("cieGeneralSky: the type must be 1 to 16");
    Sky sky;
    sky.shapeDirection = sunDirection;
    if (type == 16) {
        sky.model = "cie_overcast";
        sky.formula.g0 = 1.0 / 3.0;
        sky.formula.g1 = 2.0 / 3.0;
    } else {
        sky.model = "cie_general_" + std::to_string(type);
        const auto& [a, b, c, d, e] = kCieTypes[static_cast<size_t>(type - 1)];
        sky.formula.a = a;
        sky.formula.b = b;
        sky.formula.i0 = 1.0 - c * std::exp(d * kPi / 2.0);
        sky.formula.c = c;
        sky.formula.d = d;
        sky.formula.e = e;
    }
    scaleToZenith(sky, zenithLuminance);
    return sky;
}

Sky cieClearSky(glm::dvec3 sunDirection, double zenithLuminance, double norm) {
    Sky sky;
    sky.model = "cie_clear";
    sky.shapeDirection = sunDirection;
    sky.formula.a = -1;
    sky.formula.b = -0.32;
    sky.formula.i0 = 0.91;
    sky.formula.c = 10;
    sky.formula.d = -3;
    sky.formula.e = 0.45;
    if (norm > 0)
        sky.formula.scale = zenithLuminance / norm;
    else
        scaleToZenith(sky, zenithLuminance);
    return sky;
}

Sky cieIntermediateSky(glm::dvec3 sunDirection, double zenithLuminance) {
    Sky sky;
    sky.model = "cie_intermediate";
    sky.shapeDirection = sunDirection;
    sky.formula.intermediate = true;
    scaleToZenith(sky, zenithLuminance);
    return sky;
}

Sky perezSky(const PerezShape& shape, glm::dvec3 sunDirection, double scale) {
    Sky sky;
    sky.model = "perez";
    sky.shapeDirection = sunDirection;
    sky.formula.scale = scale;
    sky.formula.a = shape.a;
    sky.formula.b = shape.b;
    sky.formula.zFloor = 0.01;
    sky.formula.c = shape.c;
    sky.formula.d = shape.d;
    sky.formula.e = shape.e;
    return sky;
}

// Every formula depends on the azimuth only through its distance from the sun's, so half the sky is enough.
// In altitude the rule is cut at the sun, where the luminance has a cone's tip, and its nodes crowd there
// (t^2), as they do at the horizon for exp(b / z); a ribbon there is cut once more.
double diffuseHorizontalIlluminance(const Sky& sky) {
    if (sky.formula.scale <= 0) return 0;
    const SkyFormula& f = sky.formula;
    const double sunZ = sky.shapeDirection.y;
    const double sunAltitude = std::asin(std::clamp(sunZ, 0.0, 1.0));
    const double sunLevel = std::hypot(sky.shapeDirection.x, sky.shapeDirection.z);
    std::array<double, kGauss24.size()> cosines{};
    for (size_t i = 0; i < cosines.size(); ++i) cosines[i] = std::cos(kPi * kGauss24[i].x * kGauss24[i].x);

    const auto ring = [&](double altitude) {
        const double z = std::sin(altitude), level = std::cos(altitude);
        const double atZ = f.intermediate ? 0 : gradation(f, z);
        double sum = 0;
        for (size_t i = 0; i < cosines.size(); ++i) {
            const double cosine = z * sunZ + level * sunLevel * cosines[i];
            const double there = f.intermediate ? f.scale * std::max(0.0, intermediateShape(z, sunZ, cosine))
                                                : luminance(f, atZ, cosine);
            sum += kGauss24[i].weight * 2.0 * kPi * kGauss24[i].x * there;
        }
        return 2.0 * sum * z * level;
    };
    // From `from`, where the nodes crowd, to `to`.
    const auto band = [&](double from, double to) {
        double sum = 0;
        for (const auto& [t, w] : kGauss24)
            sum += w * 2.0 * t * std::abs(to - from) * ring(from + (to - from) * t * t);
        return sum;
    };
    const auto between = [&](double from, double to) {
        const double middle = 0.5 * (from + to);
        return band(from, middle) + band(to, middle);
    };
    if (hasHorizonRibbon(f)) {
        std::array<double, 6> ends{sunAltitude, kPi / 2};
        std::ranges::transform(horizonRibbonCuts(f), ends.begin() + 2,
                               [](double z) { return std::asin(std::min(1.0, z)); });
        std::ranges::sort(ends);
        double sum = 0, from = 0;
        for (const double to : ends) sum += between(std::exchange(from, to), to);
        return sum;
    }
    const double low = std::asin(std::min(1.0, darkBelow(f)));
    if (low >= sunAltitude) return band(low, kPi / 2);
    return between(low, sunAltitude) + band(sunAltitude, kPi / 2);
}

double directHorizontalIlluminance(const Sky& sky) {
    return sky.sun.normalIlluminance * std::max(0.0, sky.sun.direction.y);
}

double globalHorizontalIlluminance(const Sky& sky) {
    return diffuseHorizontalIlluminance(sky) + directHorizontalIlluminance(sky);
}

void lightGround(Sky& sky, double albedo) {
    sky.ground.albedo = albedo;
    sky.ground.luminance = albedo > 0 ? albedo * globalHorizontalIlluminance(sky) / kPi : 0;
}

} // namespace heliodon::daylight
