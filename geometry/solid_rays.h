// One closed body: what lies in it.
#pragma once

#include <vector>

#include "geometry/triangle_rays.h"

namespace heliodon::geometry {

class SolidRays {
public:
    // `tolerance` as TriangleRays has it.
    SolidRays(const std::vector<ShellTriangle>& triangles, double tolerance)
        : box_{triangles[0].a, triangles[0].a}, rays_(triangles, tolerance) {
        for (const ShellTriangle& t : triangles)
            for (const glm::dvec3 p : {t.a, t.b, t.c}) box_ = united(box_, {p, p});
    }
    const Bounds& box() const { return box_; }
    bool enclose(glm::dvec3 p) const { return box_.isNear({p, p}, 0) && rays_.enclose(p); }
    bool isAbove(glm::dvec3 p) const { return rays_.anyWithin(p, {0, 1, 0}, box_.high.y - box_.low.y); }

private:
    Bounds box_;
    TriangleRays rays_;
};

} // namespace heliodon::geometry
