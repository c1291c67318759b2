// Boxes by where they are: which of them hold a given one. O(n log n) to build, O(log n) a question where few
// overlap.
#pragma once

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

    std::span<const Bounds> boxes_;
    std::vector<Entry> order_;
};

} // namespace heliodon::geometry
