// Links between clusters where nothing stands between, as shaders/hierarchical_{links,leaves}.comp make them,
// in serial double precision: their oracle.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "compute/patch_tree.h"

namespace heliodon::compute::reference {

// What both nodes exchange per area of either: density * (1 + slopes . (u, v, u', v')), coordinates in
// standard deviations along the axes of the first node and of the second.
struct Link {
    uint32_t first, second;
    double density;
    std::array<double, 4> slopes;
    double error; // of the density, estimated; between two triangles 0
};

// Of all pairs of the tree's roots, each pair at the level where a form factor errs by less than `tolerance`;
// by first and second node. Between two triangles the exchange is that of exchangeUnoccluded.
std::vector<Link> openLinks(const PatchTree& tree, double tolerance);

} // namespace heliodon::compute::reference
