// In each plane a planar arrangement of the outlines of the faces that lie in it, and of the edges of other
// faces that end there: a wall that is drawn once divides the floor and the walls that it meets.
#include "geometry/space_sheets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "geometry/box_tree.h"
#include "geometry/disjoint_sets.h"
#include "geometry/flat_faces.h"
#include "geometry/key_hash.h"
#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"
#include "geometry/plan_arrangement.h"
#include "geometry/plan_regions.h"
#include "geometry/shell_faces.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

// Cells of directions, along an axis: how wide, and of that how far normals in a cell's neighbours may be
// off; with the widest those of that cosine are.
constexpr std::array kCells{0.1, 0.03, 0.01, 0.003};
constexpr double kReachOfCell = 0.45;
// Of the tolerance: 2 area / perimeter of a triangle as high as that, and what is as near a line is on it.
constexpr double kHeightOfThin = 0.5, kOnLine = 1e-3;
constexpr int32_t kForeign = -1; // tag of edges of faces that only end in the plane

struct Plane {
    dvec3 origin, normal;
    std::vector<uint32_t> faces;
};

using Drawn = decltype(Sheet::drawn);

// Vertices in the coordinates of their plane, and points of an arrangement back in space.
class FlatPlane {
public:
    // Corners stay where they are: put into the plane they might part from those of other planes.
    using Corners = std::map<std::pair<double, double>, dvec3>;

    FlatPlane(const Plane& plane, const std::vector<dvec3>& vertices)
        : origin_(plane.origin), u_(perpendicular(plane.normal)), v_(glm::cross(plane.normal, u_)),
          vertices_(vertices) {}

    glm::dvec2 operator()(uint32_t vertex) const {
        const dvec3 p = vertices_[vertex] - origin_;
        return {glm::dot(p, u_), glm::dot(p, v_)};
    }
    dvec3 back(glm::dvec2 p, const Corners& corners) const {
        const auto corner = corners.find({p.x, p.y});
        return corner != corners.end() ? corner->second : origin_ + p.x * u_ + p.y * v_;
    }

private:
    dvec3 origin_, u_, v_;
    const std::vector<dvec3>& vertices_;
};

class SheetCutter {
public:
    SheetCutter(const std::vector<SoupFace>& faces, double tolerance) : tolerance_(tolerance) {
        std::vector<SoupFace> numbered = faces;
        for (uint32_t f = 0; f < numbered.size(); ++f) {
            numbered[f].surface = f;
            numbered[f].room = 0;
        }
        welded_ = weldFaces(numbered, 1, tolerance_, true);
        for (auto& [edge, found] : facesOfEdges(welded_)) {
            edges_.push_back(edge);
            facesAt_.push_back(std::move(found));
            const dvec3 a = welded_.vertices[edge.first], b = welded_.vertices[edge.second];
            edgeBoxes_.push_back({glm::min(a, b), glm::max(a, b)});
        }
        edgeTree_.emplace(edgeBoxes_);
    }

    std::vector<Sheet> cut() {
        for (const Plane& plane : planes()) {
            const std::vector<Edge> ends = edgesThatEndIn(plane);
            if (plane.faces.size() > 1 || !ends.empty()) {
                arrangePlane(plane, ends);
                continue;
            }
            const Face& face = welded_.faces[plane.faces[0]];
            Sheet sheet;
            for (const auto& loop : face.loops) sheet.loops.push_back(placed(loop));
            sheet.drawn[0] = {face.surface};
            sheets_.push_back(std::move(sheet));
        }
        return std::move(sheets_);
    }

private:
    std::vector<dvec3> placed(const std::vector<uint32_t>& loop) const {
        std::vector<dvec3> out;
        for (const uint32_t v : loop) out.push_back(welded_.vertices[v]);
        return out;
    }

    bool inPlane(const Plane& plane, uint32_t v) const {
        return std::abs(glm::dot(welded_.vertices[v] - plane.origin, plane.normal)) <= 2 * tolerance_;
    }

