// Raises the smallest angles of a triangulation that is even already.
#pragma once

#include <cstddef>

#include "geometry/planar_net.h"

namespace heliodon::geometry {

// Moves single points so that the smallest angle round them grows; where that is not enough, those near a bad
// triangle together, or adds a point there, where it helps. `edge`: of the triangles wanted. Returns how many
// points it added, at most `mostAdded`.
size_t raiseAngles(PlanarNet& net, double edge, size_t mostAdded);

// What is left of small angles, but for those in strips and at sharp corners.
struct SmallAngles {
    double worst = 0;     // cosine of the smallest angle
    bool atInner = false; // the triangle with it has a point that can move
    size_t triangles = 0; // that are worth mending
    bool crowded = false; // they are so many that only some were tried, without moving points together
};
SmallAngles smallAngles(const PlanarNet& net, double edge);

} // namespace heliodon::geometry
