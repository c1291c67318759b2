// Convex polygons cut by a plane (Sutherland, Hodgman 1974), in space or in a plane of their own.
#pragma once

#include <span>
#include <type_traits>
#include <vector>

namespace heliodon::geometry {

// The part of a convex polygon where height(corner) >= 0, in `result`, whose old content goes; none where
// fewer than three corners are left. `height`: signed, linear over the polygon. Corners of height zero belong
// to both sides, and both sides of a cut edge get the same point of it to the bit. Does not alias.
template<class Point, class Height>
void clip(std::type_identity_t<std::span<const Point>> polygon, const Height& height,
          std::vector<Point>& result) {
    result.clear();
    if (polygon.empty()) return;
    result.reserve(polygon.size() + 1);
    const Point* from = &polygon.back();
    double before = height(*from);
    for (const Point& to : polygon) {
        const double now = height(to);
        if ((before > 0 && now < 0) || (before < 0 && now > 0))
            result.push_back(*from + (to - *from) * (before / (before - now)));
        if (now >= 0) result.push_back(to);
        from = &to, before = now;
    }
    if (result.size() < 3) result.clear();
}

} // namespace heliodon::geometry
