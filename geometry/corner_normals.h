// Normals at the corners of patches, by which curved surfaces are smooth.
#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "geometry/patch_mesh.h"

namespace heliodon::geometry {

// Per corner (as PatchMesh::corners), of length one; empty where all surfaces are flat. Facets are what lies
// in one plane of a surface and hangs together. Where two meet the normal is half way between theirs, where
// more do their mean by the angles that they take there (Thuermer and Wuethrich 1998): how facets are divided
// changes nothing. Across a facet whose folds are parallel, as a wall's, it turns evenly from fold to fold,
// and as much again to where the surface ends. Cost: n log n for n corners.
std::vector<glm::dvec3> cornerNormals(const PatchMesh& mesh);

} // namespace heliodon::geometry
