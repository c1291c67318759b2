// Straight walls that were drawn in pieces: which go on from one another, and which lie on one straight side.
#pragma once

#include <vector>

#include "geometry/plan_walls.h"

namespace heliodon::geometry {

// What goes on from another piece in its very line, as high and as thick, is the same wall: it makes no
// difference in how many pieces that was drawn.
void joinEndToEnd(std::vector<WallPiece>& pieces);

// Names each piece's straight side, with which it then lies in line; `lines` gets the new ones.
void findStraightSides(std::vector<WallPiece>& pieces, std::vector<WallLine>& lines);

} // namespace heliodon::geometry
