#include "vision/plan_view.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "geometry/sketch.h"

namespace heliodon::vision {
using geometry::kMetresPerInch;

PlanView::PlanView(const Photograph& photo, const geometry::OpticalDevice& camera, double gamma)
    : photo_(photo), camera_(camera) {
    for (size_t i = 0; i < linear_.size(); ++i)
        linear_[i] = static_cast<float>(std::pow(static_cast<double>(i) / 255, gamma));
}

glm::dvec2 PlanView::pixel(glm::dvec2 plan, double height) const {
    const glm::dvec3 world(kMetresPerInch * plan.x, kMetresPerInch * height, -kMetresPerInch * plan.y);
    // Behind the camera there is no picture; a pixel far outside is treated like every other pixel outside.
    return camera_.pixelFromWorld(world).value_or(glm::dvec2(-1e6));
}

glm::dvec2 PlanView::plan(glm::dvec2 pixel, double height) const {
    const auto world = camera_.worldOnPlane(pixel, kMetresPerInch * height);
    if (!world) return glm::dvec2(1e6);
    return glm::dvec2(world->x, -world->z) / kMetresPerInch;
}

double PlanView::pixelsPerInch(glm::dvec2 plan, double height) const {
    const glm::dvec2 here = pixel(plan, height);
    return 0.5 * (glm::distance(here, pixel(plan + glm::dvec2(1, 0), height)) +
                  glm::distance(here, pixel(plan + glm::dvec2(0, 1), height)));
}

glm::vec3 PlanView::light(glm::dvec2 p) const {
    const double x = std::clamp(p.x, 0.0, photo_.width - 1.001),
                 y = std::clamp(p.y, 0.0, photo_.height - 1.001);
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const float fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
    const size_t stride = static_cast<size_t>(photo_.width) * 3;
    const uint8_t* top = photo_.rgb.data() + static_cast<size_t>(y0) * stride + static_cast<size_t>(x0) * 3;
    const uint8_t* bottom = top + stride;
    glm::vec3 out;
    for (int c = 0; c < 3; ++c) {
        const float upper = linear_[top[c]] * (1 - fx) + linear_[top[c + 3]] * fx;
        const float lower = linear_[bottom[c]] * (1 - fx) + linear_[bottom[c + 3]] * fx;
        out[c] = upper * (1 - fy) + lower * fy;
    }
    return out;
}

glm::vec3 PlanView::white(glm::dvec2 p) const {
    const double i = std::floor((p.x - white_.x0) / white_.square),
                 j = std::floor((p.y - white_.y0) / white_.square);
    if (!(i >= 0 && j >= 0 && i < white_.columns && j < white_.rows)) return glm::vec3(1);
    return white_
        .light[static_cast<size_t>(j) * static_cast<size_t>(white_.columns) + static_cast<size_t>(i)];
}

} // namespace heliodon::vision
