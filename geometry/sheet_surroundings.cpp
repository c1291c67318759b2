#include "geometry/sheet_surroundings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "geometry/bounds.h"
#include "geometry/box_tree.h"
#include "geometry/clip_polygon.h"
#include "geometry/flat_faces.h"
#include "geometry/missing_sides.h"
#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"
#include "geometry/segment_distance.h"
#include "geometry/triangle_rays.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr int kAzimuths = 24;      // ways that are looked along about a pane's normal
constexpr double kParallel = 1e-6; // sine: planes that meet nowhere

class SheetJudge {
public:
    SheetJudge(const std::vector<FlatFace>& sheets, const std::vector<FlatFace>& rooms, double tolerance)
        : sheets_(sheets), rooms_(rooms), open_(trianglesOf(sheets), tolerance),
          shell_(trianglesOf(rooms), tolerance), tolerance_(tolerance) {
        for (const FlatFace& face : rooms_) boxes_.push_back(face.box);
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
        return std::nullopt;
    }

    // Windows, by face of the rooms, out of which every way but along the pane ends on a sheet.
    std::vector<uint32_t> blindWindows() const {
        std::vector<uint32_t> out;
        for (const FlatFace& pane : rooms_)
            if (pane.isWindow && std::ranges::all_of(waysOutOf(pane.normal), [&](dvec3 way) {
                    return open_.anyWithin(pane.triangles[0].middle(), way,
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

    // On both sides: what lies on a wall is not.
    bool isInside(const ShellTriangle& t, dvec3 normal) const {
        return std::ranges::all_of(std::array{1.0, -1.0}, [&](double side) {
            return shell_.enclose(t.middle() + 2 * side * tolerance_ * normal);
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

    const std::vector<FlatFace>&sheets_, &rooms_;
    std::vector<Bounds> boxes_; // of the latter
    TriangleRays open_, shell_; // of sheets, of rooms
    double tolerance_;
};

} // namespace

SheetVerdict judgeSheets(const std::vector<SoupFace>& sheets, const Building& rooms, bool looksIn,
                         double tolerance) {
    const Building welded = weldFaces(sheets, 1, tolerance, true);
    const std::vector<FlatFace> ofSheets = flatFacesOf(welded), ofRooms = flatFacesOf(rooms);
    const SheetJudge judge(ofSheets, ofRooms, tolerance);
    if (const auto fault = judge.fault()) return {fault, {}, {}};
    const MissingSides missing = missingSides(welded, ofSheets, rooms, ofRooms, looksIn, tolerance);
    if (missing.room)
        return {SheetFault{*missing.room, "encloses with others a space of a room's size, but for a side: "
                                          "does that lack its wall, floor or ceiling?"},
                {},
                {}};
    return {std::nullopt, judge.blindWindows(), missing.loggia};
}

} // namespace heliodon::geometry
