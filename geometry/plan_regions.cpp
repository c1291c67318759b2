#include "geometry/plan_regions.h"

#include <algorithm>
#include <map>

#include <glm/geometric.hpp>

#include "geometry/disjoint_sets.h"

namespace heliodon::geometry {

namespace {

double loopArea(const PlanArrangement& map, const std::vector<uint32_t>& loop) {
    double sum = 0;
    for (const uint32_t h : loop) {
        const glm::dvec2 a = map.points[map.source(h)], b = map.points[map.target[h]];
        sum += 0.5 * (a.x * b.y - a.y * b.x);
    }
    return sum;
}

} // namespace

std::vector<double> cellAreas(const PlanArrangement& map) {
    std::vector<double> areas(map.cellCount, 0);
    for (uint32_t h = 0; h < map.cell.size(); ++h) {
        const glm::dvec2 a = map.points[map.source(h)], b = map.points[map.target[h]];
        areas[map.cell[h]] += 0.5 * (a.x * b.y - a.y * b.x);
    }
    return areas;
}

std::vector<PlanRegion> traceRegions(const PlanArrangement& map, const std::vector<int>& labels) {
    DisjointSets cells(map.cellCount);
    for (uint32_t h = 0; h < map.cell.size(); h += 2)
        if (labels[map.cell[h]] == labels[map.cell[h + 1]]) cells.join(map.cell[h], map.cell[h + 1]);

    const auto isBoundary = [&](uint32_t h) {
        return labels[map.cell[h]] >= 0 && labels[map.cell[h]] != labels[map.cell[h ^ 1u]];
    };
    std::vector<PlanRegion> regions;
    std::map<uint32_t, size_t> regionOf;
    std::vector<bool> seen(map.cell.size());
    for (uint32_t start = 0; start < map.cell.size(); ++start) {
        if (seen[start] || !isBoundary(start)) continue;
        const auto [place, isNew] = regionOf.try_emplace(cells.root(map.cell[start]), regions.size());
        if (isNew) regions.push_back({labels[map.cell[start]], {}});
        std::vector<uint32_t> loop;
        uint32_t h = start;
        do {
            seen[h] = true;
            loop.push_back(h);
            // Round the target through the cells of this region to its next boundary.
            h = map.next[h];
            while (!isBoundary(h)) h = map.next[h ^ 1u];
        } while (h != start);
        regions[place->second].loops.push_back(std::move(loop));
    }
    for (PlanRegion& region : regions)
        std::ranges::stable_sort(region.loops, std::greater(),
                                 [&](const auto& loop) { return loopArea(map, loop); });
    return regions;
}

void absorbThinCells(const PlanArrangement& map, std::vector<int>& labels, double width) {
    const std::vector<double> areas = cellAreas(map);
    std::vector<double> perimeter(map.cellCount, 0);
    std::vector<std::pair<double, int>> best(map.cellCount, {0.0, -1});
    for (uint32_t h = 0; h < map.cell.size(); ++h) {
        const uint32_t own = map.cell[h], other = map.cell[h ^ 1u];
        if (own == other) continue;
        const double length = glm::length(map.points[map.target[h]] - map.points[map.source(h)]);
        perimeter[own] += length;
        const bool thick =
            2 * areas[other] > width * 0.5 * length; // a cell much thinner than its edge is no host
        if (labels[other] >= 0 && thick) best[own] = std::max(best[own], std::pair(length, labels[other]));
    }
    for (uint32_t c = 1; c < map.cellCount; ++c)
        if (labels[c] >= 0 && best[c].second >= 0 && 2 * areas[c] < width * perimeter[c])
            labels[c] = best[c].second;
}

} // namespace heliodon::geometry
