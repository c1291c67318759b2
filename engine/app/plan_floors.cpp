#include "engine/app/plan_floors.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "compute/lighting.h"
#include "geometry/floors.h"

namespace heliodon::app {

namespace {

// Building metres: what looks up so far above the rest of its room is a floor of its own, and upper floor
// (geometry/floors.h) that lies a person's height above the last.
constexpr double kApart = 2.4;
constexpr double kOnFloor = 1e-6; // world metres below a floor that a sensor on it may be by rounding

struct Level {
    std::vector<size_t> patches; // that look up, of one room, from the lowest
    bool isUpper;                // whether upper floor begins it
    std::set<size_t> walked{};   // of these, floor of several heights
};

// Apart where a person stands between.
std::vector<Level> levelsOf(const geometry::PatchMesh& mesh, double worldPerBuilding) {
    std::map<uint32_t, std::vector<std::pair<double, size_t>>> rooms;
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        if (geometry::patchNormal(mesh, i).y > 0.5)
            rooms[mesh.room[i]].emplace_back(geometry::patchCentroid(mesh, i).y, i);
    const geometry::Floors walked = geometry::findFloors(mesh, worldPerBuilding);
    std::vector<bool> isUpper(mesh.patchCount()), isWalked(mesh.patchCount());
    for (const size_t i : walked.upper) isUpper[i] = isWalked[i] = true;
    for (const size_t i : walked.lowest) isWalked[i] = true;
    std::vector<Level> levels;
    for (auto& [room, patches] : rooms) {
        std::ranges::sort(patches);
        double first = 0, last = -1e300;
        for (const auto& [height, patch] : patches) {
            const bool begins = isUpper[patch] && height - first > geometry::kHeadroom * worldPerBuilding;
            if (height - last > kApart * worldPerBuilding || begins)
                levels.push_back({{}, isUpper[patch]}), first = height;
            levels.back().patches.push_back(patch), last = height;
            if (isWalked[patch]) levels.back().walked.insert(patch);
        }
    }
    const auto height = [&](size_t i) { return geometry::patchCentroid(mesh, i).y; };
    for (Level& level : levels) {
        const auto [low, high] = std::ranges::minmax_element(level.walked, {}, height);
        if (!level.walked.empty() && height(*high) - height(*low) <= geometry::kFloorStep * worldPerBuilding)
            level.walked.clear();
    }
    return levels;
}

std::vector<PlanFloor> floorsOf(const geometry::PatchMesh& mesh, const std::vector<Level>& levels) {
    std::vector<PlanFloor> floors;
    for (const auto& [patches, isUpper, walked] : levels)
        floors.push_back({mesh.room[patches[0]], geometry::patchCentroid(mesh, patches[0]).y, patches,
                          FloorCells(mesh, patches), borders(mesh, patches)});
    return floors;
}

// The highest floor below p; none where no floor is.
size_t floorBelow(const std::vector<PlanFloor>& floors, glm::dvec3 p) {
    size_t best = floors.size();
    for (size_t f = 0; f < floors.size(); ++f)
        if (floors[f].height <= p.y + kOnFloor &&
            (best == floors.size() || floors[f].height > floors[best].height) &&
            floors[f].cells.covers(flat(p)))
            best = f;
    return best;
}

// What a plan shows as floor: not the tops of walls that no sensor stands above, nor galleries without any
// where there are sensors.
std::vector<Level> levelsShown(const geometry::PatchMesh& mesh, const PlanValues& given,
                               std::vector<Level> levels) {
    const std::vector<PlanFloor> floors = floorsOf(mesh, levels);
    double above = -1e300; // its floor, of the sensor that stands highest over one
    std::vector<bool> used(floors.size());
    for (size_t s = 0; s < given.points.size(); ++s) {
        if (given.normals[s].y < 0.5) continue;
        const size_t f = floorBelow(floors, given.points[s]);
        if (f == floors.size()) continue;
        const glm::dvec3 p = given.points[s];
        double under = floors[f].height;
        for (const size_t i : levels[f].walked)
            if (const double h = geometry::heightAt(mesh, i, p.x, p.z, 0); h <= p.y)
                under = std::max(under, h);
        used[f] = true, above = std::max(above, p.y - under);
    }
    std::vector<Level> shown;
    for (size_t f = 0; f < floors.size(); ++f) {
        const bool isStorey = levels[f].isUpper && given.points.empty();
        if (!used[f] && !isStorey && f > 0 && floors[f].room == floors[f - 1].room) continue;
        if (!given.points.empty())
            std::erase_if(levels[f].patches, [&](size_t i) {
                return !levels[f].walked.contains(i) &&
                       geometry::patchCentroid(mesh, i).y > floors[f].height + std::max(above, 0.0);
            });
        shown.push_back(std::move(levels[f]));
    }
    return shown;
}

// Sensors by the floor that they stand over.
void sortIn(const PlanValues& given, std::vector<PlanFloor>& floors) {
    std::set<std::array<int64_t, 3>> taken;
    for (size_t s = 0; s < given.points.size(); ++s) {
        if (given.normals[s].y < 0.5) continue;
        const glm::dvec2 p = flat(given.points[s]);
        const size_t f = floorBelow(floors, given.points[s]);
        if (f == floors.size() ||
            !taken.insert({std::llround(p.x * 1e5), std::llround(p.y * 1e5), static_cast<int64_t>(f)}).second)
            continue;
        PlanFloor& floor = floors[f];
        floor.samples.push_back({p, given.values[s], given.points[s].y});
        if (!given.sunPatches) continue;
        floor.shaded.push_back({p, given.values[s] - given.sun[s], given.points[s].y});
        if (floor.samples.size() == 1) floor.sun.emplace();
        if (given.normals[s].y < 1 - 1e-6) floor.sun.reset();
    }
}

// Storeys of floors with these patches, from the lowest; those without a sensor are left out where others
// have some.
void findStoreys(const geometry::PatchMesh& mesh, const std::vector<Level>& levels,
                 std::vector<PlanFloor>& floors) {
    const auto liesOver = [&](size_t a, size_t b) {
        return std::ranges::any_of(levels[a].patches, [&](size_t i) {
            return floors[b].cells.covers(flat(geometry::patchCentroid(mesh, i)));
        });
    };
    std::vector<size_t> upwards(floors.size());
    for (size_t f = 0; f < floors.size(); ++f) upwards[f] = f;
    std::ranges::stable_sort(upwards, {}, [&](size_t f) { return floors[f].height; });
    std::vector<std::vector<size_t>> storeys;
    std::vector<double> heights;              // of each, its first floor's
    for (int round = 0; round < 2; ++round) { // the second knows all heights
        storeys.assign(heights.size(), {});
        for (size_t f : upwards) {
            size_t best = storeys.size();
            const auto off = [&](size_t storey) { return std::abs(heights[storey] - floors[f].height); };
            for (size_t k = 0; k < storeys.size(); ++k) {
                const bool isFree = std::ranges::none_of(
                    storeys[k], [&](size_t other) { return liesOver(f, other) || liesOver(other, f); });
                if (isFree && (best == storeys.size() || off(k) < off(best))) best = k;
            }
            if (best == storeys.size()) storeys.emplace_back(), heights.push_back(floors[f].height);
            storeys[best].push_back(f);
        }
    }
    const bool any = std::ranges::any_of(floors, [](const PlanFloor& f) { return !f.samples.empty(); });
    std::erase_if(storeys, [&](const std::vector<size_t>& storey) {
        return storey.empty() ||
               (any && std::ranges::all_of(storey, [&](size_t f) { return floors[f].samples.empty(); }));
    });
    std::vector<PlanFloor> shown;
    for (size_t storey = 0; storey < storeys.size(); ++storey)
        for (size_t f : storeys[storey]) {
            floors[f].storey = storey;
            shown.push_back(std::move(floors[f]));
        }
    floors = std::move(shown);
}

// An opening belongs to the highest floor of its room below its middle, else to the lowest.
void findOpenings(const geometry::PatchMesh& mesh, std::vector<PlanFloor>& floors) {
    std::vector<std::vector<size_t>> openings(floors.size());
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        if (!mesh.materials[mesh.material[i]].isOpening()) continue;
        const double middle = geometry::patchCentroid(mesh, i).y;
        size_t best = floors.size();
        for (size_t f = 0; f < floors.size(); ++f)
            if (floors[f].room == mesh.room[i] && (best == floors.size() || floors[f].height <= middle))
                best = f;
        if (best < floors.size()) openings[best].push_back(i);
    }
    for (size_t f = 0; f < floors.size(); ++f) floors[f].openings = borders(mesh, openings[f]);
}

// Where a level plane cuts patches of a room; the room's air lies on the side on which floors lie of their
// outlines' edges.
Edges sectionOf(const geometry::PatchMesh& mesh, uint32_t room, double y) {
    Edges section;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        if (mesh.room[i] != room) continue;
        const auto corners = mesh.patch(i); // convex: cut twice or not at all
        std::array<glm::dvec3, 2> edge;
        size_t ends = 0;
        for (size_t k = 0; k < corners.size(); ++k) {
            const glm::dvec3 a = mesh.vertices[corners[k]],
                             b = mesh.vertices[corners[(k + 1) % corners.size()]];
            if ((a.y > y) != (b.y > y) && ends < 2) edge[ends++] = glm::mix(a, b, (y - a.y) / (b.y - a.y));
        }
        if (ends < 2) continue;
        const glm::dvec2 along = flat(edge[1]) - flat(edge[0]), air = flat(geometry::patchNormal(mesh, i));
        if (along.y * air.x - along.x * air.y < 0) std::swap(edge[0], edge[1]);
        section.push_back(edge);
    }
    return section;
}

