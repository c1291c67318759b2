#include "geometry/box_tree.h"

#include <algorithm>

namespace heliodon::geometry {

BoxTree::BoxTree(std::span<const Bounds> boxes) : boxes_(boxes) {
    for (uint32_t i = 0; i < boxes.size(); ++i) order_.push_back({boxes[i], i});
    if (!boxes.empty()) arrange(0, boxes.size());
}

void BoxTree::arrange(size_t first, size_t end) {
    Bounds around = boxes_[order_[first].box];
    for (size_t i = first; i < end; ++i) {
        around = united(around, boxes_[order_[i].box]);
    }
    const glm::dvec3 size = around.high - around.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const size_t middle = first + (end - first) / 2;
    const auto at = [&](size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(first), at(middle), at(end), [&](const Entry& a, const Entry& b) {
        return boxes_[a.box].centre()[axis] < boxes_[b.box].centre()[axis];
    });
    order_[middle].around = around;
    if (middle > first) arrange(first, middle);
    if (end > middle + 1) arrange(middle + 1, end);
}

} // namespace heliodon::geometry
