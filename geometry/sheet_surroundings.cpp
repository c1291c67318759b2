#include "geometry/sheet_surroundings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <string_view>
#include <tuple>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "geometry/bounds.h"
#include "geometry/box_tree.h"
#include "geometry/clip_polygon.h"
#include "geometry/counted.h"
#include "geometry/face_crossing.h"
#include "geometry/flat_faces.h"
#include "geometry/ground_in_rooms.h"
#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"
#include "geometry/triangle_rays.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr int kAzimuths = 24; // ways that are looked along about a pane's normal

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
                                    [&](const auto& t) { return isWithin(shell_, t, tolerance_); }) ||
                tree.anyHolding(sheet.box.high + kRightBefore * tolerance_,
                                sheet.box.low - kRightBefore * tolerance_,
                                [&](uint32_t i) { return isRightBefore(sheet, rooms_[i]); }))
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

    bool meet(const FlatFace& sheet, const FlatFace& wall) const {
        return facesCross(sheet, wall, tolerance_) || (wall.isGlass && covers(sheet, wall, tolerance_));
    }

    // Nearer than the middle of a triangle of it could be told to lie in the room.
    bool isRightBefore(const FlatFace& sheet, const FlatFace& wall) const {
        return std::ranges::all_of(sheet.loops[0], [&](dvec3 p) { return wall.height(p) >= 0; }) &&
               std::ranges::any_of(sheet.loops[0], [&](dvec3 p) { return wall.height(p) > 0; }) &&
               covers(sheet, wall, kRightBefore * tolerance_);
    }

    // In the plane of the pane, to within `near`, and, more than by its border, over it.
    bool covers(const FlatFace& sheet, const FlatFace& pane, double near) const {
        if (std::ranges::any_of(sheet.loops[0], [&](dvec3 p) { return std::abs(pane.height(p)) > near; }))
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

    static constexpr double kWithin = 2; // tolerances: what isWithin() asks to be of a room beside a sheet
    static constexpr double kRightBefore = 3 * kWithin; // a corner, where the other two are on the wall

    const std::vector<FlatFace>&sheets_, &rooms_;
    std::vector<Bounds> boxes_; // of the latter
    TriangleRays open_, shell_; // of sheets, of rooms
    double tolerance_;
};

} // namespace

SheetVerdict judgeSheets(const std::vector<SoupFace>& sheets, const Building& rooms,
                         const std::vector<SoupFace>& solids, bool looksIn, double worldPerBuilding,
                         double tolerance) {
    const Building welded = weldFaces(sheets, 1, tolerance, true);
    const std::vector<FlatFace> ofSheets = flatFacesOf(welded), ofRooms = flatFacesOf(rooms);
    const SheetJudge judge(ofSheets, ofRooms, tolerance);
    if (const auto fault = judge.fault()) return {fault, {}, {}};
    const GroundAndOthers parts = groundAmong(sheets, rooms, tolerance);
    const std::vector<FlatFace> solidGround =
        flatFacesOf(weldFaces(groundAmong(solids, rooms, tolerance).ground, 1, tolerance, true));
    MissingSides missing =
        missingSides(welded, ofSheets, rooms, ofRooms, solidGround, looksIn, worldPerBuilding, tolerance);
    if (!missing.room && parts.ground.size() + solidGround.size() > 0) {
        const Building others = weldFaces(parts.others, 1, tolerance, true);
        const MissingSides without = missingSides(others, flatFacesOf(others), rooms, ofRooms, {}, looksIn,
                                                  worldPerBuilding, tolerance);
        missing.room = without.room;
        if (!missing.low) missing.low = without.low;
    }
    if (missing.room)
        return {SheetFault{missing.room->surface,
                           fmt::format("encloses with others a space of a room's size that lacks {}",
                                       missing.room->side == std::string_view("wall")
                                           ? "a wall, or a door or glass in one"
                                           : fmt::format("its {}", missing.room->side))},
                {},
                {}};
    return {std::nullopt, judge.blindWindows(), missing};
}

std::string sheetsOutside(const std::vector<SoupFace>& sheets,
                          const std::function<std::string(uint32_t)>& place) {
    std::set<uint32_t> drawn;
    for (const SoupFace& sheet : sheets) drawn.insert(sheet.surface);
    return fmt::format("{} (the first at {}) {} taken to stand outside, as an overhang or the ground drawn "
                       "as one plane: enclosing nothing, seen from both sides",
                       counted(drawn.size(), "open face"), place(*drawn.begin()),
                       drawn.size() == 1 ? "was" : "were");
}

std::vector<std::string> warningsOf(const SheetVerdict& verdict,
                                    const std::function<std::string(uint32_t)>& place,
                                    const std::vector<uint32_t>& source) {
    std::vector<std::string> out;
    const MissingSides& missing = verdict.missing;
    for (const auto& [found, what, as] :
         {std::tuple(missing.loggia, "a space before a window", "a loggia"),
          {missing.court, "a space before windows", "a courtyard"},
          {missing.low, "a low space", "outside, as a kennel, an open attic or a walled garden"}})
        if (found)
            out.push_back(
                fmt::format("{} that lacks its {} (of {} and others) was taken as {}, not as a room", what,
                            found->side, place(found->surface), as));
    const std::vector<uint32_t>& blind = verdict.blindWindows;
    if (!blind.empty())
        out.push_back(fmt::format(
            "{} (the first at {}) {} at nothing but these: light enters past their edges alone",
            counted(blind.size(), "window"), place(source[blind[0]]), blind.size() == 1 ? "looks" : "look"));
    return out;
}

} // namespace heliodon::geometry
