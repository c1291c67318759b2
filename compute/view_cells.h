// Cubature over what a point sees.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace heliodon::compute {

// Cuts a convex polygon (relative to the point) into triangles that span less than `angle`, seen from the
// point; work(centre, weight) with weights in proportion to the cells' form factors.
template<class Work>
void forCells(std::span<const glm::dvec3> polygon, glm::dvec3 normal, double angle, const Work& work) {
    struct Triangle {
        glm::dvec3 a, b, c;
        int depth;
    };
    // Halvings. The number of cells follows from the solid angle; those at the feet of a point that almost
    // touches the polygon are small.
    constexpr int kDeepest = 64;
    Triangle stack[kDeepest + 2];
    for (size_t k = 1; k + 1 < polygon.size(); ++k) {
        size_t top = 0;
        stack[top++] = {polygon[0], polygon[k], polygon[k + 1], 0};
        while (top > 0) {
            const Triangle t = stack[--top];
            const glm::dvec3 centre = (t.a + t.b + t.c) / 3.0;
            const double distance2 = glm::dot(centre, centre);
            const double ab = glm::dot(t.b - t.a, t.b - t.a), bc = glm::dot(t.c - t.b, t.c - t.b),
                         ca = glm::dot(t.a - t.c, t.a - t.c), longest = std::max({ab, bc, ca});
            if (longest <= angle * angle * distance2 || t.depth >= kDeepest) {
                const glm::dvec3 area = glm::cross(t.b - t.a, t.c - t.a);
                const double weight = std::abs(glm::dot(area, centre)) * glm::dot(centre, normal);
                if (weight > 0) work(centre, weight / (distance2 * distance2));
            } else if (longest == ab) {
                const glm::dvec3 m = 0.5 * (t.a + t.b);
                stack[top++] = {t.a, m, t.c, t.depth + 1}, stack[top++] = {m, t.b, t.c, t.depth + 1};
            } else if (longest == bc) {
                const glm::dvec3 m = 0.5 * (t.b + t.c);
                stack[top++] = {t.a, t.b, m, t.depth + 1}, stack[top++] = {t.a, m, t.c, t.depth + 1};
            } else {
                const glm::dvec3 m = 0.5 * (t.c + t.a);
                stack[top++] = {t.a, t.b, m, t.depth + 1}, stack[top++] = {m, t.b, t.c, t.depth + 1};
            }
        }
    }
}

} // namespace heliodon::compute
