#include "compute/dense_gather.h"

namespace heliodon::compute {

void DenseGather::gather(std::span<const float> in, std::span<float> out, uint32_t columns) {
    const float* values = factors_->mapped<float>();
    const size_t n = patchCount();
    if (columns <= RadiosityGather::kMostColumns || !values || n > kMostHostPatches)
        return device_.gather(in, out, columns);
    if (!host_) host_.emplace(std::span(values, n * n), patchCount());
    host_->gather(in, out, columns);
}

} // namespace heliodon::compute
