// Many rays through the same triangles. O(n log n) to build, O(log n) a ray where few boxes overlap.
#pragma once

#include <vector>

#include "geometry/bounds.h"
#include "geometry/box_tree.h"
#include "geometry/ray_triangle.h"

namespace heliodon::geometry {

class TriangleRays {
public:
    // `tolerance` (metres): more than rounding puts a triangle beside its box.
    TriangleRays(std::vector<ShellTriangle> triangles, double tolerance);
    TriangleRays(const TriangleRays&) = delete;
    TriangleRays& operator=(const TriangleRays&) = delete;

    // As distanceTo() has it, in lengths of `way`; infinite where nothing is met within `reach`.
    double nearest(glm::dvec3 from, glm::dvec3 way, double reach) const;
    bool anyWithin(glm::dvec3 from, glm::dvec3 way, double reach) const;
    // Whether an odd number of closed shells, were they such, is round the point.
    bool enclose(glm::dvec3 p) const;

private:
    std::vector<ShellTriangle> triangles_;
    std::vector<Bounds> boxes_;
    BoxTree tree_; // of these
};

} // namespace heliodon::geometry
