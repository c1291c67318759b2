// Whether what was taken for white is as bright as the walls' own white ends.
#pragma once

#include <cstddef>
#include <optional>

#include "geometry/sketch.h"
#include "vision/color_classes.h"
#include "vision/plan_view.h"
#include "vision/wall_evidence.h"

namespace heliodon::vision {

// The walls' ends are bare foam core, a little nearer to the lamps than the table.
struct BrightEnds {
    CardWhite card;      // what they return, to hold the paints against
    float overWhite = 1; // brightest channel over what the paints were told by; 1.8 or more
    size_t count = 0;    // of ends
};

// Medians of all the walls' ends. None where they return less than that, as on a white table, without walls,
// and where the table elsewhere returns as much: then it is they that stand in more light. `image`: what the
// paints of the sketch were told by, as `view`'s white; `radius` of the table: inches.
std::optional<BrightEnds> brightEnds(const geometry::Sketch& sketch, const WallEvidence& evidence,
                                     const ClassImage& image, const PlanView& view, double radius);

} // namespace heliodon::vision
