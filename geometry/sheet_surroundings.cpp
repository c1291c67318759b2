#include "geometry/sheet_surroundings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "geometry/bounds.h"
#include "geometry/box_tree.h"
#include "geometry/clip_polygon.h"
#include "geometry/disjoint_sets.h"
#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"
#include "geometry/segment_distance.h"
#include "geometry/shell_faces.h"
#include "geometry/triangle_rays.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr size_t kMostSamples = 400;  // triangles of sheets that are looked from
constexpr double kEnclosed = 4.5;     // of six sides, the four about counted by their angles
constexpr int kAzimuths = 24;         // ways that are looked along about, and
constexpr double kLeastOfRoom = 0.25; // of the lowest room's height: what is narrower is none
constexpr double kLeastWalls = 0.5;   // of its square: so much of a room's walls; leaves of a tree have less
constexpr double kSteep = 0.7;        // of a normal's height: walls are
constexpr double kLeastSteep = 0.1;   // of the area of what has walls
// Metres: of buildings neither an attic nor a hall says how high the least room is; lower are models.
constexpr double kAttic = 1, kLowRoom = 2, kHighRoom = 3;
constexpr double kParallel = 1e-6;     // sine: planes that meet nowhere
constexpr double kOffVertical = 0.176; // tangent: up and down are four ways, not along a joint

struct FlatFace {
    uint32_t face = 0, surface = 0; // of the building, and what that says of it
    dvec3 origin{0}, normal{0};
    std::vector<std::vector<dvec3>> loops;
    std::vector<ShellTriangle> triangles;
    Bounds box;
    bool isGlass = false, isWindow = false; // the latter: to the outside

    double height(dvec3 p) const { return glm::dot(p - origin, normal); }
};

std::vector<FlatFace> flatFacesOf(const Building& building) {
    std::vector<FlatFace> out;
    for (const Face& face : building.faces) {
        FlatFace flat;
        flat.face = static_cast<uint32_t>(&face - building.faces.data());
        flat.surface = face.surface;
        for (const auto& loop : face.loops) {
            flat.loops.emplace_back();
            for (const uint32_t v : loop) flat.loops.back().push_back(building.vertices[v]);
        }
        for (const auto& t : triangulateFace(building, face))
            flat.triangles.push_back(
                {building.vertices[t[0]], building.vertices[t[1]], building.vertices[t[2]]});
        const dvec3 area = areaVector(flat.loops[0]);
        if (!(glm::length(area) > 0)) continue;
        flat.origin = flat.loops[0][0];
        flat.normal = glm::normalize(area);
        flat.box = boundsOf(flat.loops[0]);
        flat.isGlass = !building.materials.empty() && building.materials[face.material].isOpening();
        flat.isWindow = flat.isGlass && face.twin == kNoTwin;
        out.push_back(std::move(flat));
    }
    return out;
}

std::vector<ShellTriangle> trianglesOf(const std::vector<FlatFace>& faces) {
    std::vector<ShellTriangle> out;
    for (const FlatFace& face : faces) out.insert(out.end(), face.triangles.begin(), face.triangles.end());
    return out;
}

class SheetJudge {
public:
    SheetJudge(const Building& sheets, const Building& rooms, bool looksIn, double tolerance)
        : sheets_(flatFacesOf(sheets)), rooms_(flatFacesOf(rooms)), looksIn_(looksIn), tolerance_(tolerance) {
        std::vector<Bounds> ofRooms(rooms.roomCount, {dvec3(1e300), dvec3(-1e300)});
        Bounds all = ofRooms[0];
        for (const Face& face : rooms.faces)
            for (const uint32_t v : face.loops[0]) {
                const dvec3 p = rooms.vertices[v];
                for (Bounds* box : {&ofRooms[face.room], &all})
                    *box = {glm::min(box->low, p), glm::max(box->high, p)};
            }
        setReach(sheets, all.diagonal());
        for (const Bounds& box : ofRooms) height_ = std::min(height_, (box.high - box.low).y);
        if (height_ > kAttic) height_ = std::clamp(height_, kLowRoom, kHighRoom);
        for (const FlatFace& face : rooms_) boxes_.push_back(face.box);
        std::vector<ShellTriangle> together = trianglesOf(sheets_);
        open_.emplace(together, tolerance);
        const std::vector<ShellTriangle> shell = trianglesOf(rooms_);
        shell_.emplace(shell, tolerance);
        together.insert(together.end(), shell.begin(), shell.end());
        all_.emplace(std::move(together), tolerance);
    }

    std::optional<SheetFault> fault() const {
        const BoxTree tree(boxes_);
        for (const FlatFace& sheet : sheets_) {
            if (std::ranges::any_of(sheet.triangles,
                                    [&](const auto& t) { return isInside(t, sheet.normal); }))
                return SheetFault{sheet.surface,
                                  "lies in a room, a sheet without thickness that encloses nothing"};
            if (tree.anyHolding(sheet.box.high + tolerance_, sheet.box.low - tolerance_,
                                [&](uint32_t i) { return meet(sheet, rooms_[i]); }))
                return SheetFault{sheet.surface, "goes through a face of a room, or lies on its glass"};
        }
        if (const auto surface = wallOfRoom())
            return SheetFault{*surface, "encloses with others a space of a room's size, but for a side: does "
                                        "that lack its wall, floor or ceiling?"};
        return std::nullopt;
    }

