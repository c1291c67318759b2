#include "compute/daylight/sky_colour.h"

#include <algorithm>
#include <cmath>

#include "compute/daylight/frame.h"
#include "geometry/luminance.h"

namespace heliodon::daylight {

namespace {

constexpr double kOvercastKelvin = 6500, kBluestKelvin = 25000;

// One lobe of Wyman, Sloan, Shirley's fits: a Gaussian with different widths on its two sides; nanometres.
double lobe(double wavelength, double centre, double below, double above) {
    const double t = (wavelength - centre) * (wavelength < centre ? below : above);
    return std::exp(-0.5 * t * t);
}

glm::dvec3 colourMatching(double nm) {
    return {0.362 * lobe(nm, 442.0, 0.0624, 0.0374) + 1.056 * lobe(nm, 599.8, 0.0264, 0.0323) -
                0.065 * lobe(nm, 501.1, 0.0490, 0.0382),
            0.821 * lobe(nm, 568.8, 0.0213, 0.0247) + 0.286 * lobe(nm, 530.9, 0.0613, 0.0322),
            1.217 * lobe(nm, 437.0, 0.0845, 0.0278) + 0.681 * lobe(nm, 459.0, 0.0385, 0.0725)};
}

// Relative; second radiation constant 0.014388 m K.
double blackBody(double nm, double kelvin) {
    const double um = nm * 1e-3;
    return std::pow(um, -5.0) / (std::exp(14388.0 / (um * kelvin)) - 1.0);
}

double clearnessOf(const Sky& sky) {
    const double diffuse = diffuseHorizontalIlluminance(sky);
    if (diffuse <= 0) return 1;
    const double zenith = std::acos(std::clamp(sky.sun.direction.y, 0.0, 1.0));
    const double cube = 1.041 * zenith * zenith * zenith;
    return ((diffuse + sky.sun.normalIlluminance) / diffuse + cube) / (1.0 + cube);
}

} // namespace

glm::dvec3 rgbOfChromaticity(double x, double y) {
    const double bigX = x / y, bigZ = (1.0 - x - y) / y;
    glm::dvec3 rgb{3.2404542 * bigX - 1.5371385 - 0.4985314 * bigZ,
                   -0.9692660 * bigX + 1.8760108 + 0.0415560 * bigZ,
                   0.0556434 * bigX - 0.2040259 + 1.0572252 * bigZ};
    rgb /= geometry::photometric(rgb); // the matrix is rounded
    const double least = std::min({rgb.x, rgb.y, rgb.z});
    if (least < 0) rgb = glm::dvec3(1.0) + (rgb - glm::dvec3(1.0)) / (1.0 - least);
    return rgb;
}

glm::dvec3 daylightColour(double kelvin) {
    const double t = std::clamp(kelvin, 4000.0, kBluestKelvin);
    const double u = 1e3 / t;
    const double x = t <= 7000 ? 0.244063 + u * (0.09911 + u * (2.9678 - u * 4.6070))
                               : 0.237040 + u * (0.24748 + u * (1.9018 - u * 2.0064));
    return rgbOfChromaticity(x, -3.000 * x * x + 2.870 * x - 0.275);
}

glm::dvec3 sunColour(double altitudeDeg, double turbidity) {
    const double h = std::max(0.0, altitudeDeg);
    const double airMass = 1.0 / (std::sin(radians(h)) + 0.50572 * std::pow(h + 6.07995, -1.6364));
    glm::dvec3 sum(0.0);
    for (double nm = 382.5; nm < 780; nm += 5) {
        const double um = nm * 1e-3;
        const double depth = 0.008735 * std::pow(um, -4.08) + turbidity * std::pow(um, -1.3);
        sum += blackBody(nm, 5800.0) * std::exp(-airMass * depth) * colourMatching(nm);
    }
    const double all = sum.x + sum.y + sum.z;
    return rgbOfChromaticity(sum.x / all, sum.y / all);
}

SkyColour::SkyColour(const Sky& sky) {
    // A smooth step over the logarithm of the clearness.
    const double t = std::clamp(std::log(clearnessOf(sky) / 1.2) / std::log(4.5 / 1.2), 0.0, 1.0);
    clear_ = t * t * (3.0 - 2.0 * t);
    if (sky.hasSun()) sun_ = sunColour(degrees(std::asin(std::clamp(sky.sun.direction.y, -1.0, 1.0))));
}

glm::dvec3 SkyColour::ofLuminance(double luminance) const {
    const double clearKelvin =
        std::min(kBluestKelvin, kOvercastKelvin + 1.1985e8 / std::pow(std::max(luminance, 1.0), 1.2));
    return daylightColour(1.0 / ((1.0 - clear_) / kOvercastKelvin + clear_ / clearKelvin));
}

std::vector<glm::dvec3> colouredLuminances(const Sky& sky, const SkyPatches& patches,
                                           const std::vector<double>& luminances) {
    const SkyColour colour(sky);
    std::vector<glm::dvec3> coloured(luminances.size());
    glm::dvec3 onGround = directHorizontalIlluminance(sky) * colour.ofSun();
    for (size_t i = 0; i < patches.patchCount(); ++i) {
        coloured[i] = luminances[i] * colour.ofLuminance(luminances[i]);
        onGround += patches.projectedSolidAngle(i) * coloured[i];
    }
    const double onGroundLux = geometry::photometric(onGround);
    const double ground = luminances[patches.groundElement()];
    coloured[patches.groundElement()] =
        onGroundLux > 0 ? ground / onGroundLux * onGround : glm::dvec3(ground);
    return coloured;
}

} // namespace heliodon::daylight
