#include "compute/host_gather.h"

#include <algorithm>

#include "compute/parallel.h"

namespace heliodon::compute {

HostGather::HostGather(std::span<const float> factors, uint32_t patchCount)
    : panels_(patchCount, patchCount) {
    const size_t n = patchCount;
    inParallel(panels_.count(), [&](size_t p) {
        for (size_t i = p * Panels::kWidth; i < std::min(n, (p + 1) * Panels::kWidth); ++i)
            for (size_t j = 0; j < n; ++j) panels_.at(j, i) = factors[i * n + j];
    });
}

void HostGather::gather(std::span<const float> in, std::span<float> out, uint32_t columns) {
    if (columns > 0) multiply(in, columns, panels_, out);
}

} // namespace heliodon::compute
