// Two pictures of one table never give quite the same numbers. What agrees with the sketch before within the
// noise of detection is taken over from it, so that a table that was not changed gives the same sketch, and a
// changed one differs where it was changed and nowhere else.
#pragma once

#include "geometry/sketch.h"

namespace heliodon::vision {

struct SteadyOptions {
    double inches = 0.08;      // ends of walls, windows, skylights
    double degrees = 0.6;      // the arrow, skylights
    double tokenInches = 0.15; // where a token lies decides less
    double colourSteps = 8;    // of a chip's sRGB, 0..255
};

struct SteadySketch {
    geometry::Sketch sketch;
    bool sameGeometry = false;  // walls, arcs, windows and skylights are all those of the sketch before
    bool sameMaterials = false; // and so are the tokens
    bool sameNorth = false;
    bool same() const { return sameGeometry && sameMaterials && sameNorth; }
};

// Outlines in the picture and confidences are always those of `fresh`, unless everything else is `before`'s.
SteadySketch steadied(const geometry::Sketch& before, const geometry::Sketch& fresh,
                      const SteadyOptions& options = {});

} // namespace heliodon::vision
