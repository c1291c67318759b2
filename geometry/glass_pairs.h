// Glasses on the two sides of one wall -> the twins of an interior window.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "geometry/building.h"

namespace heliodon::geometry {

struct GlassPairs {
    size_t nearly = 0; // pairs that are twins though they differ by more than the tolerance
    // Faces that overlap but have different shapes: what falls on one would be lost.
    std::vector<std::pair<uint32_t, uint32_t>> odd;
};

// Makes twins of the pairs of faces, where all of them can be: glass without holes, back to back, opposite
// one another in place as in shape to within 7 degrees and a tenth of the longest side. None without.
std::optional<GlassPairs> pairAsSaid(Building& building, std::span<const std::pair<uint32_t, uint32_t>> pairs,
                                     double tolerance);

// Makes twins of faces of glass (materials that are openings, without holes) that stand back to back no
// farther apart than a wall is thick (a twentieth of `extent`, and 0.3 of the height in y of the lower of
// their rooms) and have one shape to within `tolerance`. A corner that only one side has, because something
// meets its edge there, is put into the other side's edge. What is left is twinned, too, where faces differ
// as those of closeSketch()'s walls may, whose sides are not quite parallel: in shape and in place by 7
// degrees and a tenth of their length. In any unit, as the file is; `extent`: of the model.
GlassPairs pairGlasses(Building& building, double tolerance, double extent);

} // namespace heliodon::geometry
