// Medians and their like of values that count by area.
#pragma once

#include <utility>
#include <vector>

namespace heliodon::passes {

// The least value such that it and those below have `share` of the weight. `sorted`: value and weight, by
// value, not empty; `total`: the sum of the weights.
inline double weightedQuantile(const std::vector<std::pair<double, double>>& sorted, double total,
                               double share) {
    double sum = 0;
    for (const auto& [value, weight] : sorted)
        if ((sum += weight) >= share * total) return value;
    return sorted.back().first; // sums round
}

} // namespace heliodon::passes
