// Regions of paint seen in plan.
#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "vision/components.h"
#include "vision/plan_view.h"

namespace heliodon::vision {

// The region's pixels at that height; of large regions every second pixel of a row, and always a row's ends.
std::vector<glm::dvec2> planPoints(const Component& component, const PlanView& view, double height);

double heightOf(Paint wallPaint); // inches

} // namespace heliodon::vision
