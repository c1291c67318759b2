// What makes all that is read from a photograph doubtful: its light, its colours, its file.
#pragma once

#include <string>
#include <vector>

#include "geometry/sketch.h"
#include "vision/color_classes.h"
#include "vision/detect.h"
#include "vision/plan_view.h"
#include "vision/wall_evidence.h"

namespace heliodon::vision {

// Overexposure, compression, few pixels, blur, noise of brightness and of colour, pale paint: one line each,
// none for a photograph that is as it should be. `radius` of the table: inches.
std::vector<std::string> pictureFaults(const geometry::Sketch& sketch, const ClassImage& image,
                                       const WallEvidence& evidence, const PlanView& view,
                                       const DetectOptions& options, double radius);

} // namespace heliodon::vision
