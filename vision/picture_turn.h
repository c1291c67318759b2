// Whether a photograph was mirrored or turned by half after it was taken. Its table can look as it should;
// what gives it away is that walls lean away from the camera: their faces end where another camera saw them.
#pragma once

#include <optional>
#include <vector>

#include "geometry/sketch.h"
#include "vision/color_classes.h"
#include "vision/plan_view.h"

namespace heliodon::vision {

enum class PictureTurn { mirrored, upsideDown, turnedByHalf }; // left and right swapped, top and bottom, both

// None where the faces of the walls found, three or more, end where the rig's camera sees the table, where no
// turn fits clearly better, where the camera looks down on the table's middle, and mostly where half of the
// walls or more lie along the way that the turn would move it: then all look alike.
std::optional<PictureTurn> pictureTurn(const std::vector<geometry::Wall>& walls, const ClassImage& image,
                                       const PlanView& view, const DetectOptions& options, double radius);

} // namespace heliodon::vision
