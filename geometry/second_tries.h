// Domains meshed anew, of lattices a little finer or coarser, where angles stay small: which ones do is much
// a matter of chance.
#pragma once

#include "geometry/planar_mesher.h"

namespace heliodon::geometry {

class SecondTries {
public:
    // `most`: triangles to be meshed again in all, as that takes time.
    explicit SecondTries(double most) : most_(most) {}

    // How many triangles a domain may have.
    struct Range {
        double least, most;
    };
    // The first mesh or, where it has angles under 36 degrees that other points may mend, the best one.
    PlanarMesh best(PlanarMesh first, const PlanarDomain& domain, size_t mostAdded, Range range);

private:
    double most_;
};

} // namespace heliodon::geometry
