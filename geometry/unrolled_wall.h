// Curved walls as one sheet: a line across many facets then needs no points where it crosses their edges.
#pragma once

#include <vector>

#include "geometry/flat_part.h"

namespace heliodon::geometry {

// The parts of `mesh`, those of each upright curved wall joined to sheets in the plane of its length and
// height. Facets that do not fit, as where a ring closes, stay as they are.
std::vector<FlatPart> unrollWalls(std::vector<FlatPart> parts, const PatchMesh& mesh);

// What the facets of a sheet are cut along becomes its own.
void unrollCuts(FlatPart& sheet);

} // namespace heliodon::geometry
