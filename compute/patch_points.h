// Points on patches from which they look into their rooms.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/patch_mesh.h"
#include "shaders/io/hemicube.io.h"

namespace heliodon::compute {

// A point that looks along `normal` (unit) into its room.
struct Viewpoint {
    glm::dvec3 position{0}, normal{0, 1, 0};
    uint32_t patch = io::kHemicubeNoPatch; // the patch that it lies on, which it does not see
    uint32_t room = io::kHemicubeAnyRoom;  // patches of other rooms are not there
    double turn = 0;                       // of the pixel grid about the normal, radians
};

struct PatchViewpoints {
    uint32_t pointsPerPatch = 1;
    std::vector<Viewpoint> viewpoints;
};
// At least `points` for each patch, the next square number, of equal weight (of about equal weight on quads
// that are no parallelograms); one: the centroid. Each pixel grid is turned differently.
PatchViewpoints patchViewpoints(const geometry::PatchMesh& mesh, uint32_t points);
// The same of patches [first, first + count).
PatchViewpoints patchViewpoints(const geometry::PatchMesh& mesh, uint32_t points, uint32_t first,
                                uint32_t count);

// Points of equal weight on a patch, spread so that along any line few lie side by side, as where light ends
// somewhere within it.
std::vector<glm::dvec3> spreadPoints(const geometry::PatchMesh& mesh, size_t patch, uint32_t count);

} // namespace heliodon::compute
