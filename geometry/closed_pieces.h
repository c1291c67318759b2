// What of a model hangs together by edges and is closed.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/building.h"
#include "geometry/ray_triangle.h"

namespace heliodon::geometry {

struct ClosedPiece {
    std::vector<uint32_t> faces;          // Face::surface of each
    std::vector<bool> turned;             // per face: against how it is drawn, so that all look one way
    std::vector<ShellTriangle> triangles; // of those turned so
    bool looksIn = false;                 // as they then do: the way of most of the area
    double seams = 0;                     // of its edges, the part with a turned face and one that is not
    double area = 0, turnedArea = 0;      // square metres: of all, and of those turned
};

// Of sheets (weldFaces()); where more than two faces meet in an edge each hangs together with the next one by
// Face::surface, as bodies are written one after another. Pieces where that leaves such edges are none.
std::vector<ClosedPiece> closedPieces(const Building& sheets);

} // namespace heliodon::geometry
