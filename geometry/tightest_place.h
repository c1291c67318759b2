// Where a way through space is narrowest.
#pragma once

#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/ray_triangle.h"

namespace heliodon::geometry {

// Metres.
struct TightPlace {
    glm::dvec3 place{0}; // in the middle of it, in the plane of a hole in a sheet
    double width = 0;    // about
};

// Of a way that crosses no triangle, by points that are nearer to one another where it is narrower, moved
// into the middle there. None where its last point has little more room. Cost: some thousand times the number
// of triangles.
std::optional<TightPlace> tightestPlace(const std::vector<glm::dvec3>& way,
                                        const std::vector<ShellTriangle>& triangles);

} // namespace heliodon::geometry