    // Each face is of the first plane that it lies in.
    std::vector<Plane> planes() const {
        std::vector<Plane> out;
        // Planes, by their normals either way round, in cells of each width.
        std::array<std::unordered_map<Cell, std::vector<size_t>, KeyHash>, kCells.size()> turned;
        for (uint32_t f = 0; f < welded_.faces.size(); ++f) {
            const auto& loop = welded_.faces[f].loops[0];
            const dvec3 area = areaVector(welded_.vertices, loop);
            if (!(glm::length(area) > tolerance_ * tolerance_)) continue;
            const dvec3 n = glm::normalize(area);
            const size_t width = narrowestFor(loop, glm::length(area));
            size_t first = out.size();
            for (const Cell& cell : cellsNear(n, kCells[width]))
                if (const auto found = turned[width].find(cell); found != turned[width].end())
                    for (const size_t p : found->second)
                        if (p < first && std::abs(glm::dot(n, out[p].normal)) > kOnePlaneCosine &&
                            std::ranges::all_of(loop, [&](uint32_t v) { return inPlane(out[p], v); }))
                            first = p;
            if (first == out.size()) {
                out.push_back({welded_.vertices[loop[0]], n, {}});
                for (const dvec3 way : {n, -n})
                    for (size_t k = 0; k < kCells.size(); ++k)
                        turned[k][cellOf(way, kCells[k])].push_back(first);
            }
            out[first].faces.push_back(f);
        }
        return out;
    }

    // Of kCells the last that finds all planes that hold the loop, of twice that area: with heights of up to
    // h over a plane the area leans by at most h times the perimeter.
    size_t narrowestFor(const std::vector<uint32_t>& loop, double area) const {
        double around = 0;
        for (size_t i = 0; i < loop.size(); ++i)
            around += glm::length(welded_.vertices[loop[(i + 1) % loop.size()]] - welded_.vertices[loop[i]]);
        const double sine = 2.1 * (2 * tolerance_) * around / area;
        size_t k = kCells.size() - 1;
        while (k > 0 && sine > kReachOfCell * kCells[k]) --k;
        return k;
    }

    using Cell = std::array<int64_t, 3>;
    static Cell cellOf(dvec3 n, double width) {
        const dvec3 cell = glm::floor(n / width);
        return {static_cast<int64_t>(cell.x), static_cast<int64_t>(cell.y), static_cast<int64_t>(cell.z)};
    }
    static std::set<Cell> cellsNear(dvec3 n, double width) { // all within kReachOfCell of it
        std::set<Cell> out;
        const double reach = kReachOfCell * width;
        for (const double x : {-reach, reach})
            for (const double y : {-reach, reach})
                for (const double z : {-reach, reach}) out.insert(cellOf(n + dvec3(x, y, z), width));
        return out;
    }

    // Edges of other faces in the plane that are no edges of its own faces. Corners on edges are welded
    // already, so that equal edges have equal ends.
    std::vector<Edge> edgesThatEndIn(const Plane& plane) const {
        std::set<Edge> own;
        dvec3 low(1e300), high(-1e300);
        for (const uint32_t f : plane.faces)
            for (const auto& loop : welded_.faces[f].loops)
                for (size_t i = 0; i < loop.size(); ++i) {
                    own.insert(std::minmax(loop[i], loop[(i + 1) % loop.size()]));
                    low = glm::min(low, welded_.vertices[loop[i]]);
                    high = glm::max(high, welded_.vertices[loop[i]]);
                }
        std::vector<Edge> out;
        edgeTree_->anyHolding(high + tolerance_, low - tolerance_, [&](uint32_t i) {
            const Edge& edge = edges_[i];
            if (inPlane(plane, edge.first) && inPlane(plane, edge.second) && !own.contains(edge))
                out.push_back(edge);
            return false; // look at all
        });
        std::ranges::sort(out);
        return out;
    }

