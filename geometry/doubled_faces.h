// Faces that a file has for both their sides, as programs write that show faces from one side alone.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "geometry/face_soup.h"

namespace heliodon::geometry {

// Where what hangs together is closed and nearly all its faces that are no glass (`isGlass` of a material)
// are drawn for both sides, leaves out one of each two, and turns the rest: those of bodies look out; those
// of rooms, which have glass or stand in nothing and have bodies in them, look in. The glass is there once
// (geometry/doubled_glass). Nothing where no face is glass: then bodies may be rooms. Returns how many were
// left out. Corners are one within `tolerance` (metres). Cost: n log n, and where there are such, closed
// pieces times faces.
size_t dropDoubledFaces(std::vector<SoupFace>& faces, const std::function<bool(uint32_t)>& isGlass,
                        double tolerance);

} // namespace heliodon::geometry
