// The one place where polygons of the plane are triangulated.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>

namespace heliodon::geometry {

constexpr uint32_t kNoTriangle = 0xffffffffu;

// Triangles with their neighbours: neighbour k lies across the edge opposite corner k.
struct TriangleNet {
    std::vector<std::array<uint32_t, 3>> corner; // into the points, counter-clockwise
    std::vector<std::array<uint32_t, 3>> neighbour;
    std::vector<std::array<bool, 3>> fixed; // the edge opposite corner k is one of the polygons' or a divider
};

// The inside (an odd number of edges away from infinity) of the polygons that `edges` make, as a constrained
// Delaunay triangulation of all points in which `dividers` within it are edges too. Exact predicates. Nothing
// when two points coincide or two edges cross. Cost: O(n log n), about 0.7 us a point.
std::optional<TriangleNet> constrainedDelaunay(std::span<const glm::dvec2> points,
                                               std::span<const std::pair<uint32_t, uint32_t>> edges,
                                               std::span<const std::pair<uint32_t, uint32_t>> dividers = {});

} // namespace heliodon::geometry
