// Inner products of float rows on the host: what sky elements and sensors give.
#pragma once

#include <cstddef>
#include <span>

namespace heliodon::compute {

// Sum of a[i] b[i]; b is as long as a (precondition), 0 where both are empty. In sixteen parts, so that it
// vectorises and is the same on every run; its error is at most about n / 16 float roundings of sum |a[i]
// b[i]|.
inline double dot(std::span<const float> a, std::span<const float> b) {
    float parts[16]{};
    size_t i = 0;
    for (; i + 16 <= a.size(); i += 16)
        for (size_t k = 0; k < 16; ++k) parts[k] += a[i + k] * b[i + k];
    for (; i < a.size(); ++i) parts[0] += a[i] * b[i];
    double sum = 0;
    for (float part : parts) sum += double{part};
    return sum;
}

} // namespace heliodon::compute
