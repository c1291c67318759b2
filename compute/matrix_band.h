// Parts of a matrix larger than a device binds at once.
#pragma once

#include <cstddef>
#include <cstdint>

#include "compute/gpu/kernel.h"

namespace heliodon::compute {

// What a device may want storage buffers to begin at multiples of, bytes: so much more than asked for is
// bound.
constexpr size_t kBandAlignment = 256;

struct MatrixBand {
    gpu::Binding binding;
    uint32_t first; // in the binding, in floats, where the band begins
};

// Floats [first, end) of `matrix`, which is to outlive the binding.
inline MatrixBand bandOf(const gpu::Buffer& matrix, size_t first, size_t end) {
    constexpr size_t kFloats = kBandAlignment / sizeof(float);
    const size_t begin = first / kFloats * kFloats;
    return {gpu::part(matrix, begin * sizeof(float), (end - begin) * sizeof(float)),
            static_cast<uint32_t>(first - begin)};
}

} // namespace heliodon::compute
