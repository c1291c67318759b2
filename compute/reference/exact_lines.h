// What shaders/exact_lines.comp computes, in serial double precision.
#pragma once

#include <array>
#include <span>

#include "compute/reference/exact_form_factors.h"

namespace heliodon::compute::reference {

using Triangle = std::array<glm::dvec3, 3>;

struct LinesPair {
    Triangle outer, inner; // counter-clockwise as seen from their fronts; the first carries the points
    uint32_t outerPiece = 0, innerPiece = 0; // their numbers, from which lines are jittered
    std::span<const Polygon> blockers;       // convex, of at most four corners
};

// Form factor from `outer` to what is seen of `inner` along four lines from each point, and its estimated
// error. Refined, at most `levels` times, until that is below `tolerance`, which holds for the larger of both
// form factors. `inner` must lie in front of `outer` and the other way round. Cost: 1 to 4^(levels + 1)
// points.
Estimate formFactorAlongLines(const LinesPair& pair, double tolerance, uint32_t levels);

} // namespace heliodon::compute::reference
