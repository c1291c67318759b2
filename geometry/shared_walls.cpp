// Faces that lie on one another are cut along one another (a planar arrangement in each plane), so that every
// piece is one sheet with two sides. Round each edge the sheets are sorted by angle; the sides that look at
// one another over an edge bound the same part of space (the radial-edge structure of Weiler, 1988).
#include "geometry/shared_walls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "geometry/disjoint_sets.h"
#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"
#include "geometry/plan_arrangement.h"
#include "geometry/plan_regions.h"
#include "geometry/shell_nesting.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kMostOfThing = 0.05; // of the largest room's volume

// A piece of a wall, its outline counter-clockwise about the plane's normal; the faces that were drawn there,
// turned that way and the other, or -1.
struct Sheet {
    std::vector<std::vector<dvec3>> loops;
    std::array<int, 2> drawn{-1, -1};
};

struct Plane {
    dvec3 origin, normal;
    std::vector<uint32_t> faces;
};

class SpaceDivider {
public:
    SpaceDivider(const std::vector<SoupFace>& faces, double tolerance)
        : faces_(faces), tolerance_(tolerance) {}

    std::optional<SharedWalls> divide() {
        makeSheets();
        if (unclear_) return std::nullopt;
        weld();
        if (!joinSides()) return std::nullopt;
        makeParts();
        if (!placeParts()) return std::nullopt;
        SharedWalls out = answer();
        if (out.repairs.empty() && out.warnings.empty()) return std::nullopt;
        return out;
    }

private:
    std::vector<Plane> planes() const {
        std::vector<Plane> out;
        for (uint32_t f = 0; f < faces_.size(); ++f) {
            const auto& loop = faces_[f].loops[0];
            const dvec3 area = areaVector(loop);
            if (!(glm::length(area) > tolerance_ * tolerance_)) continue;
            const dvec3 n = glm::normalize(area);
            const auto in = [&](const Plane& plane) {
                return std::abs(glm::dot(n, plane.normal)) > 0.999 && std::ranges::all_of(loop, [&](dvec3 p) {
                           return std::abs(glm::dot(p - plane.origin, plane.normal)) <= 2 * tolerance_;
                       });
            };
            auto plane = std::ranges::find_if(out, in);
            if (plane == out.end()) plane = out.insert(out.end(), {loop[0], n, {}});
            plane->faces.push_back(f);
        }
        return out;
    }

    void makeSheets() {
        for (const Plane& plane : planes()) {
            if (plane.faces.size() > 1) {
                arrangePlane(plane);
                continue;
            }
            Sheet sheet{faces_[plane.faces[0]].loops, {}};
            sheet.drawn = {static_cast<int>(plane.faces[0]), -1};
            sheets_.push_back(std::move(sheet));
        }
    }

    void arrangePlane(const Plane& plane) {
        const dvec3 u = perpendicular(plane.normal), v = glm::cross(plane.normal, u);
        std::vector<PlanSegment> segments;
        std::vector<size_t> side; // per face: 0 turned as the plane, 1 the other way
        for (size_t k = 0; k < plane.faces.size(); ++k) {
            const auto& loops = faces_[plane.faces[k]].loops;
            side.push_back(glm::dot(areaVector(loops[0]), plane.normal) < 0 ? 1 : 0);
            for (const auto& loop : loops)
                for (size_t i = 0; i < loop.size(); ++i) {
                    const dvec3 p = loop[i] - plane.origin, q = loop[(i + 1) % loop.size()] - plane.origin;
                    glm::dvec2 a{glm::dot(p, u), glm::dot(p, v)}, b{glm::dot(q, u), glm::dot(q, v)};
                    if (side[k]) std::swap(a, b);
                    if (a != b) segments.push_back({a, b, static_cast<int32_t>(k)});
                }
        }
        const PlanArrangement map = arrange(segments);
        const auto kind = [&](int face) {
            if (face < 0) return std::pair(-1, -1);
            const SoupFace& f = faces_[static_cast<size_t>(face)];
            return std::pair(static_cast<int>(f.material), static_cast<int>(f.role));
        };
        // Per cell the faces over it. What one pair of faces covers is one sheet: other faces may meet its
        // edges.
        std::vector<std::array<int, 2>> drawn(map.cellCount, {-1, -1});
        for (size_t k = 0; k < plane.faces.size(); ++k) {
            const auto depth = coverage(map, [&](int32_t tag) { return static_cast<size_t>(tag) == k; });
            for (uint32_t c = 1; c < map.cellCount; ++c)
                if (depth[c] > 0) {
                    int& here = drawn[c][side[k]];
                    unclear_ |= here >= 0 && kind(here) != kind(static_cast<int>(plane.faces[k]));
                    if (here < 0) here = static_cast<int>(plane.faces[k]);
                }
        }
        std::map<std::array<int, 2>, int> known;
        std::vector<std::array<int, 2>> drawnOf;
        std::vector<int> labels(map.cellCount, -1);
        for (uint32_t c = 1; c < map.cellCount; ++c) {
            if (drawn[c][0] < 0 && drawn[c][1] < 0) continue;
            const auto [place, isNew] = known.try_emplace(drawn[c], static_cast<int>(known.size()));
            if (isNew) drawnOf.push_back(drawn[c]);
            labels[c] = place->second;
        }
        absorbThinCells(map, labels, tolerance_);
        for (const PlanRegion& region : traceRegions(map, labels)) {
            Sheet sheet{{}, drawnOf[static_cast<size_t>(region.label)]};
            for (const auto& halves : region.loops) {
                sheet.loops.emplace_back();
                for (const uint32_t h : halves) {
                    const glm::dvec2 p = map.points[map.source(h)];
                    sheet.loops.back().push_back(plane.origin + p.x * u + p.y * v);
                }
            }
            sheets_.push_back(std::move(sheet));
        }
    }

