// The planar arrangement of line segments: exact in what it decides, double in what it hands back.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

namespace heliodon::geometry {

struct PlanSegment {
    glm::dvec2 a{}, b{}; // distinct
    int32_t tag = 0;     // the caller's name for it
};

// A doubly connected edge list. Half-edges 2e and 2e + 1 are twins; a half-edge has its cell on its left.
struct PlanArrangement {
    struct Tag {
        int32_t tag;
        bool forward; // half-edge 2e runs the way of the segment
    };
    std::vector<glm::dvec2> points;     // the exact crossings, rounded; from left to right, then upwards
    std::vector<uint32_t> target;       // per half-edge: the point that it runs to
    std::vector<uint32_t> next;         // per half-edge: the one that follows round its cell
    std::vector<uint32_t> cell;         // per half-edge
    std::vector<std::vector<Tag>> tags; // per edge: the segments that it lies on, by tag
    uint32_t cellCount = 0;             // cell 0 is the unbounded one

    uint32_t source(uint32_t half) const { return target[half ^ 1u]; }
    size_t edgeCount() const { return tags.size(); }
};

// Segments may cross, touch and overlap; the order in which they come changes nothing. Cost: for n of them
// and k crossings at most n^2 comparisons of boxes, O((n + k) log (n + k)) of points and k exact divisions.
PlanArrangement arrange(std::span<const PlanSegment> segments);

} // namespace heliodon::geometry
