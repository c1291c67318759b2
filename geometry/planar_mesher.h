// Uniform triangles in a polygon with holes whose boundary is already sampled.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

namespace heliodon::geometry {

struct PlanarDomain {
    // Boundary points in loops: outline counter-clockwise, holes clockwise.
    std::vector<glm::dvec2> boundary;
    std::vector<uint32_t> loopStart{0}; // loop k is boundary[loopStart[k] .. loopStart[k + 1])
};

// Points of a hexagonal lattice of edge length `edge` inside the domain, turned along its longest straight
// side and fitted to its extent, none nearer to the boundary than about half an edge.
std::vector<glm::dvec2> hexagonalSeeds(const PlanarDomain& domain, double edge);

struct PlanarMesh {
    std::vector<glm::dvec2> points;                 // the boundary's first, then the inner ones
    std::vector<std::array<uint32_t, 3>> triangles; // counter-clockwise
};

// Constrained Delaunay triangulation of boundary and seeds, then `smoothings` rounds of moving inner points
// to the mean of the triangles round them and flipping edges. Throws std::runtime_error when the boundary
// crosses itself.
PlanarMesh meshPlanar(const PlanarDomain& domain, std::vector<glm::dvec2> seeds, int smoothings);

} // namespace heliodon::geometry