// What the sensors' plane cuts without reaching the floor, as a cupboard on its feet, is no floor there and
// has an outline.
void leaveOutSolids(const Scene& scene, PlanFloor& floor) {
    const double same = 1e-3 * scene.worldPerBuilding;
    const auto heights = std::ranges::minmax_element(floor.samples, {}, &Sample::height);
    if (floor.samples.empty() || heights.max->height - heights.min->height > same) return;
    Edges section = sectionOf(scene.mesh, floor.room, heights.min->height);
    Edges cuts;
    for (const auto& [a, b] : section) {
        const glm::dvec2 along = flat(b) - flat(a);
        const double length = glm::length(along);
        if (length < 1e-9) continue;
        const glm::dvec2 behind = same / length * glm::dvec2(-along.y, along.x);
        if (floor.cells.covers(0.5 * (flat(a) + flat(b)) + behind)) cuts.push_back({a, b});
    }
    if (cuts.empty()) return;
    floor.section = std::move(section);
    floor.outline.insert(floor.outline.end(), cuts.begin(), cuts.end());
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

bool PlanFloor::isOpenAt(glm::dvec2 p) const {
    if (!cells.covers(p)) return false;
    bool inside = section.empty(); // the room, whose surfaces to the right of p are odd in number
    for (const auto& [a, b] : section)
        if ((a.z > p.y) != (b.z > p.y) && a.x + (p.y - a.z) / (b.z - a.z) * (b.x - a.x) > p.x)
            inside = !inside;
    return inside;
}

Edges borders(const geometry::PatchMesh& mesh, const std::vector<size_t>& patches) {
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
    Edges result;
    for (const auto& [keys, edge] : edges) result.push_back(edge);
    return result;
}

std::vector<PlanFloor> planFloors(const Scene& scene, const PlanValues& given) {
    const geometry::PatchMesh& mesh = scene.mesh;
    const std::vector<Level> levels = levelsShown(mesh, given, levelsOf(mesh, scene.worldPerBuilding));
    std::vector<PlanFloor> floors = floorsOf(mesh, levels);
    sortIn(given, floors);
    findStoreys(mesh, levels, floors);
    findOpenings(mesh, floors);
    for (PlanFloor& floor : floors) {
        if (floor.sun) findSunlight(scene, given, floor);
        leaveOutSolids(scene, floor);
    }
    return floors;
}

std::string storeyInWords(const std::vector<PlanFloor>& floors, double worldPerBuilding) {
    const double lowest = std::ranges::min_element(floors, {}, &PlanFloor::height)->height;
    return fmt::format("floors from {:.2f} m", lowest / worldPerBuilding);
}

} // namespace heliodon::app
