// Normals at the corners of patches, by which curved surfaces are smooth.
#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "geometry/patch_mesh.h"

namespace heliodon::geometry {

// Per corner (as PatchMesh::corners), of length one; empty where all surfaces are flat. Facets are what lies
// in one plane of a surface and hangs together. Where two meet the normal is half way between theirs, where
// more do their mean by the angles that they take there (Thuermer and Wuethrich 1998): how facets are divided
// changes nothing. Where the folds of facets are parallel, as a wall's, normals are those of the arc that the
// facets are chords of: one next to a facet up to twice as wide turns less, and where the surface ends they
// go on turning as before unless the last facet lies off such an arc. Across a facet they turn evenly. Cost:
// n log n for n corners.
std::vector<glm::dvec3> cornerNormals(const PatchMesh& mesh);

} // namespace heliodon::geometry
