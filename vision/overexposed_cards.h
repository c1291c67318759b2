// Rectangles of card so bright that the camera has lost their colour, as on a black table that the exposure
// was set by.
#pragma once

#include "geometry/sketch.h"
#include "vision/doubts.h"
#include "vision/plan_view.h"
#include "vision/wall_evidence.h"

namespace heliodon::vision {

// Adds to `sketch` those of which the channels that are left are a skylight's; each, and each other that is
// as large and as straight as one, is a doubt. Faces of walls and what lies on tokens are none. One pass over
// the table in the photograph.
void readOverexposedCards(geometry::Sketch& sketch, const ClassImage& image, const WallEvidence& evidence,
                          const PlanView& view, const DetectOptions& options, double radius, Doubts& doubts);

} // namespace heliodon::vision
