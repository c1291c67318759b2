// Panes that a model draws as bodies of glass, as they are built -> the one face each that the rooms need.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "geometry/face_soup.h"

namespace heliodon::geometry {

struct PanesOfSlabs {
    std::vector<SoupFace> soup;
    size_t slabs = 0;
};

// In the place of each slab that stands in a hole, the faces of its one side, moved into its middle where that
// fits (a reveal), else where they are; of both sides where both fit and the middle does not (glass between
// two rooms). A slab is a closed body whose faces are all of one glass (`isGlass` of a material): two flat
// sides of one shape, no farther apart than a fifth of their size, and what joins them at right angles. It
// fits where its corners lie on edges of other faces, within `tolerance` (metres). None where there is no
// such slab. Cost: O(n log n) for n faces.
std::optional<PanesOfSlabs> slabsAsPanes(const std::vector<SoupFace>& soup,
                                         const std::function<bool(uint32_t)>& isGlass, double tolerance);

} // namespace heliodon::geometry
