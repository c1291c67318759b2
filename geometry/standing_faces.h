// What hides surfaces of a model from projectors, where no wall with thickness is known: its own faces.
#pragma once

#include <span>
#include <vector>

#include "geometry/flat_part.h"
#include "geometry/shadow_outline.h"

namespace heliodon::geometry {

// The parts (of flatParts) as flat solids, few to a part: all but those that look down. Ceilings and roofs do
// not stand on the table: projectors look in from above. `at`: the vertices of the mesh.
std::vector<ConvexSolid> standingFaces(std::span<const FlatPart> parts, const std::vector<glm::dvec3>& at);

} // namespace heliodon::geometry
