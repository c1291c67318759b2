// What a projector can do: its intensity, and how bright it can make a surface.
#pragma once

#include "engine/passes/projector_share.h"
#include "geometry/rig.h"

namespace heliodon::passes {

// Candela towards any point of the picture when white is sent: lumens over the picture's solid angle. The
// projector is taken as a point source of even intensity, as in Raskar et al. and the paper (equation
// I = E r^2 / (rho cos theta)).
double fullIntensity(const geometry::Projector& projector);

// Exitance (lux) that the rig reaches on nine tenths of the shown area, each projector giving its share of
// the picture; 0 when nothing is shown.
double reachableExitance(const ShownMesh& shown, const geometry::Rig& rig, double surfaceReflectance);

} // namespace heliodon::passes
