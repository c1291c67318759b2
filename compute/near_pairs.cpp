#include "compute/near_pairs.h"

#include <algorithm>

namespace heliodon::compute {

NearPairs::NearPairs(const geometry::PatchMesh& mesh, const gpu::Buffer& factors) {
    const size_t n = mesh.patchCount();
    const gpu::HostView<float> matrix(factors, n * n);
    const auto forPairs = [&](const auto& take) {
        for (size_t i = 0; i < n; ++i)
            for (size_t j = 0; j < n; ++j)
                if (matrix[i * n + j] >= kFar && mesh.room[i] == mesh.room[j]) take(i, j);
    };
    first_.assign(n + 1, 0);
    forPairs([&](size_t, size_t j) { ++first_[j + 1]; });
    for (size_t j = 0; j < n; ++j) first_[j + 1] += first_[j];
    pairs_.resize(first_[n]);
    std::vector<size_t> next(first_.begin(), first_.end() - 1);
    forPairs([&](size_t i, size_t j) { pairs_[next[j]++] = {static_cast<uint32_t>(i), matrix[i * n + j]}; });
    for (size_t j = 0; j < n; ++j) {
        const auto begin = pairs_.begin() + static_cast<std::ptrdiff_t>(first_[j]),
                   end = pairs_.begin() + static_cast<std::ptrdiff_t>(first_[j + 1]);
        near_.push_back(static_cast<size_t>(
            std::stable_partition(begin, end, [](const Pair& pair) { return pair.factor >= kNear; }) -
            begin));
        float most = 0;
        for (const Pair& pair : of(j)) most = std::max(most, pair.factor);
        largest_.push_back(most);
    }
}

} // namespace heliodon::compute
