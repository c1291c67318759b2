// How faces lie to one another and to closed shells.
#pragma once

#include "geometry/flat_faces.h"
#include "geometry/triangle_rays.h"

namespace heliodon::geometry {

// Whether the line of both planes runs on both faces for more than `tolerance` (metres), and not along the
// border of either.
bool facesCross(const FlatFace& one, const FlatFace& other, double tolerance);

// Whether the triangle's middle lies in one of the shells, on both sides: what lies on a wall does not. It
// has an area (precondition).
bool isWithin(const TriangleRays& shells, const ShellTriangle& triangle, double tolerance);

} // namespace heliodon::geometry
