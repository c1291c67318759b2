// Other programs' form factors on the same scene in the same run: what a bench is compared with.
#pragma once

#include <string>
#include <vector>

#include "geometry/patch_mesh.h"

namespace heliodon::app {

struct PeerResult {
    std::vector<float> factors; // patches x patches
    double wallSeconds = 0, cpuSeconds = 0;
    double rays = 0; // shot; 0 where none are
};

// Embree 3, all cores, packets of sixteen rays; false where the library was not found at configure time.
bool hasEmbree();
// One hemicube of resolution^2 at each patch's middle: the rays of our kernel `hemicube`.
PeerResult embreeHemicube(const geometry::PatchMesh& mesh, uint32_t resolution);
// Halton points, cosine-distributed rays; both measurements of a pair combined as A_i F_ij = A_j F_ji.
PeerResult embreeRays(const geometry::PatchMesh& mesh, uint32_t raysPerPatch);

// View3D (G. N. Walton, NISTIR 6925, 2002), where the program `View3D` or `view3d` is on the PATH; empty
// otherwise.
std::string findView3d();
// Runs it on the mesh's triangles, whose backs do not block there: compare on closed scenes. Throws when it
// fails.
PeerResult view3d(const std::string& program, const geometry::PatchMesh& mesh, double epsilon);

} // namespace heliodon::app
