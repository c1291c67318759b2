// Vertices that no patch of a mesh has.
#pragma once

#include "geometry/patch_mesh.h"

namespace heliodon::geometry {

void dropUnusedVertices(PatchMesh& mesh);

} // namespace heliodon::geometry
