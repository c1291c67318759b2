// Panes that a model draws as they are built, as slabs that reach into frames -> the faces that rooms need.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "geometry/face_soup.h"

namespace heliodon::geometry {

struct PanesInHoles {
    std::vector<SoupFace> soup;
    size_t slabs = 0, flat = 0; // panes that are other ones now
};

enum class Drawn { slabs, slabsAndFlat };

// In the place of each slab that stands in a hole (PaneFitter), what of its middle lies there; where nothing
// does, what of its two sides lies in holes (both where it is glass between two rooms). A slab is a closed
// body whose faces are all of one glass (`isGlass` of a material): two flat sides of one shape, no farther
// apart than a fifth of their size, and what joins them at right angles. Drawn::slabsAndFlat: so also flat
// panes that are larger or smaller than their hole. Corners are one within `tolerance` (metres). None where
// nothing is to be changed. Cost: O(n log n) for n faces, and for each pane what is near it.
std::optional<PanesInHoles> panesInHoles(const std::vector<SoupFace>& soup,
                                         const std::function<bool(uint32_t)>& isGlass, double tolerance,
                                         Drawn drawn);

} // namespace heliodon::geometry
