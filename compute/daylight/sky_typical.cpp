// Skies from a sun position alone: G. Ward's gensky (Radiance) and the typical values of the CIE general sky.
#include <algorithm>
#include <array>
#include <cmath>

#include "compute/daylight/frame.h"
#include "compute/daylight/sky.h"

namespace heliodon::daylight {

namespace {

constexpr double kWhiteEfficacy = 179.0, kSkyEfficacy = 203.0, kSunEfficacy = 208.0; // lm/W, Radiance
constexpr double kHighestSunDeg = 87.0; // tan h of the clear zenith runs away above
constexpr double kExtraterrestrialLux = 133.8e3;

struct Typical {
    double diffuseRatio; // Dv/Ev
    double turbidity;    // Tv; 0 = the sun is not seen
};

// Darula and Kittler 2002, table 2.
constexpr std::array<Typical, 15> kTypical{{{0.10, 0},
                                            {0.18, 0},
                                            {0.15, 0},
                                            {0.22, 0},
                                            {0.20, 0},
                                            {0.38, 0},
                                            {0.42, 12.0},
                                            {0.41, 10.0},
                                            {0.40, 12.0},
                                            {0.36, 10.0},
                                            {0.23, 4.0},
                                            {0.10, 2.5},
                                            {0.28, 4.5},
                                            {0.28, 5.0},
                                            {0.30, 4.0}}};

Sky darkSky(glm::dvec3 direction, const SkySetting& setting) {
    Sky sky;
    sky.shapeDirection = sky.sun.direction = direction;
    sky.ground.albedo = setting.groundAlbedo;
    return sky;
}

double clearZenith(double altitudeDeg, double turbidity) {
    const double h = radians(std::min(altitudeDeg, kHighestSunDeg));
    return std::max(0.0, (1.376 * turbidity - 1.81) * std::tan(h) + 0.38) * 1000.0;
}

double overcastZenith(double altitudeDeg) {
    return (8.6 * std::sin(radians(altitudeDeg)) + 0.123) * 1000.0;
}

double genskySunLux(double altitudeDeg) {
    const double solidAngle = 2.0 * kPi * (1.0 - std::cos(radians(0.25)));
    const double luminance = 1.5e9 * (1.147 - 0.147 / std::max(std::sin(radians(altitudeDeg)), 0.16));
    return luminance * solidAngle * kWhiteEfficacy / kSunEfficacy;
}

// F. Kasten, A. Young: Revised optical air mass tables and approximation formula. Applied Optics 28, 1989.
double airMass(double altitudeDeg) {
    return 1.0 / (std::sin(radians(altitudeDeg)) + 0.50572 * std::pow(altitudeDeg + 6.07995, -1.6364));
}

template<typename MakeShape>
Sky genskySky(const SunPosition& sun, const SkySetting& setting, double zenith, double sunShare,
              MakeShape shape) {
    const glm::dvec3 direction = directionInWorld({sun.azimuthDeg, sun.altitudeDeg}, setting.northDeg);
    if (!sun.isUp()) return darkSky(direction, setting);
    Sky sky = shape(direction, zenith * kWhiteEfficacy / kSkyEfficacy);
    sky.sun = {direction, sunShare > 0 ? sunShare * genskySunLux(sun.altitudeDeg) : 0.0};
    lightGround(sky, setting.groundAlbedo);
    return sky;
}

} // namespace

Sky clearSky(const SunPosition& sun, const SkySetting& setting) {
    return genskySky(sun, setting, clearZenith(sun.altitudeDeg, setting.turbidity), 1.0,
                     [](glm::dvec3 d, double zenith) { return cieClearSky(d, zenith); });
}

Sky intermediateSky(const SunPosition& sun, const SkySetting& setting) {
    const double zenith =
        0.5 * (clearZenith(sun.altitudeDeg, setting.turbidity) + overcastZenith(sun.altitudeDeg));
    return genskySky(sun, setting, zenith, 0.15, cieIntermediateSky);
}

Sky overcastSky(const SunPosition& sun, const SkySetting& setting) {
    return genskySky(sun, setting, overcastZenith(sun.altitudeDeg), 0.0,
                     [](glm::dvec3 d, double zenith) { return cieGeneralSky(16, d, zenith); });
}

Sky cieTypicalSky(int type, const SunPosition& sun, const SkySetting& setting) {
    const glm::dvec3 direction = directionInWorld({sun.azimuthDeg, sun.altitudeDeg}, setting.northDeg);
    if (!sun.isUp()) return darkSky(direction, setting);
    const Typical& typical = kTypical.at(static_cast<size_t>(type - 1));
    const double extraterrestrial = kExtraterrestrialLux / (sun.earthSunAu * sun.earthSunAu);
    Sky sky = cieGeneralSky(type, direction, 1.0);
    sky.formula.scale *=
        typical.diffuseRatio * extraterrestrial * direction.y / diffuseHorizontalIlluminance(sky);
    sky.sun.direction = direction;
    if (typical.turbidity > 0) {
        const double m = airMass(sun.altitudeDeg);
        sky.sun.normalIlluminance = extraterrestrial * std::exp(-m * typical.turbidity / (9.9 + 0.043 * m));
    }
    lightGround(sky, setting.groundAlbedo);
    return sky;
}

} // namespace heliodon::daylight
