#include "geometry/pane_in_hole.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "geometry/disjoint_sets.h"
#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"
#include "geometry/plan_arrangement.h"
#include "geometry/plan_regions.h"
#include "geometry/ray_crossing.h"
#include "geometry/segment_distance.h"
#include "geometry/shell_faces.h"

namespace heliodon::geometry {

namespace {

using glm::dvec2;
using glm::dvec3;

constexpr double kReach = 0.005;    // of the pane's diagonal
constexpr double kMostReach = 0.7;  // of it, of what is taken for a joint
constexpr double kLeastPart = 0.5;  // of the pane's area
constexpr size_t kMostOfBar = 1000; // faces
constexpr double kSharp = 0.1;      // the squared sum of two unit normals: a corner of 18 degrees
constexpr double kBesideEdge = 10;  // tolerances: what is surely on one side of an edge
enum Tag : int32_t { kPane, kSection, kWall };
constexpr uint32_t kNoShell = std::numeric_limits<uint32_t>::max();
using Ends = std::array<dvec2, 2>;

struct Plane {
    dvec3 origin, normal, u, v;

    dvec2 flat(dvec3 p) const { return {glm::dot(p - origin, u), glm::dot(p - origin, v)}; }
    double height(dvec3 p) const { return glm::dot(p - origin, normal); }
    dvec3 back(dvec2 p) const { return origin + p.x * u + p.y * v; }
};

Plane planeOf(const SoupFace& face, dvec3 shift) {
    const dvec3 normal = glm::normalize(areaVector(face.loops[0])), u = perpendicular(normal);
    return {face.loops[0][0] + shift, normal, u, glm::cross(normal, u)};
}

double areaOf(std::span<const dvec2> outline) {
    double twice = 0;
    for (size_t k = 1; k + 1 < outline.size(); ++k)
        twice += cross(outline[k] - outline[0], outline[k + 1] - outline[0]);
    return 0.5 * twice;
}

class PlaneSection {
public:
    PlaneSection(const Plane& plane, double tolerance) : plane_(plane), tolerance_(tolerance) {}

    void addOutline(std::span<const dvec2> outline, Tag tag) {
        for (size_t k = 0; k < outline.size(); ++k)
            addSegment(outline[k], outline[(k + 1) % outline.size()], tag);
    }
    void addSegment(dvec2 a, dvec2 b, Tag tag) {
        if (a != b) segments_.push_back({a, b, tag});
    }

    void add(const SoupFace& face) {
        double most = 0;
        for (const auto& loop : face.loops)
            for (const dvec3 p : loop) most = std::max(most, std::abs(plane_.height(p)));
        if (most > tolerance_) {
            const std::vector<Ends> above = cutOf(face, 1), below = cutOf(face, -1);
            addSection(above, wayOf(face));
            if (below != above) addSection(below, wayOf(face));
            return;
        }
        const bool over = glm::dot(areaVector(face.loops[0]), plane_.normal) < 0;
        for (const auto& loop : face.loops) {
            std::vector<dvec2> outline;
            for (const dvec3 p : loop) outline.push_back(plane_.flat(p));
            if (over) std::ranges::reverse(outline);
            addOutline(outline, kWall);
        }
    }

    // Where the face crosses the plane; corners in the plane count as on the side `ofZero`.
    std::vector<Ends> cutOf(const SoupFace& face, double ofZero) const {
        std::vector<dvec2> points;
        for (const auto& loop : face.loops)
            for (size_t k = 0; k < loop.size(); ++k) {
                const dvec3 a = loop[k], b = loop[(k + 1) % loop.size()];
                const double from = heightOf(a), to = heightOf(b);
                if ((from == 0 ? ofZero : from) * (to == 0 ? ofZero : to) < 0)
                    points.push_back(plane_.flat(a + (b - a) * (from / (from - to))));
            }
        const dvec2 way = wayOf(face);
        std::ranges::sort(points, {}, [&](dvec2 p) { return glm::dot(p, way); });
        std::vector<Ends> out;
        for (size_t k = 0; k + 1 < points.size(); k += 2) out.push_back({points[k], points[k + 1]});
        return out;
    }

    const std::vector<PlanSegment>& segments() const { return segments_; }

private:
    // Faces that meet within the tolerance leave no gap: beyond their ends, where those of others run on, and
    // beside them, where lines that are one but for rounding pass each other by.
    void addSection(const std::vector<Ends>& cut, dvec2 way) {
        const dvec2 over = 2 * tolerance_ * way, aside(-over.y, over.x);
        for (const auto& [a, b] : cut) {
            segments_.push_back({a - over, b + over, kSection});
            for (const dvec2 end : {a, b}) segments_.push_back({end - aside, end + aside, kSection});
        }
    }

