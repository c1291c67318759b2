// R. Perez, R. Seals, J. Michalsky: All-weather model for sky luminance distribution. Solar Energy 50(3),
// 1993 (shape). R. Perez, P. Ineichen, R. Seals, J. Michalsky, R. Stewart: Modeling daylight availability and
// irradiance components from direct and global irradiance. Solar Energy 44(5), 1990 (clearness, brightness,
// efficacies).
#include <algorithm>
#include <array>
#include <cmath>

#include "compute/daylight/frame.h"
#include "compute/daylight/sky.h"

namespace heliodon::daylight {

namespace {

constexpr double kSolarConstant = 1367.0; // W/m2
constexpr double kMaxClearness = 11.9, kMinBrightness = 0.01, kMaxBrightness = 0.6;

// Upper bounds of the clearness bins; the last is open.
constexpr std::array<double, 7> kBinEnds{1.065, 1.23, 1.5, 1.95, 2.8, 4.5, 6.2};

// 1993, table 1: a1..a4, b1..b4, c1..c4, d1..d4, e1..e4 per bin.
constexpr double kShape[8][5][4] = {
    {{1.3525, -0.2576, -0.2690, -1.4366},
     {-0.7670, 0.0007, 1.2734, -0.1233},
     {2.8000, 0.6004, 1.2375, 1.0000},
     {1.8734, 0.6297, 0.9738, 0.2809},
     {0.0356, -0.1246, -0.5718, 0.9938}},
    {{-1.2219, -0.7730, 1.4148, 1.1016},
     {-0.2054, 0.0367, -3.9128, 0.9156},
     {6.9750, 0.1774, 6.4477, -0.1239},
     {-1.5798, -0.5081, -1.7812, 0.1080},
     {0.2624, 0.0672, -0.2190, -0.4285}},
    {{-1.1000, -0.2515, 0.8952, 0.0156},
     {0.2782, -0.1812, -4.5000, 1.1766},
     {24.7219, -13.0812, -37.7000, 34.8438},
     {-5.0000, 1.5218, 3.9229, -2.6204},
     {-0.0156, 0.1597, 0.4199, -0.5562}},
    {{-0.5484, -0.6654, -0.2672, 0.7117},
     {0.7234, -0.6219, -5.6812, 2.6297},
     {33.3389, -18.3000, -62.2500, 52.0781},
     {-3.5000, 0.0016, 1.1477, 0.1062},
     {0.4659, -0.3296, -0.0876, -0.0329}},
    {{-0.6000, -0.3566, -2.5000, 2.3250},
     {0.2937, 0.0496, -5.6812, 1.8415},
     {21.0000, -4.7656, -21.5906, 7.2492},
     {-3.5000, -0.1554, 1.4062, 0.3988},
     {0.0032, 0.0766, -0.0656, -0.1294}},
    {{-1.0156, -0.3670, 1.0078, 1.4051},
     {0.2875, -0.5328, -3.8500, 3.3750},
     {14.0000, -0.9999, -7.1406, 7.5469},
     {-3.4000, -0.1078, -1.0750, 1.5702},
     {-0.0672, 0.4016, 0.3017, -0.4844}},
    {{-1.0000, 0.0211, 0.5025, -0.5119},
     {-0.3000, 0.1922, 0.7023, -1.6317},
     {19.0000, -5.0000, 1.2438, -1.9094},
     {-4.0000, 0.0250, 0.3844, 0.2656},
     {1.0468, -0.3788, -2.4517, 1.4656}},
    {{-1.0500, 0.0289, 0.4260, 0.3590},
     {-0.3250, 0.1156, 0.7781, 0.0025},
     {31.0625, -14.5000, -46.1148, 55.3750},
     {-7.2312, 0.4050, 13.3500, 0.6234},
     {1.5000, -0.6426, 1.8564, 0.5636}},
};

// 1990, table 4, diffuse: a, b, c, d per bin, lm/W.
constexpr double kDiffuseEfficacy[8][4] = {
    {97.24, -0.46, 12.0, -8.91},   {107.22, 1.15, 0.59, -3.95},    {104.97, 2.96, -5.53, -8.77},
    {102.39, 5.59, -13.95, -13.9}, {100.71, 5.94, -22.75, -23.74}, {106.42, 3.83, -36.15, -28.83},
    {141.88, 1.9, -53.24, -14.03}, {152.23, 0.35, -45.27, -7.98},
};

// 1990, table 4, direct.
constexpr double kDirectEfficacy[8][4] = {
    {57.2, -4.55, -2.98, 117.12},  {98.99, -3.46, -1.21, 12.38},  {109.83, -4.9, -1.71, -8.81},
    {110.34, -5.84, -1.99, -4.56}, {106.36, -3.97, -1.75, -6.16}, {107.19, -1.25, -1.51, -26.73},
    {105.75, 0.77, -1.26, -34.44}, {101.18, 1.58, -1.1, -8.29},
};

size_t clearnessBin(double clearness) {
    return static_cast<size_t>(std::upper_bound(kBinEnds.begin(), kBinEnds.end(), clearness) -
                               kBinEnds.begin());
}

// F. Kasten, A new table and approximate formula for relative optical air mass, 1965; zenith angle at most 90
// degrees.
double airMass(double zenithRadians) {
    return 1.0 / (std::cos(zenithRadians) + 0.15 * std::pow(93.885 - degrees(zenithRadians), -1.253));
}

} // namespace

PerezShape perezShape(double clearness, double brightness, double zenith) {
    if (clearness > 1.065 && clearness < 2.8) brightness = std::max(brightness, 0.2);
    const size_t bin = clearnessBin(clearness);
    const auto& k = kShape[bin];
    const auto linear = [&](const double(&x)[4]) {
        return x[0] + x[1] * zenith + brightness * (x[2] + x[3] * zenith);
    };
    PerezShape s{linear(k[0]), linear(k[1]), linear(k[2]), linear(k[3]), linear(k[4])};
    if (bin == 0) {
        s.c = std::exp(std::pow(brightness * (k[2][0] + k[2][1] * zenith), k[2][2])) - k[2][3];
        s.d = -std::exp(brightness * (k[3][0] + k[3][1] * zenith)) + k[3][2] + brightness * k[3][3];
    }
    return s;
}

double precipitableWaterCm(double dewPointC) {
    return std::exp(0.07 * dewPointC - 0.075);
}

Sky skyFromIrradiance(const Irradiance& irradiance, const SunPosition& sun, const SkySetting& setting) {
    const glm::dvec3 direction = directionInWorld({sun.azimuthDeg, sun.altitudeDeg}, setting.northDeg);
    Sky sky;
    sky.model = "perez";
    sky.shapeDirection = sky.sun.direction = direction;
    sky.ground.albedo = setting.groundAlbedo;
    const double diffuse = std::max(0.0, irradiance.diffuseHorizontal);
    const double direct = sun.isUp() ? std::max(0.0, irradiance.directNormal) : 0.0;
    if (diffuse + direct < 1e-4 || sun.altitudeDeg < kTwilightDeg) return sky;

    const double shapeAltitude = std::max(0.0, sun.altitudeDeg);
    const double zenith = radians(90.0 - shapeAltitude);
    // Without diffuse light the clearness is unbounded; its limit is the clearest bin.
    const double cube = 1.041 * zenith * zenith * zenith;
    const double clearness =
        std::clamp(((diffuse + direct) / std::max(diffuse, 1e-9) + cube) / (1.0 + cube), 1.0, kMaxClearness);
    const double extraterrestrial = kSolarConstant / (sun.earthSunAu * sun.earthSunAu);
    const double brightness =
        std::clamp(diffuse * airMass(zenith) / extraterrestrial, kMinBrightness, kMaxBrightness);

    const size_t bin = clearnessBin(clearness);
    const double water = setting.precipitableWaterCm;
    const auto& kd = kDiffuseEfficacy[bin];
    const auto& kb = kDirectEfficacy[bin];
    const double diffuseLux = diffuse * std::max(0.0, kd[0] + kd[1] * water + kd[2] * std::cos(zenith) +
                                                          kd[3] * std::log(brightness));
    const double directLux =
        direct *
        std::max(0.0, kb[0] + kb[1] * water + kb[2] * std::exp(5.73 * zenith - 5.0) + kb[3] * brightness);

    const glm::dvec3 shapeDirection =
        sun.isUp() ? direction : directionInWorld({sun.azimuthDeg, 0.0}, setting.northDeg);
    sky = perezSky(perezShape(clearness, brightness, zenith), shapeDirection, 1.0);
    const double unit = diffuseHorizontalIlluminance(sky);
    if (unit > 1e-6) {
        sky.formula.scale = diffuseLux / unit;
    } else {
        // The fit is negative everywhere (out of its range): spread the light evenly.
        sky = cieGeneralSky(5, shapeDirection, diffuseLux / kPi);
        sky.model = "perez (degenerate: uniform)";
    }
    sky.sun = {direction, directLux};
    // As lightGround, without a second integral.
    const double global = diffuseLux + directLux * std::max(0.0, direction.y);
    sky.ground = {setting.groundAlbedo, setting.groundAlbedo * global / kPi};
    return sky;
}

} // namespace heliodon::daylight
