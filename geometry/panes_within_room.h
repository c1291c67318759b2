// Glass in a wall that air runs round, as beside a door that stands open: one room on both its sides.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/face_soup.h"

namespace heliodon::geometry {

struct PanesWithinRoom {
    std::vector<SoupFace> soup;
    size_t panes = 0;
    // SoupFace::surface of such a pane and of what is opaque and lies on it; nothing else where there is one.
    std::optional<std::pair<uint32_t, uint32_t>> covered;
};

// A shell may not touch itself: in the place of each flat pane that one bounded part of space is on both
// sides of, two of its material, 50 `tolerance` (metres) apart in the hole (PaneFitter), which look away from
// one another. Both have one twinKey, by which divideSpace() knows what is between them for glass. None where
// there is no such pane, or an edge is open that is none of openSheets(). Cost: that of cutIntoSheets().
std::optional<PanesWithinRoom> panesWithinRoom(const std::vector<SoupFace>& soup,
                                               const std::function<bool(uint32_t)>& isGlass,
                                               double tolerance);

} // namespace heliodon::geometry
