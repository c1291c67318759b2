// Cubature over what a point sees.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "compute/point_view.h"
#include "geometry/clip_polygon.h"

namespace heliodon::compute {

// A small convex polygon, relative to the point.
struct ViewCell {
    glm::dvec3 centre;
    double weight; // in proportion to its form factor; negative behind the horizon
};
inline ViewCell viewCell(std::span<const glm::dvec3> polygon, glm::dvec3 normal) {
    glm::dvec3 middle(0), area(0);
    double total = 0;
    for (size_t k = 1; k + 1 < polygon.size(); ++k) {
        const glm::dvec3 part = glm::cross(polygon[k] - polygon[0], polygon[k + 1] - polygon[0]);
        const double size = glm::length(part);
        middle += size / 3.0 * (polygon[0] + polygon[k] + polygon[k + 1]);
        area += part, total += size;
    }
    if (total <= 0) return {polygon[0], 0};
    middle /= total;
    const double distance2 = glm::dot(middle, middle);
    return {middle, std::abs(glm::dot(area, middle)) * glm::dot(middle, normal) / (distance2 * distance2)};
}

// Cuts a convex polygon (relative to the point) into triangles that span less than `angle`, seen from the
// point; work(corners).
template<class Work> void forTriangles(std::span<const glm::dvec3> polygon, double angle, const Work& work) {
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
                work(std::array{t.a, t.b, t.c});
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

// The same; work(centre, weight).
template<class Work>
void forCells(std::span<const glm::dvec3> polygon, glm::dvec3 normal, double angle, const Work& work) {
    forTriangles(polygon, angle, [&](const std::array<glm::dvec3, 3>& corners) {
        const ViewCell cell = viewCell(corners, normal);
        if (cell.weight > 0) work(cell.centre, cell.weight);
    });
}

// By what weights of cells are multiplied to be parts of pi times the form factor of their polygon: about a
// half, for they come from cubature and the sum from Lambert's formula, which of slivers that cutting leaves
// is nothing but rounding.
inline double scaleOfCells(double factor, double weights) {
    return weights > 0 ? std::min(1.0, std::numbers::pi * factor / weights) : 0;
}

// Cells of a part of a view; work(centre, form factor).
template<class Work>
void forSamples(const PointView& view, std::span<const glm::dvec3> part, double angle, const Work& work) {
    double weights = 0;
    forCells(part, view.normal(), angle, [&](glm::dvec3, double weight) { weights += weight; });
    const double scale = scaleOfCells(view.unhinderedFactor(part), weights) / std::numbers::pi;
    forCells(part, view.normal(), angle,
             [&](glm::dvec3 centre, double weight) { work(centre, scale * weight); });
}

// The parts of a polygon above and below the horizontal plane through the point.
inline void splitAtHorizon(const PointView::Polygon& polygon, PointView::Polygon& sky,
                           PointView::Polygon& ground) {
    geometry::clip<glm::dvec3>(
        polygon, [](const glm::dvec3& p) { return p.y; }, sky);
    geometry::clip<glm::dvec3>(
        polygon, [](const glm::dvec3& p) { return -p.y; }, ground);
    for (glm::dvec3& p : sky) p.y = std::max(p.y, 0.0);
    for (glm::dvec3& p : ground) p.y = std::min(p.y, 0.0);
}

} // namespace heliodon::compute
