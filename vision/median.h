// The middle of unordered values, or another rank of theirs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace heliodon::vision {

// The value that would stand at `place`, from 0 and below their number, if they were in order. Linear in
// their number; leaves them in another order.
template<class T> T ranked(std::vector<T>& values, size_t place) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(place);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

// The upper one of two in the middle; 0 of none. Linear in their number; needs a copy, or takes what is moved
// in.
template<class T> T median(std::vector<T> values) {
    if (values.empty()) return T(0);
    return ranked(values, values.size() / 2);
}

} // namespace heliodon::vision
