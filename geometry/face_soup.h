// Loose polygons -> a Building that is proven: what closeSketch and importModel end with.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/building.h"
#include "geometry/kept.h"

namespace heliodon::geometry {

struct SoupFace {
    std::vector<std::vector<glm::dvec3>>
        loops; // outline counter-clockwise seen from the air, holes clockwise
    uint32_t material = 0;
    Role role = Role::projection;
    uint32_t surface = 0, room = 0;
    std::optional<uint32_t> behind; // of an open sheet: what its other side is drawn with
    int twinKey = -1; // faces with one key are the pieces of one window, on either side of its wall
};

// Of all its loops, in an order of their own: equal for faces drawn in the same place, whichever way they
// look.
std::vector<std::array<double, 3>> sortedCorners(const SoupFace& face);

// Welds corners of one room that are nearer than `tolerance` (metres) and puts corners that lie on another
// face's edge into that edge. Drops edges and loops that collapse; faces without an outline vanish.
// Pieces of a window become twins of those opposite, with equal corners.
// `sheets`: any number of faces may meet in an edge, looking either way.
Building weldFaces(const std::vector<SoupFace>& soup, uint32_t roomCount, double tolerance,
                   bool sheets = false);

// While one lives, what the thread welded last is kept, and the same faces, to the bit, are not welded again.
using WeldMemory = Memory<Building>;

// The same as sheets of one room, each face's `surface` its place among those given.
Building weldedByNumber(std::vector<SoupFace> faces, double tolerance);

struct ShellProof {
    bool closed = false;            // each directed edge once with its opposite, one fan per vertex
    bool selfIntersecting = false;  // two faces meet other than in common corners and edges
    int euler = 0;                  // V - E + F, a hole of a face counted as minus one
    double volume = 0;              // m3; positive: normals point into the air
    double leastArea = 0;           // m2: of the triangles that the proof is about
    std::vector<uint32_t> badFaces; // those concerned, when a proof fails
};

// One per room. Exact predicates on the stored coordinates. Cost: O(n log n) for n triangles.
std::vector<ShellProof> proveShells(const Building& building);

// Triangles (indices into building.vertices) of a face, by a constrained triangulation; empty when its
// outline is not simple.
std::vector<std::array<uint32_t, 3>> triangulateFace(const Building& building, const Face& face);

} // namespace heliodon::geometry
