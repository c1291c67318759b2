// Which surfaces of rooms are floor, and which of that lies a storey above the rest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/disjoint_sets.h"
#include "geometry/patch_mesh.h"

namespace heliodon::geometry {

// Metres of the building: that one goes up or down in one, and to stand in.
constexpr double kFloorStep = 0.25, kHeadroom = 2;

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
    std::vector<size_t> lowest;    // over no other floor of its room: main floors, pits, stages, stairs
    std::vector<size_t> upper;     // of storeys and galleries that share the air of what is below them
    std::vector<size_t> undecided; // one of each surface that may be a gallery or a stage: taken as no floor
};

// Floor is what one can walk on: level faces, and ramps up to 14 degrees, of the shell that encloses a room
// (things that stand free in it have no floor), as decks: what hangs together by its edges or lies beside it
// within a step of 0.25 m (of the building, of which one metre is `worldPerBuilding` in the mesh). So the
// tops of tables, partitions and shelves are none (a bookcase's lowest, too, over floor and without
// headroom), while those of stairs and low platforms are.
// - The lowest deck of 1.5 m2, 0.6 m wide, with 2 m of air over it; the lowest of all where none is.
// - Main floors over pits: larger than all floor below, or all round it with nothing beneath, as round
//   a pool; 6 m2, 0.9 m wide, walls along 40 % of their border.
//   So are all that lie at one height if they are 1.25 times as large, with walls along 52 %; where these
//   have less than 6 m2 they are undecided.
// - Stages less than 2 m over floor: 6 m2 and 1.8 m wide; above 0.6 m with walls along 20 %, above 1.2 m
//   along 52 %. Two or more terraces of 4 m2, 0.75 m wide, that rise along one another, likewise.
// - What stairs lead to, of treads that rise by 0.3 m at most (the last one 0.55), whatever they are drawn
//   as: stages of 4 m2, 1.4 m wide; and what has 1.5 m2, is 0.6 m wide, has 2 m of air over it, and 2 m
//   beneath right under its slab, in this room or another, or is 2 m over the floor beside it and 0.9 m wide.
//   Without stairs this is undecided, but for small stages that are as low and small as beds, or stand free
//   and are no wider than tables.
Floors findFloors(const PatchMesh& mesh, double worldPerBuilding = 1);

} // namespace heliodon::geometry
