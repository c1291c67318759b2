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

constexpr size_t kEnoughEnds = 4; // a single wall can be one misread under a lamp

// Medians of all the walls' ends. None where they return less than that, as on a white table, without walls,
// and where the table elsewhere returns as much: then it is they that stand in more light. `image`: what the
// paints of the sketch were told by, as `view`'s white; `radius` of the table: inches.
std::optional<BrightEnds> brightEnds(const geometry::Sketch& sketch, const WallEvidence& evidence,
                                     const ClassImage& image, const PlanView& view, double radius);

// Whether the ends have the table's colour rather than that of what was taken for card on a table of another
// colour: then the table is white, and what is card's colour was lit so, as faces are that one of two lights
// meets and the other does not. Medians of `kEnoughEnds` or more.
bool endsHaveTablesColour(const geometry::Sketch& sketch, const WallEvidence& evidence,
                          const ClassImage& image, const PlanView& view);

} // namespace heliodon::vision