    void weld() {
        std::vector<SoupFace> soup;
        for (size_t s = 0; s < sheets_.size(); ++s) {
            SoupFace face;
            face.loops = sheets_[s].loops;
            face.surface = static_cast<uint32_t>(s);
            soup.push_back(std::move(face));
        }
        welded_ = weldFaces(soup, 1, tolerance_, true);
    }

    dvec3 normalOf(const Face& face) const {
        return glm::normalize(areaVector(welded_.vertices, face.loops[0]));
    }

    // False where an edge has one sheet alone.
    bool joinSides() {
        struct Sector {
            double angle;
            uint32_t ahead, behind; // the sides that look to larger and smaller angles
            uint32_t face;
        };
        std::map<std::pair<uint32_t, uint32_t>, std::vector<Sector>> edges;
        for (uint32_t f = 0; f < welded_.faces.size(); ++f) {
            const dvec3 n = normalOf(welded_.faces[f]);
            for (const auto& loop : welded_.faces[f].loops)
                for (size_t i = 0; i < loop.size(); ++i) {
                    const uint32_t a = loop[i], b = loop[(i + 1) % loop.size()];
                    const auto [low, high] = std::minmax(a, b);
                    const dvec3 axis = glm::normalize(welded_.vertices[high] - welded_.vertices[low]),
                                x = perpendicular(axis), y = glm::cross(axis, x),
                                inwards = (a == low ? 1.0 : -1.0) * glm::cross(n, axis);
                    // Walking with the axis the sheet lies to the left of its normal: that side looks ahead.
                    const bool along = a == low;
                    edges[{low, high}].push_back({std::atan2(glm::dot(inwards, y), glm::dot(inwards, x)),
                                                  2 * f + (along ? 0 : 1), 2 * f + (along ? 1 : 0), f});
                }
        }
        sides_ = DisjointSets(2 * welded_.faces.size());
        shells_ = DisjointSets(welded_.faces.size());
        for (auto& [edge, sectors] : edges) {
            if (sectors.size() < 2) return false;
            std::ranges::sort(sectors, {}, &Sector::angle);
            for (size_t k = 0; k < sectors.size(); ++k) {
                const Sector &one = sectors[k], &next = sectors[(k + 1) % sectors.size()];
                sides_.join(one.ahead, next.behind);
                shells_.join(one.face, next.face);
            }
        }
        return !welded_.faces.empty();
    }

    // The parts of space and what they hold; triangles look into the part.
    struct Part {
        uint32_t shell = 0;
        std::vector<ShellTriangle> triangles;
        double volume = 0; // negative: what lies outside of the shell
        int room = -1;
        double drawnInwards = 0; // area of faces that look into it, less that of faces that look out
        double drawn = 0;        // area of both
        // Nearly all faces look in, or out.
        bool looksIn() const { return drawnInwards > 0.5 * drawn; }
        bool looksOut() const { return drawnInwards < -0.5 * drawn; }
    };

    void makeParts() {
        for (uint32_t f = 0; f < welded_.faces.size(); ++f) {
            const auto triangles = triangulateFace(welded_, welded_.faces[f]);
            const Sheet& sheet = sheets_[welded_.faces[f].surface];
            for (uint32_t s = 0; s < 2; ++s) {
                Part& part = parts_[sides_.root(2 * f + s)];
                part.shell = shells_.root(f);
                for (const auto& t : triangles) {
                    ShellTriangle in{welded_.vertices[t[0]], welded_.vertices[t[1]], welded_.vertices[t[2]]};
                    if (s) std::swap(in.b, in.c);
                    const dvec3 o = welded_.vertices[0];
                    part.volume -= glm::dot(in.a - o, glm::cross(in.b - o, in.c - o)) / 6;
                    const double area = glm::length(glm::cross(in.b - in.a, in.c - in.a));
                    if ((sheet.drawn[0] < 0) != (sheet.drawn[1] < 0)) {
                        part.drawnInwards += (sheet.drawn[s] >= 0 ? 1 : -1) * area;
                        part.drawn += area;
                    }
                    part.triangles.push_back(in);
                }
            }
        }
    }

