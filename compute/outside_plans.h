// Which surfaces outside of a building reflect light towards its windows, and how near to these each is.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/convex_regions.h"
#include "geometry/bounds.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

// How one region is cut into cells.
struct OutsidePlan {
    struct Target { // that cells send light to
        geometry::Bounds box;
        double least; // metres, length of a cell beside it
    };
    uint32_t region;
    glm::dvec3 normal, u, v;                  // right-handed: u along its longest side, v, normal
    std::vector<const ConvexRegion*> linings; // of an outer side of rooms: what lies in its plane
    std::vector<const ConvexRegion*> glass;   // of these
    std::vector<Target> targets;
    // Of boards close before one another, as louvres are: light between them falls off across their depth,
    // and along them it changes little.
    struct Board {
        double row;    // metres, how wide a cell may be along v
        bool isSquare; // and along u
    };
    std::optional<Board> board;
    double longest(const geometry::Bounds& box) const; // metres, of a cell in the box
};

struct OutsideSurfaces {
    std::span<const ConvexRegion> standing; // materials as groups
    std::span<const ConvexRegion> all;      // these and, after them, the outer sides of rooms
    std::span<const ConvexRegion> linings;  // of those
};

// Of all that are not black, as whose those of `blackStanding` are taken: what stands outside first, then
// outer sides that an opening sees, then those that light one of the former. All outlive the plans.
std::vector<OutsidePlan> outsidePlans(const geometry::PatchMesh& mesh, const OutsideSurfaces& surfaces,
                                      std::span<const ConvexRegion> openings, bool blackStanding);

} // namespace heliodon::compute
