// What of a model hangs together by edges and is closed.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "geometry/building.h"
#include "geometry/disjoint_sets.h"
#include "geometry/ray_triangle.h"

namespace heliodon::geometry {

// Faces by common edges: where more than two meet in one, each with the next one by its place in the file, as
// bodies are written one after another. Those of boards made of sheets are not: of these, each with its own.
DisjointSets hangingTogether(const Building& welded, const std::function<uint32_t(uint32_t)>& place,
                             const std::function<bool(uint32_t)>& isOfBoard);

struct ClosedPiece {
    std::vector<uint32_t> faces;          // Face::surface of each
    std::vector<bool> turned;             // per face: against how it is drawn, so that all look one way
    std::vector<ShellTriangle> triangles; // of those turned so
    bool looksIn = false;                 // as they then do: the way of most of the area
    double seams = 0;                     // of its edges, the part with a turned face and one that is not
    double area = 0, turnedArea = 0;      // square metres: of all, and of those turned
};

// Of sheets (weldFaces()), by hangingTogether(). Pieces where that leaves edges of more than two faces are
// none.
std::vector<ClosedPiece> closedPieces(const Building& sheets);

} // namespace heliodon::geometry
