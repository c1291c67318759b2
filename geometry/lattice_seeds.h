// Where the triangles of a polygon will have their inner points, to begin with.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>

#include "geometry/planar_domain.h"

namespace heliodon::geometry {

// How the upright sides of a facet are divided.
struct ColumnSteps {
    // Metres; `width`: of the facet, `edge`: of the triangles elsewhere. `graded`: triangles may be smaller
    // than elsewhere for the sake of angles.
    ColumnSteps(double width, double edge, bool graded);
    double step = 0, longest = 0; // infinity where nothing asks for shorter ones
    bool staggered = false;       // else level with one another, or as it comes
    // Of steps on a side; `steps`: the length in steps of the size wanted.
    double count(double length, double steps) const;
};

struct LatticeSeeds {
    std::vector<glm::dvec2> points; // those on folds first
    uint32_t onFolds = 0;
    // The folds, between neighbouring points of the boundary, which come first, and of `points`.
    std::vector<std::pair<uint32_t, uint32_t>> foldEdges;
};

// Points of a hexagonal lattice of edge length `edge` inside the domain, turned along its direction and
// fitted to its extent, none nearer to the boundary than about half an edge and none where smaller triangles
// are wanted. Where there are folds: upright rows on them and, in wide facets, between, in steps that make
// triangles as large, those beside narrow facets staggered; shorter ones beside short steps of the boundary.
LatticeSeeds latticeSeeds(const PlanarDomain& domain, double edge);

} // namespace heliodon::geometry
