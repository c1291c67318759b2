// Sheets without thickness that stand in rooms, as curtains, screens and rugs, as thin boards.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "geometry/face_soup.h"

namespace heliodon::geometry {

struct SheetBoards {
    std::vector<SoupFace> faces; // all, boards in place of sheets
    size_t first = 0;            // where the boards begin
    size_t sheets = 0;           // faces that became boards
    uint32_t surface = 0;        // of the first
};

// Each face of which a part hangs open (geometry/open_sheets) within what the others enclose becomes, with
// those that it shares an edge with, a closed board whose faces look out of it, each side with its material:
// `thickness` (metres), half on either side, but back to a wall that is parallel and `near` at most (where
// that has no thickness and a room behind, the wall's material is seen there, and one that leans is all
// before it), and to walls and glass together that it would reach into; a rim on a wall or floor keeps to
// that, however the sheet leans, unless it lies within 12 degrees of it. Glass (`isGlass` of a material) is
// none. None where there is no such face, or one has one side alone, like a Moebius strip, ends before a wall
// by less than a quarter of `near` (it was to reach it), or has two edges or more with other faces as they
// were `drawn` (what is left of a body that lacks one), but those where others meet without it, unless
// another such sheet is parallel and 25 times `near` away at most. Where some stand on faces that lie on
// others and have edges with such sheets alone, as the bottom of a box without a lid, once more with these;
// where faces close a room with a part of them, as a wall with an open door that stands on above the ceiling
// of a lower room, once more with what hangs open alone. Corners are one within `tolerance` (metres). Cost:
// that of openSheets().
std::vector<SheetBoards> sheetsAsBoards(const std::vector<SoupFace>& faces,
                                        const std::vector<SoupFace>& drawn,
                                        const std::function<bool(uint32_t)>& isGlass, double thickness,
                                        double near, double tolerance);

} // namespace heliodon::geometry