    // Windows, by face of the rooms, out of which every way but along the pane ends on a sheet.
    std::vector<uint32_t> blindWindows() const {
        std::vector<uint32_t> out;
        for (const FlatFace& pane : rooms_)
            if (pane.isWindow && std::ranges::all_of(waysOutOf(pane.normal), [&](dvec3 way) {
                    return open_->anyWithin(pane.triangles[0].middle(), way,
                                            std::numeric_limits<double>::infinity());
                }))
                out.push_back(pane.face);
        return out;
    }

private:
    // Steepest first, and along no pane: what stands before it lets light in past its edges.
    static std::vector<dvec3> waysOutOf(dvec3 normal) {
        const dvec3 u = perpendicular(normal), v = glm::cross(normal, u);
        std::vector<dvec3> out;
        for (const double steep : {75.0, 45.0, 15.0})
            for (int k = 0; k < kAzimuths; ++k) {
                const double turn = 2 * std::numbers::pi * (k + 0.5) / kAzimuths, up = glm::radians(steep);
                out.push_back(std::cos(up) * (std::cos(turn) * u + std::sin(turn) * v) -
                              std::sin(up) * normal);
            }
        return out;
    }

    // Per sheet, the length of the house, or of what the sheet hangs together with where that has walls: a
    // hall may be longer than the house, but the ground is no floor of a room with the houses across the
    // street for walls.
    void setReach(const Building& sheets, double house) {
        struct Whole {
            Bounds box{dvec3(1e300), dvec3(-1e300)};
            double area = 0, steep = 0;
        };
        DisjointSets sets(sheets.faces.size());
        for (const auto& [edge, faces] : facesOfEdges(sheets))
            for (const uint32_t f : faces) sets.join(f, faces[0]);
        std::map<uint32_t, Whole> wholes; // by root
        for (const FlatFace& sheet : sheets_) {
            Whole& whole = wholes[sets.root(sheet.face)];
            whole.box = {glm::min(whole.box.low, sheet.box.low), glm::max(whole.box.high, sheet.box.high)};
            const double area = glm::length(areaVector(sheet.loops[0]));
            whole.area += area;
            if (std::abs(sheet.normal.y) < kSteep) whole.steep += area;
        }
        for (const FlatFace& sheet : sheets_) {
            const Whole& whole = wholes[sets.root(sheet.face)];
            const bool hasWalls = whole.steep > kLeastSteep * whole.area;
            reach_.push_back(hasWalls ? std::max(house, whole.box.diagonal()) : house);
        }
    }

    // On both sides: what lies on a wall is not.
    bool isInside(const ShellTriangle& t, dvec3 normal) const {
        return std::ranges::all_of(std::array{1.0, -1.0}, [&](double side) {
            return shell_->enclose(t.middle() + 2 * side * tolerance_ * normal);
        });
    }

    bool meet(const FlatFace& sheet, const FlatFace& wall) const {
        return cross(sheet, wall) || (wall.isGlass && covers(sheet, wall));
    }

    // Whether the line of both planes runs on both faces, and not along the border of either.
    bool cross(const FlatFace& one, const FlatFace& other) const {
        const dvec3 line = glm::cross(one.normal, other.normal);
        if (!(glm::length(line) > kParallel)) return false;
        const dvec3 way = glm::normalize(line);
        const std::vector<Stretch> onOther = stretchesOn(other, one, way);
        for (const Stretch& a : stretchesOn(one, other, way))
            for (const Stretch& b : onOther) {
                const double from = std::max(a.from, b.from), to = std::min(a.to, b.to);
                if (to - from <= 2 * tolerance_) continue;
                const dvec3 middle = a.origin + 0.5 * (from + to) * way;
                if (toBorder(one, middle) > tolerance_ && toBorder(other, middle) > tolerance_) return true;
            }
        return false;
    }

    // Of triangles of a face that another one's plane crosses, not only touches, where that is: `origin` plus
    // lengths along `way`, of both planes.
    struct Stretch {
        dvec3 origin;
        double from, to;
    };
    std::vector<Stretch> stretchesOn(const FlatFace& face, const FlatFace& plane, dvec3 way) const {
        std::vector<Stretch> out;
        for (const ShellTriangle& t : face.triangles) {
            const std::array corner{t.a, t.b, t.c};
            const std::array height{plane.height(t.a), plane.height(t.b), plane.height(t.c)};
            if (std::ranges::max(height) <= tolerance_ || std::ranges::min(height) >= -tolerance_) continue;
            std::optional<Stretch> on;
            for (size_t k = 0; k < 3; ++k) {
                const double a = height[k], b = height[(k + 1) % 3];
                if ((a > 0) == (b > 0)) continue;
                const dvec3 p = corner[k] + a / (a - b) * (corner[(k + 1) % 3] - corner[k]);
                const double along = glm::dot(p, way);
                if (!on) on = Stretch{p - along * way, along, along};
                on->from = std::min(on->from, along), on->to = std::max(on->to, along);
            }
            out.push_back(*on); // some height is above, some below
        }
        return out;
    }

