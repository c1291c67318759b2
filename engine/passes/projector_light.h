// What a projector can do: its intensity, and how bright it can make a surface.
#pragma once

#include <vector>

#include "engine/passes/projector_share.h"
#include "geometry/rig.h"

namespace heliodon::passes {

// Candela towards any point of the picture when white is sent: lumens over the picture's solid angle. The
// projector is taken as a point source of even intensity, as in Raskar et al. and the paper (equation
// I = E r^2 / (rho cos theta)).
double fullIntensity(const geometry::Projector& projector);

// What projectors, each giving its share of the picture, can do with the surfaces of the physical model.
struct PaintedPatches {
    double reflectance = 0; // of the surfaces
    double white = 1000; // exitance that is reached on nine tenths of the shown area, lux; 0: none is shown
    std::vector<float> share; // per patch: of its area that some projector sees, 0..1
    std::vector<float> reach; // per patch: exitance there at which the first of its projectors is at its
                              // full; 0 where none sees it
};

PaintedPatches paintedPatches(const geometry::PatchMesh& mesh, const ShownMesh& shown,
                              const geometry::Rig& rig);

} // namespace heliodon::passes
