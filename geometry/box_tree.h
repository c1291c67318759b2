// Boxes by where they are: which of them hold a given one, or a ray meets. O(n log n) to build, O(log n) a
// question where few overlap.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vector_relational.hpp>

#include "geometry/bounds.h"

namespace heliodon::geometry {

class BoxTree {
public:
    // The boxes outlive the tree.
    explicit BoxTree(std::span<const Bounds> boxes);

    // Whether `accepts(i)` says so of any box i that reaches at least from `low` to `high` along each axis;
    // it is asked of no other. `low` may be above `high`.
    template<class Accepts> bool anyHolding(glm::dvec3 low, glm::dvec3 high, const Accepts& accepts) const {
        return search(0, boxes_.size(), low, high, accepts);
    }

    // Whether `accepts(i)` says so of any box i that the ray meets within `reach` lengths of `way` (0 or
    // more); it is asked of few others.
    template<class Accepts>
    bool anyAlong(glm::dvec3 from, glm::dvec3 way, double reach, const Accepts& accepts) const {
        return follow(0, boxes_.size(), from, way, reach, accepts);
    }

private:
    // A node of the tree is a range of order_: its middle entry, and the nodes before and after it.
    struct Entry {
        Bounds around; // all boxes of the node
        uint32_t box;
    };
    void arrange(size_t first, size_t end);
    template<class Accepts>
    bool search(size_t first, size_t end, glm::dvec3 low, glm::dvec3 high, const Accepts& accepts) const {
        if (first == end) return false;
        const size_t middle = first + (end - first) / 2;
        const Entry& entry = order_[middle];
        const auto holds = [&](const Bounds& box) {
            return glm::all(glm::lessThanEqual(box.low, low)) &&
                   glm::all(glm::greaterThanEqual(box.high, high));
        };
        return holds(entry.around) &&
               ((holds(boxes_[entry.box]) && accepts(entry.box)) ||
                search(first, middle, low, high, accepts) || search(middle + 1, end, low, high, accepts));
    }

    static bool meets(const Bounds& box, glm::dvec3 from, glm::dvec3 way, double reach) {
        double first = 0, last = reach;
        for (int c = 0; c < 3; ++c) {
            if (way[c] == 0) {
                if (!(from[c] >= box.low[c] && from[c] <= box.high[c])) return false;
                continue;
            }
            const double a = (box.low[c] - from[c]) / way[c], b = (box.high[c] - from[c]) / way[c];
            first = std::max(first, std::min(a, b));
            last = std::min(last, std::max(a, b));
        }
        return first <= last;
    }
    template<class Accepts>
    bool follow(size_t first, size_t end, glm::dvec3 from, glm::dvec3 way, double reach,
                const Accepts& accepts) const {
        if (first == end) return false;
        const size_t middle = first + (end - first) / 2;
        const Entry& entry = order_[middle];
        return meets(entry.around, from, way, reach) &&
               (accepts(entry.box) || follow(first, middle, from, way, reach, accepts) ||
                follow(middle + 1, end, from, way, reach, accepts));
    }

    std::span<const Bounds> boxes_;
    std::vector<Entry> order_;
};

} // namespace heliodon::geometry