    // Along the line in which a face crosses the plane.
    dvec2 wayOf(const SoupFace& face) const {
        const dvec3 along = glm::cross(plane_.normal, areaVector(face.loops[0]));
        return glm::normalize(dvec2(glm::dot(along, plane_.u), glm::dot(along, plane_.v)));
    }
    double heightOf(dvec3 p) const {
        const double height = plane_.height(p);
        return std::abs(height) <= tolerance_ ? 0 : height;
    }

    const Plane& plane_;
    double tolerance_;
    std::vector<PlanSegment> segments_;
};

// Without the corners on straight lines, where sections of several faces meet.
std::vector<dvec2> cornersOf(const std::vector<dvec2>& outline, double tolerance) {
    std::vector<dvec2> out;
    for (size_t k = 0; k < outline.size(); ++k) {
        const bool isLast = k + 1 == outline.size() && !out.empty(); // the first may have gone for it
        const dvec2 before = out.empty() ? outline.back() : out.back(),
                    after = isLast ? out[0] : outline[(k + 1) % outline.size()];
        if (distanceToSegment(outline[k], before, after) > tolerance) out.push_back(outline[k]);
    }
    return out;
}

// The faces on the plane, all counter-clockwise: the edges that others of them do not run back along.
std::vector<Ends> bordersOf(const Plane& plane, std::span<const SoupFace> faces, double tolerance) {
    std::vector<SoupFace> flat(faces.begin(), faces.end());
    for (SoupFace& face : flat) {
        const bool over = glm::dot(areaVector(face.loops[0]), plane.normal) < 0;
        for (auto& loop : face.loops) {
            for (dvec3& p : loop) p = plane.back(plane.flat(p));
            if (over) std::ranges::reverse(loop);
        }
    }
    const Building welded = weldFaces(flat, 1, tolerance, true);
    std::map<std::array<uint32_t, 2>, int> times; // by their ends; negative: the other way
    for (const Face& face : welded.faces)
        for (const auto& loop : face.loops)
            for (size_t k = 0; k < loop.size(); ++k) {
                const uint32_t a = loop[k], b = loop[(k + 1) % loop.size()];
                if (a < b)
                    ++times[{a, b}];
                else
                    --times[{b, a}];
            }
    std::vector<Ends> out;
    for (const auto& [ends, count] : times) {
        const dvec2 a = plane.flat(welded.vertices[ends[0]]), b = plane.flat(welded.vertices[ends[1]]);
        for (int k = 0; k < std::abs(count); ++k) out.push_back(count > 0 ? Ends{a, b} : Ends{b, a});
    }
    return out;
}

// Per cell: a number that is one for what no wall parts, where all of that lies in the pane and none in a
// wall; else -1.
std::vector<int> holesIn(const PlanArrangement& map) {
    const std::vector<int> pane = coverage(map, [](int32_t tag) { return tag == kPane; }),
                           wall = coverage(map, [](int32_t tag) { return tag == kWall; });
    DisjointSets sets(map.cellCount);
    for (uint32_t e = 0; e < map.edgeCount(); ++e)
        if (std::ranges::all_of(map.tags[e], [](const auto& t) { return t.tag == kPane; }))
            sets.join(map.cell[2 * e], map.cell[2 * e + 1]);
    std::vector<bool> open(map.cellCount, false); // by root
    for (uint32_t c = 0; c < map.cellCount; ++c)
        if (pane[c] <= 0 || wall[c] > 0) open[sets.root(c)] = true;
    std::vector<int> labels(map.cellCount, -1);
    for (uint32_t c = 0; c < map.cellCount; ++c)
        if (!open[sets.root(c)]) labels[c] = static_cast<int>(sets.root(c));
    return labels;
}

// Per face: which closed shell it is of (each edge an even number of faces), or kNoShell where it is of none
// or of a large one.
std::vector<uint32_t> closedShells(const std::vector<SoupFace>& soup, std::span<const uint32_t> faces,
                                   double tolerance) {
    std::vector<SoupFace> numbered;
    for (uint32_t i = 0; i < faces.size(); ++i) {
        numbered.push_back(soup[faces[i]]);
        numbered.back().surface = i;
    }
    const Building welded = weldFaces(numbered, 1, tolerance);
    DisjointSets sets(welded.faces.size());
    std::vector<uint32_t> open;
    for (const auto& [edge, round] : facesOfEdges(welded)) {
        for (const uint32_t f : round) sets.join(f, round[0]);
        if (round.size() % 2 == 1) open.push_back(round[0]);
    }
    std::vector<bool> isOpen(welded.faces.size(), false); // by root
    for (const uint32_t f : open) isOpen[sets.root(f)] = true;
    std::vector<size_t> count(welded.faces.size(), 0); // by root
    for (uint32_t f = 0; f < welded.faces.size(); ++f) ++count[sets.root(f)];
    std::vector<uint32_t> out(faces.size(), kNoShell);
    for (uint32_t f = 0; f < welded.faces.size(); ++f)
        if (const uint32_t root = sets.root(f); !isOpen[root] && count[root] <= kMostOfBar)
            out[welded.faces[f].surface] = root;
    return out;
}

bool isInside(const std::vector<Ends>& cut, dvec2 p) {
    return std::ranges::count_if(cut, [&](const Ends& ends) { return rayCrosses(p, ends[0], ends[1]); }) % 2;
}

// A point of the region beside the middle of its longest edge, `near` it.
dvec2 pointIn(const std::vector<dvec2>& outline, double near) {
    dvec2 from(0), to(0);
    for (size_t k = 0; k < outline.size(); ++k) {
        const dvec2 a = outline[k], b = outline[(k + 1) % outline.size()];
        if (glm::length(b - a) > glm::length(to - from)) from = a, to = b;
    }
    const dvec2 along = glm::normalize(to - from);
    return 0.5 * (from + to) + near * dvec2(-along.y, along.x);
}

} // namespace

PaneFitter::PaneFitter(const std::vector<SoupFace>& soup, const std::function<bool(uint32_t)>& isGlass,
                       double tolerance)
    : soup_(soup), others_([&] {
          std::vector<uint32_t> others;
          for (uint32_t f = 0; f < soup.size(); ++f)
              if (!isGlass(soup[f].material)) others.push_back(f);
          return others;
      }()),
      boxes_([&] {
          std::vector<Bounds> boxes;
          for (const uint32_t f : others_) boxes.push_back(boundsOf(soup[f].loops[0]));
          return boxes;
      }()),
      shells_(closedShells(soup, others_, tolerance)), tree_(boxes_), tolerance_(tolerance) {
    for (uint32_t i = 0; i < shells_.size(); ++i)
        if (shells_[i] != kNoShell) facesOfShells_[shells_[i]].push_back(i);
}

struct PaneFitter::Cut {
    Plane plane;
    double area = 0; // of the pane
    PlanArrangement map;
    std::vector<std::vector<Ends>> solids; // where closed shells cross the plane
};

PaneFitter::Cut PaneFitter::cut(std::span<const uint32_t> pane, dvec3 shift, double reach) const {
    Cut out{planeOf(soup_[pane[0]], shift), 0, {}, {}};
    std::vector<SoupFace> drawn;
    std::vector<dvec3> corners;
    for (const uint32_t f : pane) {
        drawn.push_back(soup_[f]);
        double twice = 0;
        for (const auto& loop : drawn.back().loops) twice += glm::dot(areaVector(loop), out.plane.normal);
        out.area += 0.5 * std::abs(twice);
        for (const dvec3 p : drawn.back().loops[0]) corners.push_back(out.plane.back(out.plane.flat(p)));
    }
    const Bounds box = boundsOf(corners);
    reach *= box.diagonal();

    PlaneSection section(out.plane, tolerance_);
    for (const auto& [a, b] : bordersOf(out.plane, drawn, tolerance_)) {
        section.addSegment(a, b, kPane);
        const dvec2 along = reach * glm::normalize(b - a), aside(-along.y, along.x);
        section.addOutline(
            std::array{a - along - aside, b + along - aside, b + along + aside, a - along + aside}, kPane);
    }
    std::set<uint32_t> near; // shells
    tree_.anyHolding(box.high + reach + tolerance_, box.low - reach - tolerance_, [&](uint32_t i) {
        section.add(soup_[others_[i]]);
        if (shells_[i] != kNoShell) near.insert(shells_[i]);
        return false; // look at all
    });
    out.map = arrange(section.segments());
    for (const uint32_t shell : near) {
        out.solids.emplace_back();
        for (const uint32_t i : facesOfShells_.at(shell))
            for (const Ends& ends : section.cutOf(soup_[others_[i]], 1)) out.solids.back().push_back(ends);
    }
    return out;
}

std::vector<SoupFace> PaneFitter::fit(std::span<const uint32_t> pane, dvec3 shift, double reach) const {
    const auto& [plane, area, map, solids] = cut(pane, shift, reach);
    std::vector<int> labels = holesIn(map);
    absorbThinCells(map, labels, tolerance_);
    std::vector<SoupFace> out;
    double left = 0;
    for (const PlanRegion& region : traceRegions(map, labels)) {
        SoupFace face = soup_[pane[0]];
        face.loops.clear();
        double size = 0;
        dvec2 within(0);
        for (const auto& halves : region.loops) {
            std::vector<dvec2> outline;
            for (const uint32_t h : halves) outline.push_back(map.points[map.source(h)]);
            outline = cornersOf(outline, tolerance_);
            size += areaOf(outline);
            if (face.loops.empty()) within = pointIn(outline, kBesideEdge * tolerance_);
            face.loops.emplace_back();
            for (const dvec2 p : outline) face.loops.back().push_back(plane.back(p));
        }
        if (2 * size <= tolerance_ * perimeter(face.loops[0])) continue; // what rounding leaves beside others
        // In a bar; but what most of the pane lies in is a room.
        const auto holds = [&](const std::vector<Ends>& solid) { return isInside(solid, within); };
        if (size < kLeastPart * area && std::ranges::any_of(solids, holds)) continue;
        left += size;
        out.push_back(std::move(face));
    }
    if (left < kLeastPart * area) out.clear();
    return out;
}

std::vector<SoupFace> PaneFitter::fit(std::span<const uint32_t> pane, dvec3 shift) const {
    return fit(pane, shift, kReach);
}

double PaneFitter::distanceToBorder(std::span<const uint32_t> pane, dvec3 p) const {
    double least = std::numeric_limits<double>::infinity();
    for (const uint32_t f : pane)
        for (const auto& loop : soup_[f].loops) least = std::min(least, distanceToLoop(p, loop));
    return least;
}

std::optional<double> PaneFitter::joint(std::span<const uint32_t> pane, dvec3 shift) const {
    for (double reach = 2 * kReach; reach < kMostReach; reach *= 2) {
        const std::vector<SoupFace> filled = fit(pane, shift, reach);
        if (filled.empty()) continue;
        double widest = 0;
        for (const SoupFace& face : filled)
            for (size_t i = 0; i < face.loops[0].size(); ++i) {
                const dvec3 middle = 0.5 * (face.loops[0][i] + face.loops[0][(i + 1) % face.loops[0].size()]);
                widest = std::max(widest, distanceToBorder(pane, middle - shift));
            }
        return widest;
    }
    return std::nullopt;
}

bool PaneFitter::touches(std::span<const uint32_t> pane, dvec3 shift) const {
    return meets(pane, shift, kReach, 0);
}

bool PaneFitter::crosses(std::span<const uint32_t> pane, dvec3 shift, double rim) const {
    return meets(pane, shift, 0, rim);
}

bool PaneFitter::meets(std::span<const uint32_t> pane, dvec3 shift, double reach, double rim) const {
    const auto& [plane, area, map, solids] = cut(pane, shift, reach);
    const std::vector<int> within = coverage(map, [](int32_t tag) { return tag == kPane; }),
                           wall = coverage(map, [](int32_t tag) { return tag == kWall; });
    for (uint32_t c = 0; c < map.cellCount; ++c)
        if (within[c] > 0 && wall[c] > 0) return true;
    for (uint32_t e = 0; e < map.edgeCount(); ++e) {
        if (within[map.cell[2 * e]] <= 0 && within[map.cell[2 * e + 1]] <= 0) continue;
        if (std::ranges::all_of(map.tags[e], [](const auto& t) { return t.tag == kPane; })) continue;
        const dvec2 middle = 0.5 * (map.points[map.source(2 * e)] + map.points[map.source(2 * e + 1)]);
        if (rim == 0 || distanceToBorder(pane, plane.back(middle) - shift) > rim) return true;
    }
    return false;
}

std::optional<std::vector<SoupFace>> PaneFitter::pulledIn(std::span<const uint32_t> side,
                                                          std::span<const uint32_t> body, double by) const {
    const Plane plane = planeOf(soup_[side[0]], dvec3(0));
    std::vector<SoupFace> drawn, out;
    for (const uint32_t f : side) drawn.push_back(soup_[f]);
    const std::vector<Ends> borders = bordersOf(plane, drawn, tolerance_);
    const auto moved = [&](dvec3& p) {
        dvec2 inwards[2] = {dvec2(0), dvec2(0)}; // of the edges that begin and end there
        for (const Ends& ends : borders)
            for (const size_t k : {0, 1})
                if (glm::length(ends[k] - plane.flat(p)) <= 4 * tolerance_) {
                    const dvec2 along = glm::normalize(ends[1] - ends[0]);
                    inwards[k] = {-along.y, along.x};
                }
        const dvec2 sum = inwards[0] + inwards[1];
        if (inwards[0] == dvec2(0) || inwards[1] == dvec2(0) || glm::dot(sum, sum) < kSharp) return false;
        const dvec2 step = 2 * by / glm::dot(sum, sum) * sum;
        p += step.x * plane.u + step.y * plane.v;
        return true;
    };
    for (const uint32_t f : body) {
        out.push_back(soup_[f]);
        for (auto& loop : out.back().loops)
            if (!std::ranges::all_of(loop, moved)) return std::nullopt;
    }
    return out;
}

} // namespace heliodon::geometry
