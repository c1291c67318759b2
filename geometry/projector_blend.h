// What share of the light each projector has at each vertex.
#pragma once

#include <span>

#include <glm/vec3.hpp>

#include "geometry/projector_visibility.h"

namespace heliodon::geometry {

// Fills `weights`. A projector counts at a vertex when it sees every reachable triangle of the surface round
// it; it fades in over `falloff` metres from the vertices where it does not, and counts for more where its
// light falls steeper. Where no projector sees all triangles round a vertex, the vertex is doubled.
// `normals`: per triangle.
void blendProjectors(ProjectorMesh& mesh, std::span<const OpticalDevice> projectors,
                     std::span<const glm::dvec3> normals, double falloff);

} // namespace heliodon::geometry
