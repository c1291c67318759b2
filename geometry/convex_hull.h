// The convex hull of points of a plane (Andrew 1979).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>

#include <boost/container/small_vector.hpp>
#include <glm/vec2.hpp>

#include "geometry/perpendicular.h"

namespace heliodon::geometry {

// Room for what walls have: corners and edges of a box.
template<class T> using FewOf = boost::container::small_vector<T, 48>;

// Which points are its corners, counter-clockwise; those on its edges are none. Cost: n log n.
inline FewOf<uint32_t> convexHull(std::span<const glm::dvec2> points) {
    FewOf<uint32_t> order(points.size()), hull(2 * points.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, [&](uint32_t i, uint32_t j) {
        return points[i].x < points[j].x || (points[i].x == points[j].x && points[i].y < points[j].y);
    });
    size_t n = 0;
    const auto grow = [&](uint32_t i, size_t base) {
        while (n >= base + 2 &&
               cross(points[hull[n - 1]] - points[hull[n - 2]], points[i] - points[hull[n - 1]]) <= 1e-15)
            --n;
        hull[n++] = i;
    };
    for (const uint32_t i : order) grow(i, 0);
    const size_t lower = n - 1;
    for (size_t k = order.size() - 1; k-- > 0;) grow(order[k], lower);
    hull.resize(n > 0 ? n - 1 : 0);
    return hull;
}

} // namespace heliodon::geometry
