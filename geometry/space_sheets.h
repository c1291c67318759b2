// Faces that lie on one another or end on one another, cut along one another: every piece is one sheet with
// two sides.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/face_soup.h"
#include "geometry/kept.h"

namespace heliodon::geometry {

// A piece of a wall, its outline counter-clockwise about the sheet's normal, holes clockwise.
struct Sheet {
    std::vector<std::vector<glm::dvec3>> loops;
    std::array<std::vector<uint32_t>, 2> drawn; // the given faces over it: turned that way, and the other
};

// Corners of other faces count as on an edge, and faces as in one plane, within `tolerance` (metres). Faces
// may cross; they are not cut there. Cost: n log n for n faces,
// n^2 where all lie in one plane or in nearly parallel ones.
std::vector<Sheet> cutIntoSheets(const std::vector<SoupFace>& faces, double tolerance);

// What of a face lies there: as the sheet is turned, or (1) the other way round.
SoupFace pieceOf(const SoupFace& face, const Sheet& sheet, size_t turned);

// Sheets by common corners; Face::surface: which sheet.
Building weldSheets(const std::vector<Sheet>& sheets, double tolerance);

// While one lives, what the thread cut and welded last is kept: where every attempt at a model is refused,
// its faces are asked for again and again. The same faces, to the bit, give the same sheets. At most one.
struct SheetMemory {
    Memory<std::vector<Sheet>> cut;
    WeldMemory welded;
};

} // namespace heliodon::geometry
