#include "vision/bare_paint.h"

#include <algorithm>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "vision/edges.h"

namespace heliodon::vision {
namespace {

// Averaged across the middle of the wall's top; largest channel 1.
glm::vec3 toneAt(const PlanView& view, glm::dvec2 plan, glm::dvec2 along, double height) {
    constexpr double kAcross = 0.04; // inches
    glm::vec3 sum(0);
    for (int i = -2; i <= 2; ++i) {
        const glm::dvec2 p = view.pixel(plan + kAcross * i * turnedLeft(along), height);
        sum += view.light(p) / view.white(p);
    }
    return sum / std::max(std::max({sum.r, sum.g, sum.b}), 1e-6f);
}

} // namespace

double barePaintBeyond(const MarkerEnd& end, const PlanView& view) {
    constexpr double kMost = 0.55, kStep = 0.02; // inches
    constexpr double kBlur = 0.14;               // the marker's own edge, and its shadow
    constexpr double kLeast = 0.08;              // of paint; less is blur
    constexpr float kAlike = 0.2f;               // of paint and marker, or paint and white
    const auto tone = [&](glm::dvec2 plan) { return toneAt(view, plan, end.outward, end.height); };
    const glm::vec3 paint = tone(end.painted), white(1);
    const glm::vec3 marker = tone(end.edge - std::min(0.3, 0.5 * end.markerWidth) * end.outward);
    if (glm::distance(paint, marker) < kAlike || glm::distance(paint, white) < kAlike) return 0;
    double begin = -1, last = -1;
    for (double at = -0.06; at <= kMost; at += kStep) {
        const glm::vec3 seen = tone(end.edge + at * end.outward);
        const float toPaint = glm::distance(seen, paint);
        const bool isPaint = toPaint < std::min(glm::distance(seen, marker), glm::distance(seen, white));
        if (isPaint && begin < 0) begin = at;
        if (isPaint) last = at;
        if (!isPaint && begin >= 0) break;
        if (!isPaint && at > kBlur) break;
    }
    return begin >= 0 && last - begin >= kLeast ? std::max(0.0, last + 0.5 * kStep) : 0;
}

} // namespace heliodon::vision