    static double toBorder(const FlatFace& face, dvec3 p) {
        double least = std::numeric_limits<double>::infinity();
        for (const auto& loop : face.loops) least = std::min(least, distanceToLoop(p, loop));
        return least;
    }

    // In the plane of the pane and, more than by its border, over it.
    bool covers(const FlatFace& sheet, const FlatFace& pane) const {
        if (std::ranges::any_of(sheet.loops[0],
                                [&](dvec3 p) { return std::abs(pane.height(p)) > tolerance_; }))
            return false;
        std::vector<dvec3> part, cut;
        for (const ShellTriangle& over : sheet.triangles)
            for (const ShellTriangle& t : pane.triangles) {
                part = {over.a, over.b, over.c};
                for (const auto& [a, b] : {std::pair(t.a, t.b), std::pair(t.b, t.c), std::pair(t.c, t.a)}) {
                    const dvec3 inwards = glm::cross(pane.normal, b - a);
                    clip<dvec3>(
                        part, [&](dvec3 p) { return glm::dot(p - a, inwards); }, cut);
                    std::swap(part, cut);
                }
                if (0.5 * glm::length(areaVector(part)) > tolerance_ * pane.box.diagonal()) return true;
            }
        return false;
    }

    // Before a sheet, and half-way between what is above and below, no farther than a room is high: canopies
    // with a border and roofs with a parapet are low.
    dvec3 middleBefore(dvec3 from, dvec3 way, double width) const {
        const dvec3 p = from + std::min(0.5 * width, kLeastOfRoom * height_) * way, up(0, 1, 0);
        const auto free = [&](dvec3 to) { return std::min(all_->nearest(p, to, height_), height_); };
        return p + 0.5 * (free(up) - free(-up)) * up;
    }

    // Of six sides of a box about the point how many are closed.
    double sidesAbout(dvec3 p, double reach) const {
        double sides = 0;
        for (const double up : {1.0, -1.0})
            for (const dvec3 aside :
                 {dvec3(1, 0, 0.3), dvec3(-0.3, 0, 1), dvec3(-1, 0, -0.3), dvec3(0.3, 0, -1)})
                sides += all_->anyWithin(p, glm::normalize(dvec3(0, up, 0) + kOffVertical * aside), reach)
                             ? 0.25
                             : 0;
        for (int k = 0; k < kAzimuths; ++k) {
            const double turn = 2 * std::numbers::pi * (k + 0.37) / kAzimuths;
            sides += all_->anyWithin(p, {std::cos(turn), 0, std::sin(turn)}, reach) ? 4.0 / kAzimuths : 0;
        }
        return sides;
    }

    bool enclosesRoom(dvec3 middle, dvec3 way, double reach) const { // the side of a sheet there
        const dvec3 from = middle + 2 * tolerance_ * way;
        const double width = all_->nearest(from, way, 2 * kLeastOfRoom * height_); // wider ones are as good
        return width >= kLeastOfRoom * height_ &&
               sidesAbout(middleBefore(from, way, width), reach) > kEnclosed;
    }

    // A sheet of what encloses a room but for one side; none where nothing does.
    std::optional<uint32_t> wallOfRoom() const {
        size_t count = 0, next = 0;
        for (const FlatFace& sheet : sheets_) count += sheet.triangles.size();
        const size_t step = (count + kMostSamples - 1) / kMostSamples;
        double area = 0; // of sides that do
        std::optional<uint32_t> first;
        for (size_t k = 0; k < sheets_.size(); ++k)
            for (const auto& t : sheets_[k].triangles) {
                if (next++ % step != 0) continue;
                for (const double side : {1.0, -1.0})
                    if ((side > 0 || !looksIn_) &&
                        enclosesRoom(t.middle(), side * sheets_[k].normal, reach_[k])) {
                        area +=
                            0.5 * glm::length(glm::cross(t.b - t.a, t.c - t.a)) * static_cast<double>(step);
                        if (!first) first = sheets_[k].surface;
                    }
            }
        return area > kLeastWalls * height_ * height_ ? first : std::nullopt;
    }

    std::vector<FlatFace> sheets_, rooms_;
    std::vector<Bounds> boxes_;                      // of the latter
    std::optional<TriangleRays> open_, shell_, all_; // of sheets, of rooms, of both
    bool looksIn_;
    double tolerance_, height_ = 1e300; // the latter of a low room
    std::vector<double> reach_;         // per sheet: how far off what it sees may be its room's
};

} // namespace

SheetVerdict judgeSheets(const std::vector<SoupFace>& sheets, const Building& rooms, bool looksIn,
                         double tolerance) {
    const SheetJudge judge(weldFaces(sheets, 1, tolerance, true), rooms, looksIn, tolerance);
    if (const auto fault = judge.fault()) return {fault, {}};
    return {std::nullopt, judge.blindWindows()};
}

} // namespace heliodon::geometry