    void arrangePlane(const Plane& plane, const std::vector<Edge>& ends) {
        const FlatPlane flat(plane, welded_.vertices);
        PlanArrangement map = arrange(segmentsIn(plane, ends, flat));
        const FlatPlane::Corners corners = cornersOf(plane, ends, flat);
        straighten(map, plane, ends, flat, corners);
        const std::vector<Drawn> drawn = drawnOver(map, plane);
        std::vector<int> labels = cellsOfSheets(map, drawn);
        absorbThinCells(map, labels, kHeightOfThin * tolerance_);
        for (const PlanRegion& region : traceRegions(map, labels)) {
            Sheet sheet{{}, drawn[static_cast<size_t>(region.label)]};
            for (const auto& halves : region.loops) {
                sheet.loops.emplace_back();
                for (const uint32_t h : halves)
                    sheet.loops.back().push_back(flat.back(map.points[map.source(h)], corners));
            }
            sheets_.push_back(std::move(sheet));
        }
    }

    // Where faces of this plane cross so near an edge of others that welding puts it there, on that edge:
    // else it would bend those others.
    void straighten(PlanArrangement& map, const Plane& plane, const std::vector<Edge>& ends,
                    const FlatPlane& flat, const FlatPlane::Corners& corners) const {
        std::vector<glm::dvec2*> crossings;
        for (glm::dvec2& p : map.points)
            if (!corners.contains({p.x, p.y})) crossings.push_back(&p);
        if (crossings.empty()) return;
        std::vector<Edge> lines = edgesWithOthers(plane);
        lines.insert(lines.end(), ends.begin(), ends.end());
        std::vector<std::pair<double, glm::dvec2>> nearest; // per crossing
        for (const glm::dvec2* p : crossings) nearest.emplace_back(tolerance_, *p);
        for (const Edge& line : lines) {
            const glm::dvec2 a = flat(line.first), b = flat(line.second);
            const double length = glm::length(b - a);
            const glm::dvec2 along = (b - a) / length;
            for (size_t k = 0; k < crossings.size(); ++k) {
                const glm::dvec2 from = *crossings[k] - a;
                const double aside = std::abs(along.x * from.y - along.y * from.x);
                if (!(aside <= nearest[k].first)) continue;
                const double t = glm::dot(from, along);
                if (t > 0 && t < length) nearest[k] = {aside, a + t * along};
            }
        }
        for (size_t k = 0; k < crossings.size(); ++k)
            if (nearest[k].first > kOnLine * tolerance_) *crossings[k] = nearest[k].second;
    }

    // Edges of the plane's faces in which faces of other planes end, too; some repeat.
    std::vector<Edge> edgesWithOthers(const Plane& plane) const {
        std::vector<Edge> out;
        for (const uint32_t f : plane.faces)
            for (const auto& loop : welded_.faces[f].loops)
                for (size_t i = 0; i < loop.size(); ++i) {
                    const Edge edge = std::minmax(loop[i], loop[(i + 1) % loop.size()]);
                    const auto at = std::ranges::lower_bound(edges_, edge) - edges_.begin();
                    if (std::ranges::any_of(facesAt_[static_cast<size_t>(at)], [&](uint32_t g) {
                            return !std::ranges::binary_search(plane.faces, g);
                        }))
                        out.push_back(edge);
                }
        return out;
    }

    size_t sideOf(const Face& face, const Plane& plane) const { // 0 turned as the plane, 1 the other way
        return glm::dot(areaVector(welded_.vertices, face.loops[0]), plane.normal) < 0 ? 1 : 0;
    }

    // Outlines of the plane's faces, tagged by their place in it and run the plane's way round, and `ends`.
    std::vector<PlanSegment> segmentsIn(const Plane& plane, const std::vector<Edge>& ends,
                                        const FlatPlane& flat) const {
        std::vector<PlanSegment> segments;
        for (size_t k = 0; k < plane.faces.size(); ++k) {
            const Face& face = welded_.faces[plane.faces[k]];
            const bool turned = sideOf(face, plane) == 1;
            for (const auto& loop : face.loops)
                for (size_t i = 0; i < loop.size(); ++i) {
                    glm::dvec2 a = flat(loop[i]), b = flat(loop[(i + 1) % loop.size()]);
                    if (turned) std::swap(a, b);
                    if (a != b) segments.push_back({a, b, static_cast<int32_t>(k)});
                }
        }
        for (const Edge& edge : ends)
            if (flat(edge.first) != flat(edge.second))
                segments.push_back({flat(edge.first), flat(edge.second), kForeign});
        return segments;
    }

