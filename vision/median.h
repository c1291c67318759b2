// The middle of unordered values.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace heliodon::vision {

// The upper one of two in the middle; 0 of none. Linear in their number; needs a copy, or takes what is moved
// in.
template<class T> T median(std::vector<T> values) {
    if (values.empty()) return T(0);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

} // namespace heliodon::vision
