// Colour for pictures: what the sky and the sun look like in linear Rec. 709 (white = D65), as factors whose
// photometric part (geometry/luminance.h) is 1. Multiplying luminances by them changes no lux.
//
// Sky: CIE daylight of a correlated colour temperature. Under a clear sky that follows from the luminance L
// (cd/m2) of the direction, CCT = 6500 K + 1.1985e8 / L^1.2 (Takagi et al. 1990), at most 25000 K; an
// overcast sky has 6500 K everywhere; in between reciprocal temperatures are mixed by the clearness that sun
// and sky show together (Perez's epsilon, with illuminances; 1.2 and below overcast, 4.5 and above clear).
// Typical error against measured skies: 1000 K around the sun, a few thousand in the blue, where 10000 K is a
// barely visible step. Sun: a black body of 5800 K seen through Rayleigh scattering (optical depth 0.008735
// um^-4.08 per air mass, Leckner 1978) and aerosol (beta um^-1.3, Angstrom); colour matching functions as
// fitted by Wyman, Sloan, Shirley 2013.
#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "compute/daylight/sky.h"
#include "compute/daylight/sky_patches.h"

namespace heliodon::daylight {

// Y = 1. A colour outside Rec. 709 is moved towards white until no channel is negative.
glm::dvec3 rgbOfChromaticity(double x, double y);

// CIE D-series illuminant; kelvin is clamped to 4000..25000.
glm::dvec3 daylightColour(double kelvin);

// Apparent altitude of the disc in degrees, taken as at least 0; `turbidity` is Angstrom's beta (clean 0.05,
// hazy 0.2).
glm::dvec3 sunColour(double altitudeDeg, double turbidity = 0.05);

class SkyColour {
public:
    explicit SkyColour(const Sky& sky);             // 0.05 ms
    glm::dvec3 ofLuminance(double luminance) const; // of a direction in the sky, cd/m2
    glm::dvec3 ofSun() const { return sun_; }

private:
    double clear_ = 0; // share: 0 overcast .. 1 clear
    glm::dvec3 sun_{1};
};

// Coloured luminances of all elements from SkyPatches::luminances; the ground is lit by sun and sky together
// and takes their mixed colour. The Y of every element is the luminance given.
std::vector<glm::dvec3> colouredLuminances(const Sky& sky, const SkyPatches& patches,
                                           const std::vector<double>& luminances);

} // namespace heliodon::daylight
