// Bodies that touch one another, or a wall, in an edge or a corner alone: cupboards corner to corner, blocks
// of stairs, a lamp hung by an edge. The shell of the room runs through such a place more than once.
#pragma once

#include "geometry/building.h"

namespace heliodon::geometry {

// Each time gets corners of its own, `by` (metres) from those of the others: along an edge into the air, so
// that no light passes there, in a corner into the body, and so does a corner that touches a face without
// being one of its own, by up to `reach` more. Edges are those of welded corners, and faces look into the air
// (precondition); where that is contradicted, or no way leads off all faces of a corner, it stays. False
// where nothing was to be done. Cost: n log n.
bool openPinches(Building& building, double by, double reach);

} // namespace heliodon::geometry
