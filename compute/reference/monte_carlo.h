// Rays of kernel `montecarlo` in serial double precision: the same points, every triangle tried. The oracle
// of shaders/monte_carlo.comp; O(rays x patches).
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/patch_mesh.h"

namespace heliodon::compute::reference {

struct MonteCarloRow {
    std::vector<uint32_t> hits[2]; // of either half of the rays, per patch, on fronts
    uint32_t lost = 0;             // on back sides and into the void
};

// `rays` as MonteCarlo::rays() says.
MonteCarloRow monteCarloRow(const geometry::PatchMesh& mesh, uint32_t row, uint32_t rays);

} // namespace heliodon::compute::reference
