// The grid of a flat wall seen from the room: where its stretches, heights and windows divide it, as polygons
// with holes.
#pragma once

#include <cstdint>
#include <vector>

namespace heliodon::geometry {

struct GridPoint {
    uint32_t column = 0, row = 0;
    bool operator==(const GridPoint&) const = default;
};

struct GridFace {
    int label = 0;
    // Outline counter-clockwise and first, holes clockwise, with columns to the right and rows up. Only
    // corners, and the points where `keep` is set.
    std::vector<std::vector<GridPoint>> loops;
};

// `labels` has columns x rows cells, row by row from below; cells with a negative label are no part of any
// face. Cells with equal labels that share an edge are one face. `keep`, of (columns + 1) x (rows + 1)
// points, may be empty. A face that would touch itself in a point is two, left and right of it.
std::vector<GridFace> gridFaces(uint32_t columns, uint32_t rows, const std::vector<int>& labels,
                                const std::vector<bool>& keep = {});

} // namespace heliodon::geometry
