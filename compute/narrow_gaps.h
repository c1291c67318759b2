// Patches that face each other across so little that float32, in which shaders place them, takes both planes
// for one: slabs a micrometre apart in a room. What lies under a neighbour sends it all its light and sees
// nothing else.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/patch_mesh.h"

namespace heliodon::compute {

struct NarrowGaps {
    // Convex, counter-clockwise about the normal of `first`, in its plane; `gap` metres before it lies
    // `second`.
    struct Overlap {
        uint32_t first = 0, second = 0; // patches
        std::vector<glm::dvec3> outline;
        double gap = 0;

        double area() const; // m2
    };
    std::vector<Overlap> overlaps; // no two of one patch cover the same place
    // Of patches that are covered at all: convex parts of what is left of them, perhaps none.
    std::map<uint32_t, std::vector<std::vector<glm::dvec3>>> open;
};

// `plane`: planeNumbers (compute/convex_regions.h). Gaps up to 1e-6 of the mesh's diagonal; what touches, to
// within rounding of doubles, may be both sides of a sheet and has none. Narrower gaps come first: of sheets
// in a pile only the next counts. n log n, and for two planes that lie so the patches of one times those of
// the other.
// `ofFaces`: nor wider than this share of both planes' radii together, for those who place corners from one
// another and so tell smaller faces apart, however large the mesh is.
NarrowGaps narrowGaps(const geometry::PatchMesh& mesh, std::span<const uint32_t> plane,
                      double ofFaces = std::numeric_limits<double>::infinity());

// Of patches in one plane to within such a gap, but no two sheets a gap apart, as of a partition drawn twice and
// a hair askew: where they face each other all the same, with the widest gap there. Patches may be covered more
// than once. Cost: as narrowGaps.
std::vector<NarrowGaps::Overlap> crossedGaps(const geometry::PatchMesh& mesh,
                                             std::span<const uint32_t> plane);

} // namespace heliodon::compute
