// Faces cut along the planes of others.
#pragma once

#include <vector>

#include "geometry/building.h"
#include "geometry/face_soup.h"
#include "geometry/flat_faces.h"

namespace heliodon::geometry {

// Whether a convex face is on both sides of the other's plane, and the line there runs on the other one or
// its border, by more than `tolerance` (metres).
bool isCutBy(const FlatFace& convex, const FlatFace& other, double tolerance);

std::vector<FlatFace> convexParts(const FlatFace& face);

// As they are given, each by its place, for welding puts corners of others into edges, which makes needles of
// triangles.
Building unwelded(const std::vector<SoupFace>& faces);

} // namespace heliodon::geometry
