// Whether the table lies in the picture where the rig has it. After a camera was moved, or of a picture that
// was turned, everything is read at the wrong place, in the wrong size.
#pragma once

#include <optional>
#include <string>

#include <glm/vec2.hpp>

#include "vision/plan_view.h"

namespace heliodon::vision {

// Plan inches from the middle of the table as the rig has it to the middle of the round edge that the picture
// shows. None where the edge lies within 0.3 in of where it should, and where none of that radius (inches)
// shows: too little of it in the picture, or no step of light all round. Good to 0.01 in and 7 % within an
// inch, else to 0.1 in and a twentieth. About a millisecond within an inch, else about 30.
std::optional<glm::dvec2> tableOffset(const PlanView& view, double radius);

// The same, however little it is, by the middle of the step of light in each direction; none where the edge
// is more than about an inch off or does not show nearly all round.
std::optional<glm::dvec2> edgeOffset(const PlanView& view, double radius);

// The radius of a round edge about the rig's middle of the table, plan inches, where it is not the rig's: the
// board that the camera was calibrated with, or the table, has another size than was said. None where it lies
// within a third of an inch, and where none shows within a third of the radius. Good to 0.1 in. Under a
// millisecond where the edge is at its place, else about 2.
std::optional<double> tableRadiusSeen(const PlanView& view, double radius);

// A warning of either, for the user; none where neither is seen.
std::optional<std::string> tableElsewhere(const PlanView& view, double radius);

} // namespace heliodon::vision
