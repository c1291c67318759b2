// Regions of paint seen in plan.
#pragma once

#include <cstddef>
#include <vector>

#include <glm/vec2.hpp>

#include "vision/components.h"
#include "vision/plan_view.h"

namespace heliodon::vision {

// The region's pixels at that height; of large regions every second pixel of a row, and always a row's ends.
std::vector<glm::dvec2> planPoints(const Component& component, const PlanView& view, double height);

double heightOf(Paint wallPaint); // inches

constexpr double kSmallestRegion = 0.06; // square inches: half an inch of wall; less is noise
constexpr size_t kMostRegions = 600;     // more are noise, not a table

// The smallest region's pixels in the middle of the table; 4 or more.
int smallestArea(const PlanView& view);

// The floor beside the table may have any colour. What is seen there can be the top of a wall near the edge,
// which leans outwards in the picture, and nothing else. `radius` of the table: inches.
bool canStandOnTable(const Component& region, const PlanView& view, double radius);

} // namespace heliodon::vision
