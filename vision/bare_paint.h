// What a window marker near a wall's end leaves of the wall's paint: too short to be a region of its own.
#pragma once

#include <glm/vec2.hpp>

#include "vision/plan_view.h"

namespace heliodon::vision {

struct MarkerEnd {
    glm::dvec2 edge{};      // of the marker, in plan, on the wall's middle line
    glm::dvec2 outward{};   // unit, along the wall to its end
    double height = 0;      // of the wall: inches
    double markerWidth = 0; // along the wall: inches
    glm::dvec2 painted{};   // a place on the same wall that shows its paint
};

// Inches of paint from the marker's edge on, to where white begins; 0 where the white end begins at the
// marker, or something else lies there. Half an inch at most: more is a region. By hue and saturation over
// the local white, each place going to the nearest of paint, marker and white.
double barePaintBeyond(const MarkerEnd& end, const PlanView& view);

} // namespace heliodon::vision
