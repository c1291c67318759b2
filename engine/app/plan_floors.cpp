#include "engine/app/plan_floors.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include <glm/common.hpp>

#include "compute/lighting.h"

namespace heliodon::app {

namespace {

// Tops of walls that no sensor stands above, `top` being the highest, are no floor.
std::vector<PlanFloor> floorsOf(const geometry::PatchMesh& mesh, double top) {
    std::map<uint32_t, std::vector<size_t>> floors;
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        if (geometry::patchNormal(mesh, i).y > 0.5 && geometry::patchCentroid(mesh, i).y <= top)
            floors[mesh.room[i]].push_back(i);
    std::vector<PlanFloor> result;
    for (const auto& [room, patches] : floors)
        result.push_back({FloorCells(mesh, patches), borders(mesh, patches)});
    return result;
}

// Sensors by the floor that they stand over.
void sortIn(const PlanValues& given, std::vector<PlanFloor>& floors) {
    std::set<std::pair<int64_t, int64_t>> taken;
    for (size_t s = 0; s < given.points.size(); ++s) {
        const glm::dvec2 p = flat(given.points[s]);
        if (given.normals[s].y < 0.5 ||
            !taken.insert({std::llround(p.x * 1e5), std::llround(p.y * 1e5)}).second)
            continue;
        const auto floor =
            std::ranges::find_if(floors, [&](const PlanFloor& f) { return f.cells.covers(p); });
        if (floor == floors.end()) continue;
        floor->samples.push_back({p, given.values[s], given.points[s].y});
        if (!given.sunPatches) continue;
        floor->shaded.push_back({p, given.values[s] - given.sun[s], given.points[s].y});
        if (floor->samples.size() == 1) floor->sun.emplace();
        if (given.normals[s].y < 1 - 1e-6) floor->sun.reset();
    }
}

void findSunlight(const Scene& scene, const PlanValues& given, PlanFloor& floor) {
    constexpr size_t kMostPlanes = 8;
    const double same = 1e-3 * scene.worldPerBuilding;
    glm::dvec2 low(1e300), high(-1e300);
    for (const auto& [a, b] : floor.outline) low = glm::min(low, flat(a)), high = glm::max(high, flat(a));
    Sunlight& sun = *floor.sun;
    for (const Sample& s : floor.samples)
        if (std::ranges::none_of(sun.heights, [&](double h) { return std::abs(h - s.height) < same; }))
            sun.heights.push_back(s.height);
    if (sun.heights.size() > kMostPlanes) return floor.sun.reset();
    for (size_t plane = 0; plane < sun.heights.size(); ++plane) {
        const double y = sun.heights[plane];
        const std::array corners{glm::dvec3(low.x, y, low.y), glm::dvec3(low.x, y, high.y),
                                 glm::dvec3(high.x, y, high.y), glm::dvec3(high.x, y, low.y)};
        for (const compute::SunlitParts::Part& part : given.sunPatches->onPolygon(corners)) {
            Points polygon;
            std::ranges::transform(part.polygon, std::back_inserter(polygon), flat);
            std::ranges::reverse(polygon); // as isWithin() has it: seen from above z runs down
            sun.parts.push_back({plane, std::move(polygon), given.sunLux * compute::photometric(part.light)});
        }
    }
}

} // namespace

std::vector<std::array<glm::dvec3, 2>> borders(const geometry::PatchMesh& mesh,
                                               const std::vector<size_t>& patches) {
    using Key = std::array<int64_t, 3>;
    const auto key = [](glm::dvec3 p) {
        return Key{std::llround(p.x * 1e6), std::llround(p.y * 1e6), std::llround(p.z * 1e6)};
    };
    std::map<std::pair<Key, Key>, std::array<glm::dvec3, 2>> edges;
    for (size_t i : patches) {
        const auto corners = mesh.patch(i);
        for (size_t k = 0; k < corners.size(); ++k) {
            const glm::dvec3 a = mesh.vertices[corners[k]],
                             b = mesh.vertices[corners[(k + 1) % corners.size()]];
            if (!edges.erase({key(b), key(a)})) edges.insert({{key(a), key(b)}, {a, b}});
        }
    }
    std::vector<std::array<glm::dvec3, 2>> result;
    for (const auto& [keys, edge] : edges) result.push_back(edge);
    return result;
}

std::vector<PlanFloor> planFloors(const Scene& scene, const PlanValues& given) {
    double top = -1e300;
    for (size_t s = 0; s < given.points.size(); ++s)
        if (given.normals[s].y >= 0.5) top = std::max(top, given.points[s].y);
    std::vector<PlanFloor> floors = floorsOf(scene.mesh, top);
    sortIn(given, floors);
    for (PlanFloor& floor : floors)
        if (floor.sun) findSunlight(scene, given, floor);
    return floors;
}

} // namespace heliodon::app
