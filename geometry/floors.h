// Which surfaces of rooms are floor, and which of that lies a storey above the rest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/disjoint_sets.h"
#include "geometry/patch_mesh.h"

namespace heliodon::geometry {

// Surfaces that hang together by their corners.
class Shells {
public:
    explicit Shells(const PatchMesh& mesh); // which must outlive this

    uint32_t of(size_t patch) { return shells_.root(mesh_.patch(patch)[0]); }
    // That it encloses; negative where it stands free in a room.
    double volume(size_t patch) { return volume_[of(patch)]; }

private:
    const PatchMesh& mesh_;
    DisjointSets shells_;
    std::vector<double> volume_; // by root
};

// Patches, of each room from the lowest.
struct Floors {
    std::vector<size_t> lowest;
    std::vector<size_t> upper;     // of storeys and galleries that share the air of what is below them
    std::vector<size_t> undecided; // one of each surface that may be a gallery, but for stairs: taken as
                                   // no floor
};

// Floor is what one can walk on: level faces and ramps of the shell that encloses a room (things that stand
// free in it have no floor), the lowest ones and all that rise by no more than 0.25 m (of the building, of
// which one metre is `worldPerBuilding` in the mesh) over what is reached already; so the tops of tables,
// partitions and shelves are none, while those of stairs and low platforms are. Then what stairs lead to, of
// treads that rise by 0.3 m at most (the last one 0.55), whatever they are drawn as, and what is reached
// from it: as large as 1.5 m2 and as wide as 0.6 m, with 2 m of air over it and 2 m beneath, right under its
// slab, in this room or another; over a body without air, 2 m over the floors below and 0.9 m wide. The same
// without stairs is undecided.
Floors findFloors(const PatchMesh& mesh, double worldPerBuilding = 1);

// Height at which a vertical line crosses a patch that is not upright; NaN beside it. `slack`: twice the area
// by which the line may pass outside of an edge.
double heightAt(const PatchMesh& mesh, size_t patch, double x, double z, double slack);

} // namespace heliodon::geometry
