// Vertices along straight borders that cuts beside them can do without.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/flat_part.h"

namespace heliodon::geometry {

// Per vertex of the mesh: whether its parts may be meshed anew without it. The border of each part that it is
// on runs straight through it, between the same two vertices; no line ends in it; and from the last point
// before it to the first one after it, cuts and vertices that stay, it is at most 1.25 times as far as edges
// are long, twice where lines are many.
std::vector<bool> spareVertices(std::span<const FlatPart> parts, const std::vector<glm::dvec3>& vertices);

} // namespace heliodon::geometry
