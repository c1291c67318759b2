// Light that the physical model throws from one of its surfaces to another while projectors paint it. It
// comes on top of what is painted and washes shadows out; what projectors leave out for it is worked out
// here, from the form factors of the room that stands for the model. After O. Bimber et al., "Compensating
// Indirect Scattering for Immersive and Semi-Immersive Projection Displays" (2006): what is painted is P = W
// - S, with W the wanted exitance and S = rho F B what the surfaces send back of the exitance B that they
// have. Where W < S nothing can be painted and B = S > W, which adds to the scatter elsewhere: B = max(W, rho
// F B), found by repeating it. Ceilings and whatever else is inferred only are not there and send nothing
// back; light from outside the rooms is left out.
#pragma once

#include <vector>

#include "compute/form_factor_operator.h"
#include "compute/lighting.h"
#include "engine/passes/projector_light.h"
#include "geometry/patch_mesh.h"

namespace heliodon::passes {

struct ScatterReport {
    double ownShare = 0;    // of the light on painted surfaces, what comes from the model itself
    double error = 0;       // RMS over painted area of the exitance that is too much or too little, over the
                            // mean wanted; what is too little only for want of bright projectors is none
    double errorBefore = 0; // the same when nothing is left out; only where asked for
    double tooBright = 0;   // share of the painted area that has too much even where nothing is painted
    int passes = 0;         // over the form factors
};

// Sets `light.ownScatter`, lux of the simulation, which shows `whiteLux` as white. Light is taken for even
// over what of a patch the sun reaches, and over the rest. Nothing is left out where nothing is painted.
// Cost: two passes over F where no place is too bright, about five in a room with sun; 20 to 30 more for
// `compare`.
ScatterReport leaveOutScatter(const geometry::PatchMesh& mesh, const PaintedPatches& painted, double whiteLux,
                              compute::FormFactorOperator& factors, bool compare, compute::Lighting& light);

} // namespace heliodon::passes
