// Uniform triangles in a polygon with holes whose boundary is already sampled.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/vec2.hpp>

#include "geometry/angle_optimiser.h"
#include "geometry/lattice_seeds.h"
#include "geometry/planar_domain.h"
#include "geometry/planar_net.h"

namespace heliodon::geometry {

struct PlanarMesh {
    std::vector<glm::dvec2> points;                 // the boundary's first, then the inner ones
    std::vector<std::array<uint32_t, 3>> triangles; // counter-clockwise
    size_t added = 0;                               // points, by optimisation
    SmallAngles small{};                            // that are left
};

// Constrained Delaunay triangulation of boundary and seeds, with further points at circumcentres where
// triangles are too large for the size wanted (Ruppert 1995, boundaries left alone). None
// where the boundary crosses or touches itself.
std::optional<PlanarNet> draftMesh(const PlanarDomain& domain, const LatticeSeeds& seeds);

// Inner points move to the mean of the triangles round them, edges flip, and what still has a small angle is
// optimised by itself, with at most `mostAdded` further points. Where angles allow, points then move once
// more until areas are even.
PlanarMesh improvedMesh(PlanarNet net, const PlanarDomain& domain, size_t mostAdded);

} // namespace heliodon::geometry
