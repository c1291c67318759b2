// Cells of an arrangement with equal labels -> polygons with holes.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "geometry/plan_arrangement.h"

namespace heliodon::geometry {

// Connected cells of one label. Loops have the region on their left: the outline counter-clockwise and first,
// holes clockwise. Corner k of a loop is the source of half-edge k.
struct PlanRegion {
    int label = 0;
    std::vector<std::vector<uint32_t>> loops; // half-edges
};

// Regions of all labels >= 0, in the order of their first half-edge.
std::vector<PlanRegion> traceRegions(const PlanArrangement& map, const std::vector<int>& labels);

// Cells with 2 area / perimeter below `width` take the label of the neighbour with the longest common edge.
// Only cells whose label is >= 0 are looked at, and only such neighbours.
void absorbThinCells(const PlanArrangement& map, std::vector<int>& labels, double width);

// Per cell: how many of the closed counter-clockwise polygons lie over it. `isEdge(tag)` says whether the
// segment of that tag is an edge of one of them.
template<class IsEdge> std::vector<int> coverage(const PlanArrangement& map, IsEdge isEdge);

// The same of all polygons at once: per cell how many times each lies over it, none where that is 0.
// `polygonOf(tag)`: from 0 on, below 0 for a segment that is no edge of one. Cost: cells times what lies over
// one.
template<class PolygonOf>
std::vector<std::map<int32_t, int>> coverageOfEach(const PlanArrangement& map, PolygonOf polygonOf);

// Signed area of each cell, net of its holes; the unbounded cell's is minus the rest.
std::vector<double> cellAreas(const PlanArrangement& map);

// Calls step(from, to, h) for each cell but the unbounded one, after that of the cell `from` that half-edge h
// has on its left, `to` on its right.
template<class Step> void walkCells(const PlanArrangement& map, const Step& step) {
    std::vector<std::vector<uint32_t>> halves(map.cellCount);
    for (uint32_t h = 0; h < map.cell.size(); ++h) halves[map.cell[h]].push_back(h);
    std::vector<bool> known(map.cellCount, false);
    std::vector<uint32_t> queue{0};
    known[0] = true;
    for (size_t i = 0; i < queue.size(); ++i)
        for (const uint32_t h : halves[queue[i]]) {
            const uint32_t other = map.cell[h ^ 1u];
            if (known[other]) continue;
            known[other] = true;
            step(queue[i], other, h);
            queue.push_back(other);
        }
}

template<class IsEdge> std::vector<int> coverage(const PlanArrangement& map, IsEdge isEdge) {
    std::vector<int> depth(map.cellCount, 0);
    walkCells(map, [&](uint32_t from, uint32_t to, uint32_t h) {
        depth[to] = depth[from];
        for (const PlanArrangement::Tag& tag : map.tags[h / 2])
            if (isEdge(tag.tag)) depth[to] -= tag.forward == (h % 2 == 0) ? 1 : -1;
    });
    return depth;
}

template<class PolygonOf>
std::vector<std::map<int32_t, int>> coverageOfEach(const PlanArrangement& map, PolygonOf polygonOf) {
    std::vector<std::map<int32_t, int>> depth(map.cellCount);
    walkCells(map, [&](uint32_t from, uint32_t to, uint32_t h) {
        depth[to] = depth[from];
        for (const PlanArrangement::Tag& tag : map.tags[h / 2]) {
            const int32_t polygon = polygonOf(tag.tag);
            if (polygon < 0) continue;
            const auto own = depth[to].try_emplace(polygon, 0).first;
            own->second -= tag.forward == (h % 2 == 0) ? 1 : -1;
            if (own->second == 0) depth[to].erase(own);
        }
    });
    return depth;
}

} // namespace heliodon::geometry
