// A flat piece of a mesh, meshed anew along lines that cross it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>

#include "geometry/plane_view.h"

namespace heliodon::geometry {

constexpr double kSameInRegion = 1e-4; // metres: points nearer than this are one

// One end of a cut: inside the region, or at a + t (b - a) on a border edge.
struct CutEnd {
    glm::dvec2 point{};
    int edge = -1;
    double t = 0;
};
using Cut = std::array<CutEnd, 2>;

// The parts of the segments inside the region that the border edges (in any order, closed loops together)
// enclose. What runs along the border is left out.
std::vector<Cut> clipToRegion(std::span<const Segment> segments, std::span<const Segment> borderEdges);

struct RegionLine {
    std::array<int, 2> border{-1, -1}; // index of a border point, or -1 and ...
    std::array<glm::dvec2, 2> point{}; // ... a point inside
};

struct Region {
    std::vector<glm::dvec2> border;                         // distinct
    std::vector<std::pair<uint32_t, uint32_t>> borderEdges; // the region on their left
    std::vector<glm::dvec2> seeds; // points inside that the result has where no line is near
    std::vector<double> seedSpacing;
    std::vector<RegionLine> lines; // may cross and overlap
    double spacing = 0;            // of the points along lines, metres
};

struct RegionMesh {
    std::vector<glm::dvec2> points;  // the border's first, then the seeds kept, then those on lines
    std::vector<uint32_t> keptSeeds; // points[border.size() + k] is seeds[keptSeeds[k]]
    std::vector<std::array<uint32_t, 3>> triangles; // counter-clockwise
};

// Every line is an edge or a chain of edges of the result, to within 0.2 mm. Constrained Delaunay
// triangulation; seeds nearer to a line than a quarter of their spacing make way for its own points. Cost:
// about 1 us a point.
RegionMesh meshRegion(const Region& region);

} // namespace heliodon::geometry
