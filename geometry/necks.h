// Where the outline of a room is so narrow that all light from one part of it to the other passes a slot.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/mesh_domains.h"

namespace heliodon::geometry {

// Two edges of one loop of a domain that face one another. To both sides of them the domain has more than
// what lies between them: a recess that ends is no neck, nor is what runs past a wall that stands free.
struct Neck {
    size_t loop, first, second; // the edges that begin at these corners
    double width, length;       // metres: across, and along both
};

// Of domains in one plane; those up to `widest` metres. Edges that curve make a neck for each two of them.
// Cost: the square of the number of edges, and its cube in corridors as narrow as that.
std::vector<Neck> necksOf(const MeshDomain& domain, double widest);

} // namespace heliodon::geometry