    // Which parts are rooms, and of which room's air those are that lie outside of a shell.
    bool placeParts() {
        std::map<uint32_t, std::vector<uint32_t>> shells; // parts of each
        for (const auto& [id, part] : parts_) shells[part.shell].push_back(id);
        std::map<uint32_t, std::vector<uint32_t>> around; // per shell: bounded parts of others that hold it
        for (const auto& [shell, own] : shells)
            for (const auto& [id, part] : parts_)
                if (part.shell != shell && part.volume > 0 && !part.triangles.empty() &&
                    crossings(part.triangles, parts_[own[0]].triangles.front().a) % 2 == 1)
                    around[shell].push_back(id);
        const auto isSolid = [&](uint32_t shell) { // nothing but a closed box in a room's air
            return around[shell].size() % 2 == 1 && shells[shell].size() == 2;
        };
        const Part& largest =
            std::ranges::max_element(parts_, {}, [](const auto& p) { return p.second.volume; })->second;
        const auto isThing = [&](const Part& part) { // a cupboard against the wall, a column
            return largest.looksIn() && part.looksOut() && part.volume < kMostOfThing * largest.volume;
        };
        for (auto& [id, part] : parts_) {
            if (part.volume <= 0 || isSolid(part.shell)) continue;
            if (isThing(part)) {
                ++solids_;
                largestSolid_ = std::max(largestSolid_, part.volume / largest.volume);
            } else
                part.room = static_cast<int>(rooms_++);
        }
        for (auto& [id, part] : parts_) {
            if (part.volume > 0 || around[part.shell].size() % 2 == 0) continue;
            const auto& holders = around[part.shell];
            part.room = parts_[*std::ranges::max_element(holders, {}, [&](uint32_t o) {
                            return around[parts_[o].shell].size();
                        })].room;
        }
        return rooms_ > 0;
    }

    // Of the faces drawn on a sheet, the one for the side: that which is turned as those about it.
    int drawnFor(const Sheet& sheet, uint32_t side, const Part& part) const {
        const size_t first = part.drawnInwards >= 0 ? side : 1 - side;
        return sheet.drawn[first] >= 0 ? sheet.drawn[first] : sheet.drawn[1 - first];
    }

    SharedWalls answer() {
        SharedWalls out;
        out.rooms = rooms_;
        size_t shared = 0; // walls that two rooms see
        std::vector<SoupFace> outside;
        for (uint32_t f = 0; f < welded_.faces.size(); ++f) {
            const std::array<int, 2>& both = sheets_[welded_.faces[f].surface].drawn;
            if (both[0] >= 0 && both[1] >= 0)
                out.pairs.push_back({faces_[static_cast<size_t>(both[0])].surface,
                                     faces_[static_cast<size_t>(both[1])].surface});
            int sides = 0;
            for (uint32_t s = 0; s < 2; ++s) {
                const Part& part = parts_[sides_.root(2 * f + s)];
                const Sheet& sheet = sheets_[welded_.faces[f].surface];
                const int drawn = drawnFor(sheet, s, part);
                SoupFace face = faces_[static_cast<size_t>(drawn)];
                face.loops.clear();
                for (const auto& loop : welded_.faces[f].loops) {
                    face.loops.emplace_back();
                    for (const uint32_t v : loop) face.loops.back().push_back(welded_.vertices[v]);
                    if (s) std::ranges::reverse(face.loops.back());
                }
                if (part.volume <= 0) {
                    face.room = 0;
                    outside.push_back(face);
                }
                if (part.room < 0) continue;
                ++sides;
                face.room = static_cast<uint32_t>(part.room);
                out.faces.push_back(std::move(face));
            }
            shared += sides == 2;
        }
        if (shared > 0)
            out.repairs.push_back(fmt::format("{} wall{} without thickness: rooms on both sides share {}",
                                              shared, shared == 1 ? "" : "s", shared == 1 ? "it" : "them"));
        if (solids_ > 0)
            out.warnings.push_back(fmt::format(
                "{} cut out of the room where {} {:.2g} % of the largest room's volume: a small "
                "space against a wall whose faces look out of it is solid, those of a room look "
                "into it",
                solids_ == 1 ? "1 solid was" : fmt::format("{} solids were", solids_),
                solids_ == 1 ? "it stands, of" : "they stand, the largest of", 100 * largestSolid_));
        out.outside = weldFaces(outside, 1, tolerance_);
        return out;
    }

    const std::vector<SoupFace>& faces_;
    double tolerance_;
    std::vector<Sheet> sheets_;
    Building welded_;
    // Side 2 f of a welded face is the one that its normal points to, 2 f + 1 the other: by the part of space
    // that they bound. Faces by common edges.
    DisjointSets sides_, shells_;
    std::map<uint32_t, Part> parts_; // by the root of their sides
    uint32_t rooms_ = 0;
    size_t solids_ = 0;       // that stand against walls or floors
    double largestSolid_ = 0; // of the largest part's volume
    bool unclear_ = false;    // two materials in one place
};

} // namespace

std::optional<SharedWalls> divideSpace(const std::vector<SoupFace>& faces, double tolerance) {
    return SpaceDivider(faces, tolerance).divide();
}

} // namespace heliodon::geometry
