// Direct sun on a patch by brute force: rays from an even grid of points on the patch. The oracle of
// SunPatches.
#pragma once

#include <glm/vec3.hpp>

#include "geometry/patch_mesh.h"

namespace heliodon::compute::reference {

// Mean over `samples` points of cosine times transmittance of what a ray towards the sun passes.
glm::dvec3 sunOnPatch(const geometry::PatchMesh& mesh, size_t patch, glm::dvec3 towardsSun, uint32_t samples);

} // namespace heliodon::compute::reference
