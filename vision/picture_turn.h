// Whether a photograph was mirrored or turned by half after it was taken. Its table can look as it should;
// what gives it away is that walls lean away from the camera: their faces end where another camera saw them;
// or that the table's edge lies where it would for another.
#pragma once

#include <optional>
#include <vector>

#include "geometry/sketch.h"
#include "vision/color_classes.h"
#include "vision/plan_view.h"

namespace heliodon::vision {

enum class PictureTurn { mirrored, upsideDown, turnedByHalf }; // left and right swapped, top and bottom, both

// By the faces of the walls found, three or more; none where they end where the rig's camera sees the table,
// where no turn fits clearly better, and mostly where half of the walls or more lie along the way that the
// turn would move it: then all look alike; nor one that takes the table's edge from where the rig has it.
// Else by the table's edge, where it is 0.2 to 1.1 in off and a turn puts it within 0.06 in of its place;
// none where the table fills the picture or has the floor's colour.
std::optional<PictureTurn> pictureTurn(const std::vector<geometry::Wall>& walls, const ClassImage& image,
                                       const PlanView& view, const DetectOptions& options, double radius);

} // namespace heliodon::vision
