// One triangle of the plane, cut along segments.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>

namespace heliodon::geometry {

struct CutResult {
    std::vector<glm::dvec2> points;                 // the border's first, in their order, then those inside
    std::vector<std::array<uint32_t, 3>> triangles; // counter-clockwise
};

// `border`: the triangle's corners with further points on its edges, counter-clockwise, distinct. `segments`
// lie inside it and may cross; an end that is a border point must be given by its index, others as a point.
struct CutSegment {
    std::array<int, 2> border{-1, -1}; // index of the border point, or -1 and ...
    std::array<glm::dvec2, 2> point{}; // ... the point
};
CutResult cutTriangle(const std::vector<glm::dvec2>& border, const std::vector<CutSegment>& segments);

} // namespace heliodon::geometry
