// What glass lets through, by direction: a plane slab that absorbs, with every reflection between its two
// faces, unpolarised light (the material `glass` of Radiance). Its one free number, the transmissivity t of a
// single pass at normal incidence, follows from the transmittance Tn that manufacturers state. With r = ((n -
// 1) / (n + 1))^2:
//   t    = (sqrt((1 - r)^4 + 4 r^2 Tn^2) - (1 - r)^2) / (2 r^2 Tn)
//   c2   = sqrt(1 - 1/n^2 + c^2/n^2), c the cosine of the angle of incidence;  d = t^(1/c2)
//   r1   = ((c - n c2) / (c + n c2))^2,  r2 = ((c2 - n c) / (c2 + n c))^2
//   T(c) = 1/2 (1 - r1)^2 d / (1 - r1^2 d^2) + 1/2 (1 - r2)^2 d / (1 - r2^2 d^2)
// A hole (n = 1) passes its Tn from every direction.
#pragma once

#include <glm/vec3.hpp>

#include "geometry/patch_mesh.h"

namespace heliodon::daylight {

// Small enough to be handed to a shader; per linear Rec. 709 channel.
struct Glazing {
    glm::dvec3 transmissivity{1}; // t of a pane, Tn of a hole; [0, 1]
    double refractiveIndex = 1;   // 1: a hole

    bool isHole() const { return refractiveIndex <= 1.0; }
    // For light from either side; 0 at and beyond grazing for a pane. `cosine` in [-1, 1].
    glm::dvec3 transmittance(double cosine) const;
    // For light from all directions alike: integral of T(c) 2 c dc. Accurate to 1e-7.
    glm::dvec3 diffuseTransmittance() const;
};

// From a material's transmittance and refractive index. No glass passes more than maximumTransmittance(n); a
// greater wish gets a pane without absorption.
Glazing glazingOf(const geometry::Material& material);
bool isPossible(const geometry::Material& material);

// (1 - r) / (1 + r): what a pane without absorption passes at normal incidence; 0.9183 for n = 1.52.
double maximumTransmittance(double refractiveIndex);
double transmissivityFromNormal(double normalTransmittance, double refractiveIndex);
double slabTransmittance(double cosine, double transmissivity, double refractiveIndex);
// Of the same slab, by both faces: per polarisation r + r (1 - r)^2 d^2 / (1 - r^2 d^2).
double slabReflectance(double cosine, double transmissivity, double refractiveIndex);

} // namespace heliodon::daylight
