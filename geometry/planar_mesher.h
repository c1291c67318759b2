// Uniform triangles in a polygon with holes whose boundary is already sampled.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "geometry/planar_net.h"
#include "geometry/size_field.h"

namespace heliodon::geometry {

struct PlanarDomain {
    // Boundary points in loops: outline counter-clockwise, holes clockwise.
    std::vector<glm::dvec2> boundary;
    std::vector<uint32_t> loopStart{0}; // loop k is boundary[loopStart[k] .. loopStart[k + 1])
    glm::dvec2 direction{1, 0};         // of its longest straight side
    SizeField size;                     // of the edges wanted
    bool dividesSlim = true;            // refinement divides slim triangles where sizes are not uniform
};

// Points of a hexagonal lattice of edge length `lattice` inside the domain, turned along its direction
// and fitted to its extent, none nearer to the boundary than about half an edge and none where smaller
// triangles are wanted.
std::vector<glm::dvec2> hexagonalSeeds(const PlanarDomain& domain, double lattice);

struct PlanarMesh {
    std::vector<glm::dvec2> points;                 // the boundary's first, then the inner ones
    std::vector<std::array<uint32_t, 3>> triangles; // counter-clockwise
    size_t added = 0;                               // points, by optimisation
};

// Constrained Delaunay triangulation of boundary and seeds, with further points at circumcentres where
// triangles are too large for the size wanted (Ruppert 1995, boundaries left alone). Throws
// std::runtime_error when the boundary crosses or touches itself.
PlanarNet draftMesh(const PlanarDomain& domain, const std::vector<glm::dvec2>& seeds);

// Inner points move to the mean of the triangles round them, edges flip, and what still has a small angle is
// optimised by itself, with at most `mostAdded` further points.
PlanarMesh improvedMesh(PlanarNet net, const PlanarDomain& domain, size_t mostAdded);

} // namespace heliodon::geometry
