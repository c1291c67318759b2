// The sky as light: luminance by direction (cd/m2), the sun's disc as a point, and the ground below the
// horizon. All directions are in world axes, y up, unit length (frame.h turns compass angles and model axes
// into them).
#pragma once

#include <filesystem>
#include <string>

#include <glm/vec3.hpp>

#include "compute/daylight/sun_position.h"
#include "geometry/model_file.h"

namespace heliodon::daylight {

// A sky's luminance in closed form, small enough to be handed to a shader. With z = direction.y > 0, s = the
// sun's height shape direction's y, g = angle to the sun's shape direction in radians:
//   separable:    L = scale * max(0, (g0 + g1 z + a exp(b / max(z, zFloor))) * (i0 + c exp(d g) + e cos^2 g))
//   intermediate: L = scale * ((1.35 sin(5.631 - 3.59 n) + 3.12) sin(4.396 - 2.6 t) + 6.37 - n) / 2.326
//                     * exp(-0.563 g ((2.629 - n)(1.562 - t) + 0.812)),  n = acos z, t = acos s
struct SkyFormula {
    double scale = 0; // cd/m2; 0 is a black sky
    double g0 = 1, g1 = 0, a = 0, b = -1, zFloor = 1e-30;
    double i0 = 1, c = 0, d = 0, e = 0;
    bool intermediate = false;
};
// The two factors of a separable formula, by z and by the cosine of g.
double gradation(const SkyFormula& formula, double z);
double indicatrix(const SkyFormula& formula, double cosine);
// cd/m2 of both together, the gradation known.
double luminance(const SkyFormula& formula, double gradation, double cosine);

struct SunDisc {
    glm::dvec3 direction{0, 1, 0};
    double normalIlluminance =
        0; // lux on a surface that faces it; 0 when it is not there or below the horizon
};

struct Ground {
    double albedo = 0.2;  // diffuse reflectance, [0, 1]
    double luminance = 0; // cd/m2, uniform
};

struct Sky {
    std::string model = "dark"; // for reports: "cie_clear", "perez", ...
    SkyFormula formula;
    glm::dvec3 shapeDirection{0, 1,
                              0}; // the sun that the distribution is built round; also where no disc is seen
    SunDisc sun;
    Ground ground;

