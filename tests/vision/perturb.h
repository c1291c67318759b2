// The same table as another camera, lamp or paint box would show it.
#pragma once

#include "geometry/rig.h"
#include "vision/photograph.h"

namespace heliodon::vision {

struct Perturbation {
    double gamma = 2.2;          // of the file
    double gain[3] = {1, 1, 1};  // of the channels, in linear light
    double blurPx = 0;           // Gaussian, standard deviation
    double electronsAtWhite = 0; // photon noise; 0: none
    double readNoise = 0;        // electrons
    double hueDegrees = 0;       // turn of every saturated colour, in linear light
    int jpegQuality = 0;         // 0: not compressed
    unsigned seed = 1;
};

Photograph perturbed(const Photograph& photo, const Perturbation& how);

// As the same camera sees it turned by these angles (degrees, about x, y and z of the camera) with another
// lens; the rig's camera follows. Exact, since nothing parallactic moves.
Photograph rephotographed(const Photograph& photo, geometry::Rig& rig, const double (&turnDegrees)[3],
                          const geometry::Lens& lens);

} // namespace heliodon::vision
