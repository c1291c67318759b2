// What a file's rounding of colours leaves known of them: JPEG keeps one mean of each square's colour, in
// steps that are small beside a bright pixel and large beside a dim one.
#pragma once

#include <array>

#include <glm/vec3.hpp>

#include "vision/plan_view.h"

namespace heliodon::vision {

class ColourRounding {
public:
    explicit ColourRounding(const PlanView& view);

    // P' that a colour had at least before it was rounded; negative where it may have been white, and more
    // so the less is known. `light`: linear, as the picture has it; `gain`: what takes it to light over
    // white.
    float leastSaturation(glm::vec3 light, glm::vec3 gain) const;

private:
    static constexpr int kLevels = 1024;
    static constexpr float kUnknown = -1e3f;
    size_t levelOf(float light) const;

    bool rounds_ = false;
    std::array<float, kLevels> most_{}, least_{}; // light that was rounded to that, by the root of that
};

} // namespace heliodon::vision