    // cd/m2; the formula for direction.y > 0, else the ground's. About 30 ns.
    double luminance(glm::dvec3 direction) const;
    bool hasSun() const { return sun.normalIlluminance > 0; }
    bool isDark() const { return formula.scale <= 0 && !hasSun() && ground.luminance <= 0; }
};

// Integrals over the sky's half of the sphere on a horizontal plane, lux; relative error under 1e-5 for every
// formula here (measured; the published tables themselves carry up to 1e-4). About 0.05 ms.
double diffuseHorizontalIlluminance(const Sky& sky);
double directHorizontalIlluminance(const Sky& sky); // sun only
double globalHorizontalIlluminance(const Sky& sky); // both

// Sets the ground's albedo and its luminance, albedo * E_global / pi.
void lightGround(Sky& sky, double albedo);

// ---- Distributions: formula and shape direction only, no sun and no ground ----

// CIE S 011 / ISO 15469 types 1..15; 16 is the traditional overcast sky (Moon and Spencer), L = Lz (1 + 2 z)
// / 3.
Sky cieGeneralSky(int type, glm::dvec3 sunDirection, double zenithLuminance);
// CIE 1973 clear sky, L = Lz (0.91 + 10 exp(-3 g) + 0.45 cos^2 g)(1 - exp(-0.32 / z)) / norm. norm = 0 takes
// the value that makes the zenith's luminance exactly Lz.
Sky cieClearSky(glm::dvec3 sunDirection, double zenithLuminance, double norm = 0);
Sky cieIntermediateSky(glm::dvec3 sunDirection, double zenithLuminance);

// Perez, Seals, Michalsky 1993: L = A (1 + a exp(b / max(z, 0.01)))(1 + c exp(d g) + e cos^2 g).
struct PerezShape {
    double a = 0, b = 0, c = 0, d = 0, e = 0;
};
// From clearness epsilon >= 1, brightness delta > 0 and the sun's zenith angle. delta counts as at least 0.2
// for 1.065 < epsilon < 2.8, outside the fit's range (the guard that Radiance has).
PerezShape perezShape(double clearness, double brightness, double sunZenithRadians);
Sky perezSky(const PerezShape& shape, glm::dvec3 sunDirection, double scale);

// ---- Skies with everything set: distribution, sun, ground ----

struct SkySetting {
    double northDeg = 90; // of the plan, see frame.h
    double groundAlbedo = 0.2;
    double turbidity = 2.45;        // of the clear and intermediate skies
    double precipitableWaterCm = 2; // Perez efficacies; precipitableWaterCm(dew point) where that is known
};

// The skies of Radiance's gensky, in Radiance's lux: zenith luminance (kcd/m2, h the sun's apparent altitude)
//   clear:        Lz = (1.376 turbidity - 1.81) tan h + 0.38         (h at most 87 degrees)
//   overcast:     Lz = 8.6 sin h + 0.123
//   intermediate: the mean of the two,
// times 179/203; sun of normal illuminance 1.5e9 cd/m2 * (1.147 - 0.147 / max(sin h, 0.16)) over the disc of
// 0.5 degrees, times 179/208; 15 % of it under the intermediate sky, none under the overcast. (Radiance
// writes radiance with 203 and 208 lm/W and reads it back with 179: the factors keep our numbers comparable
// with it.) Dark when the sun is down.
Sky clearSky(const SunPosition& sun, const SkySetting& setting = {});
Sky intermediateSky(const SunPosition& sun, const SkySetting& setting = {});
Sky overcastSky(const SunPosition& sun, const SkySetting& setting = {});

// CIE general sky in absolute terms after Darula and Kittler, CIE General Sky Standard Defining Luminance
// Distributions (eSim 2002): horizontal diffuse illuminance = (Dv/Ev) * 133.8 klx * sin h / R^2 with the
// type's typical ratio; sun by the type's typical luminous turbidity Tv, 133.8 klx / R^2 * exp(-m Tv / (9.9 +
// 0.043 m)), m the air mass of Kasten and Young 1989; no sun for types 1 to 6. Plain photometric lux. Dark
// when the sun is down.
Sky cieTypicalSky(int type, const SunPosition& sun, const SkySetting& setting = {});

struct Irradiance {
    double directNormal = 0;      // W/m2
    double diffuseHorizontal = 0; // W/m2
};
// Perez all-weather sky with the luminous efficacies of Perez et al. 1990 (Solar Energy 44(5)), its diffuse
// horizontal illuminance exactly that of the efficacy model. Solar constant 1367 W/m2, air mass of Kasten
// 1965; epsilon is kept in [1, 11.9] and delta in [0.01, 0.6], the range of the fit. With the sun down there
// is no direct light, and the diffuse light is distributed as if the sun stood on the horizon (twilight);
// below kTwilightDeg the sky is dark.
inline constexpr double kTwilightDeg = -6;
Sky skyFromIrradiance(const Irradiance& irradiance, const SunPosition& sun, const SkySetting& setting = {});
double precipitableWaterCm(double dewPointC); // exp(0.07 Td - 0.075), same paper

// ---- From the command line ----

// `clear | overcast | intermediate | cie:1..15 | perez:DNI,DHI | FILE.json`. Throws InputError("--sky", ...),
// or as readSky. A sky file ignores sun and setting.
Sky skyFromOption(const std::string& option, const SunPosition& sun, const SkySetting& setting,
                  geometry::UpAxis fileAxes = geometry::UpAxis::z);
// Whether the option depends on time and place; a file does not.
bool skyDependsOnTime(const std::string& option);

// `vh-sky/1`: model cie_overcast {zenith_luminance_cdm2} | cie_clear {Lz_cdm2, norm} | perez {A_cdm2, abcde}
// | cie_general {type: 1 to 16, zenith_luminance_cdm2}, sun_direction (of the shape), sun {direction,
// normal_illuminance_lux}, ground {albedo, luminance_cdm2}. Directions are in the model's axes, `axes` says
// which of them is up. Without `ground`, albedo 0.2; an albedo without luminance gets albedo * E_global / pi.
// Throws InputError(file, field, ...).
Sky readSky(const std::filesystem::path& file, geometry::UpAxis axes = geometry::UpAxis::z);

} // namespace heliodon::daylight