    FlatPlane::Corners cornersOf(const Plane& plane, const std::vector<Edge>& ends,
                                 const FlatPlane& flat) const {
        FlatPlane::Corners corners;
        const auto keep = [&](uint32_t i) {
            corners.try_emplace({flat(i).x, flat(i).y}, welded_.vertices[i]);
        };
        for (const uint32_t f : plane.faces)
            for (const auto& loop : welded_.faces[f].loops) std::ranges::for_each(loop, keep);
        for (const Edge& edge : ends) {
            keep(edge.first);
            keep(edge.second);
        }
        return corners;
    }

    std::vector<Drawn> drawnOver(const PlanArrangement& map, const Plane& plane) const { // per cell
        std::vector<Drawn> drawn(map.cellCount);
        const auto depth = coverageOfEach(map, [](int32_t tag) { return tag; });
        for (uint32_t c = 1; c < map.cellCount; ++c)
            for (const auto& [k, times] : depth[c]) {
                const Face& face = welded_.faces[plane.faces[static_cast<size_t>(k)]];
                if (times > 0) drawn[c][sideOf(face, plane)].push_back(face.surface);
            }
        return drawn;
    }

    // Per cell one of the cells of its sheet, -1 where there is none. Neighbours under the same faces are one
    // sheet, but where another face ends between them.
    static std::vector<int> cellsOfSheets(const PlanArrangement& map, const std::vector<Drawn>& drawn) {
        DisjointSets sheets(map.cellCount);
        for (uint32_t e = 0; e < map.edgeCount(); ++e) {
            const uint32_t one = map.cell[2 * e], other = map.cell[2 * e + 1];
            if (drawn[one] == drawn[other] &&
                std::ranges::none_of(map.tags[e], [](const auto& t) { return t.tag == kForeign; }))
                sheets.join(one, other);
        }
        std::vector<int> labels(map.cellCount, -1);
        for (uint32_t c = 1; c < map.cellCount; ++c)
            if (!drawn[c][0].empty() || !drawn[c][1].empty()) labels[c] = static_cast<int>(sheets.root(c));
        return labels;
    }

    double tolerance_;
    Building welded_;         // surface: the given face
    std::vector<Edge> edges_; // sorted
    std::vector<std::vector<uint32_t>> facesAt_;
    std::vector<Bounds> edgeBoxes_;
    std::optional<BoxTree> edgeTree_;
    std::vector<Sheet> sheets_;
};

} // namespace

std::vector<Sheet> cutIntoSheets(const std::vector<SoupFace>& faces, double tolerance) {
    const auto cut = [&] { return SheetCutter(faces, tolerance).cut(); };
    const auto key = [&] {
        std::vector<double> numbers{tolerance};
        for (const SoupFace& face : faces) {
            numbers.push_back(face.twinKey); // what is welded with others beside its place
            addOutline(numbers, face.loops);
        }
        return numbers;
    };
    return Memory<std::vector<Sheet>>::get(key, cut);
}

SoupFace pieceOf(const SoupFace& face, const Sheet& sheet, size_t turned) {
    SoupFace out = face;
    out.loops = sheet.loops;
    if (turned == 1) turnOver(out);
    return out;
}

Building weldSheets(const std::vector<Sheet>& sheets, double tolerance) {
    std::vector<SoupFace> soup;
    for (size_t s = 0; s < sheets.size(); ++s) {
        SoupFace face;
        face.loops = sheets[s].loops;
        face.surface = static_cast<uint32_t>(s);
        soup.push_back(std::move(face));
    }
    return weldFaces(soup, 1, tolerance, true);
}

} // namespace heliodon::geometry
