#include "vision/rounding.h"

#include <algorithm>
#include <cmath>

namespace heliodon::vision {

namespace {

// The light of a value between two bytes, and back.
double lightOf(const std::array<float, 256>& linear, double value) {
    const double inside = std::clamp(value, 0.0, 254.999);
    const auto byte = static_cast<size_t>(inside);
    const double share = inside - static_cast<double>(byte);
    return (1 - share) * static_cast<double>(linear[byte]) + share * static_cast<double>(linear[byte + 1]);
}
double valueOf(const std::array<float, 256>& linear, double light) {
    const auto above = std::upper_bound(linear.begin() + 1, linear.end() - 1, static_cast<float>(light));
    const double low = static_cast<double>(above[-1]), high = static_cast<double>(*above);
    return static_cast<double>(above - linear.begin()) - (high - light) / (high - low);
}

} // namespace

ColourRounding::ColourRounding(const PlanView& view) : rounds_(view.photo().chromaStep > 0) {
    if (!rounds_) return;
    // Half a step of either difference moves red from blue by 0.5 (1.40 + 1.77) steps, the other pairs by
    // less.
    const double reach = 0.5 * 0.5 * (1.402 + 1.772) * view.photo().chromaStep;
    const auto& linear = view.linearFromByte();
    for (int i = 0; i < kLevels; ++i) {
        const double value = valueOf(linear, std::pow((i + 0.5) / kLevels, 2));
        most_[static_cast<size_t>(i)] = static_cast<float>(lightOf(linear, value + reach));
        least_[static_cast<size_t>(i)] = static_cast<float>(lightOf(linear, value - reach));
    }
}

size_t ColourRounding::levelOf(float light) const {
    return static_cast<size_t>(std::clamp(static_cast<int>(std::sqrt(light) * kLevels), 0, kLevels - 1));
}

float ColourRounding::leastSaturation(glm::vec3 light, glm::vec3 gain) const {
    const glm::vec3 p = light * gain;
    int high = 0, low = 0;
    for (int c = 1; c < 3; ++c) {
        if (p[c] > p[high]) high = c;
        if (p[c] < p[low]) low = c;
    }
    float brightest = p[high], darkest = p[low];
    if (rounds_) {
        brightest = gain[high] * least_[levelOf(light[high])];
        darkest = gain[low] * most_[levelOf(light[low])];
    }
    return brightest > 0 ? 1 - darkest / brightest : kUnknown;
}

} // namespace heliodon::vision
