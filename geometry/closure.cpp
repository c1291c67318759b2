#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/building.h"
#include "geometry/clip_polygon.h"
#include "geometry/counted.h"
#include "geometry/face_soup.h"
#include "geometry/occluder_solids.h"
#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"
#include "geometry/plan_curves.h"
#include "geometry/plan_fillings.h"
#include "geometry/plan_materials.h"
#include "geometry/plan_rooms.h"
#include "geometry/plan_windows.h"
#include "geometry/refusal_words.h"
#include "geometry/room_faces.h"
#include "geometry/twin_faces.h"
#include "geometry/wall_roles.h"

namespace heliodon::geometry {

namespace {

constexpr double kWideOpening = 8 + 1e-6; // inches: a wider bridged opening is worth a warning
constexpr double kEven = 1e-4; // of a length: what walls of one class may be shorter than those of another
constexpr double kLeastSkylight = 0.005; // inches: corners nearer to one another are one (plan_overlay.cpp)
constexpr double kSameSkylight = 1e-6;   // square inches: areas are equal but for rounding
constexpr double kDoor = 2 - 1e-6;       // inches: as wide as doors are drawn
constexpr size_t kMostWalls = 500;       // the paper's table holds about twenty
constexpr size_t kMostSkylights = 1000;
constexpr double kWeld = 1e-9; // metres
constexpr double kTwinOff =
    0.1 * kMetresPerInch; // of corners of twins: the two faces of a wall are not quite parallel
constexpr double kLeastTriangle = 1e-6 * kMetresPerInch * kMetresPerInch;
constexpr double kCubicInch = kMetresPerInch * kMetresPerInch * kMetresPerInch;

std::string joined(const std::vector<std::string>& ids) {
    return fmt::format("{}", fmt::join(ids, ", "));
}

PlanWallsOptions planOptions(const ClosureOptions& options) {
    return {options.crackWidth, options.chordError, options.facetLength, options.coarseChord};
}

// What is on the table, in an order that does not depend on the file's.
Sketch onTable(const Sketch& sketch, std::vector<PlanNote>& notes, std::vector<IgnoredWall>& ignored) {
    Sketch out = sketch;
    const double radius = sketch.tableDiameter / 2;
    const auto off = [&](const auto& item, double nearest, double farthest, const char* kind) {
        if (nearest <= radius && farthest > radius + 0.5)
            notes.push_back({"WALL_OFF_TABLE", fmt::format("{} {} reaches beyond the table", kind, item.id)});
        if (nearest <= radius) return false;
        notes.push_back(
            {"WALL_OFF_TABLE", fmt::format("{} {} lies off the table and is ignored", kind, item.id)});
        ignored.push_back({item.id, "lies off the table"});
        return true;
    };
    std::erase_if(out.walls, [&](const Wall& wall) {
        const glm::dvec2 d = wall.b - wall.a;
        const double square = glm::dot(d, d),
                     t = square > 0 ? std::clamp(-glm::dot(wall.a, d) / square, 0.0, 1.0) : 0;
        return off(wall, glm::length(wall.a + t * d), std::max(glm::length(wall.a), glm::length(wall.b)),
                   "wall");
    });
    std::erase_if(out.arcs, [&](const Arc& arc) {
        const double middle = glm::length(arc.center);
        return off(arc, std::max(0.0, std::abs(middle - arc.radius)), 0, "arc");
    });
    // The largest first: of what several cover it has most, so that small ones under it add nothing, however
    // the sketch lies on the table.
    std::ranges::sort(out.skylights, {}, [](const Skylight& s) {
        return std::tuple(-std::round(s.size.x * s.size.y / kSameSkylight), s.center.x, s.center.y, s.size.x,
                          s.size.y, s.angleDeg, s.id);
    });
    return out;
}

// The longer side of the box round walls and arcs' circles, inches; 0 without any.
double spanOf(const Sketch& sketch) {
    glm::dvec2 low(1e300), high(-1e300);
    const auto add = [&](glm::dvec2 p) { low = glm::min(low, p), high = glm::max(high, p); };
    for (const Wall& wall : sketch.walls) add(wall.a), add(wall.b);
    for (const Arc& arc : sketch.arcs) add(arc.center - arc.radius), add(arc.center + arc.radius);
    return std::max({high.x - low.x, high.y - low.y, 0.0});
}

// What to say of a sketch that closes nothing and is so small or so large that its lengths may be feet,
// metres or millimetres.
std::string hintOfUnits(const Sketch& sketch) {
    constexpr double kSmall = 1.0 / 8, kLarge = 3; // of the table
    const double span = spanOf(sketch), table = sketch.tableDiameter;
    if (span == 0 || (span > kSmall * table && span < kLarge * table)) return "";
    return fmt::format("; the whole sketch spans {:.3g}, expected inches on a table {:.4g} inches across",
                       span, table);
}

class Closer {
public:
    Closer(const Sketch& sketch, const ClosureOptions& options)
        : options_(options), hintOfUnits_(hintOfUnits(sketch)), sketch_(onTable(sketch, notes_, ignored_)) {}

    Closure close() {
        const bool possible = plan() && findSpaces();
        if (possible)
            build();
        else
            roles({});
        return std::move(out_);
    }

    // Floors, ceilings and walls of the rooms and the long sides of partitions in them, square metres; 0
    // without rooms.
    double surface() {
        if (!plan() || !findSpaces()) return 0;
        double sum = 0; // square inches
        for (const RoomPlan& room : spaces_.rooms) {
            double perimeter = 0;
            for (const OutlineLoop& loop : room.loops)
                for (size_t i = 0; i < loop.points.size(); ++i)
                    perimeter += glm::length(loop.points[(i + 1) % loop.points.size()] - loop.points[i]);
            sum += 2 * room.area + perimeter * ceilingOf(room);
        }
        for (const WallPiece& piece : plan_.partitions) sum += 2 * piece.height * lengthInRooms(piece);
        return sum * kMetresPerInch * kMetresPerInch;
    }

private:
    double lengthInRooms(const WallPiece& piece) const {
        constexpr double kStep = 0.25; // inches
        const double length =
            piece.curved ? piece.radius * (piece.a1 - piece.a0) : glm::length(piece.b - piece.a);
        const double count = std::max(1.0, std::ceil(length / kStep));
        double inside = 0;
        for (double k = 0.5; k < count; ++k) {
            const double angle = glm::mix(piece.a0, piece.a1, k / count);
            const glm::dvec2 at =
                piece.curved ? piece.center + piece.radius * glm::dvec2(std::cos(angle), std::sin(angle))
                             : glm::mix(piece.a, piece.b, k / count);
            inside += inRoom(at);
        }
        return length * inside / count;
    }

    // With what was ignored: it may be why.
    void refuse(const std::string& code, const std::string& sentence) {
        out_.report.outcome = Outcome::refuse;
        out_.report.code = code;
        out_.report.message = sentence;
        std::ranges::sort(ignored_, {}, &IgnoredWall::id);
        for (const IgnoredWall& wall : ignored_)
            out_.report.message += fmt::format("; {} is ignored: it {}", wall.id, wall.reason);
        out_.report.message += hintOfUnits_;
        out_.building.reset();
    }

    void roles(const std::vector<bool>& partitionUsed) {
        out_.report.walls = wallRoles(sketch_, plan_, spaces_, partitionUsed, ignored_);
    }

    bool plan() {
        const auto tooMany = [&](size_t count, size_t most, const char* code, const char* what) {
            if (count > most)
                refuse(code, fmt::format("the sketch has {} {}, at most {} are taken", count, what, most));
            return count > most;
        };
        if (tooMany(sketch_.walls.size() + sketch_.arcs.size(), kMostWalls, "TOO_MANY_WALLS", "walls") ||
            tooMany(sketch_.skylights.size(), kMostSkylights, "TOO_MANY_SKYLIGHTS", "skylights"))
            return false;
        plan_ = planWalls(sketch_, planOptions(options_));
        notes_.insert(notes_.end(), plan_.notes.begin(), plan_.notes.end());
        ignored_.insert(ignored_.end(), plan_.ignored.begin(), plan_.ignored.end());
        if (!plan_.pieces.empty()) return true;
        if (plan_.partitions.empty())
            refuse("NO_WALLS",
                   ignored_.empty() ? "there are no walls on the table" : "no wall of the sketch is left");
        else
            refuse("ONLY_PARTITIONS", "there are only low (green) walls, which cannot enclose a room: " +
                                          joined(idsOf(plan_.partitions)));
        return false;
    }

    static std::vector<std::string> sortedIds(std::vector<std::string> ids) {
        std::ranges::sort(ids);
        return ids;
    }

    static std::vector<std::string> idsOf(const std::vector<WallPiece>& pieces) {
        std::vector<std::string> ids;
        for (const WallPiece& piece : pieces) ids.insert(ids.end(), piece.ids.begin(), piece.ids.end());
        return sortedIds(std::move(ids));
    }

    bool findSpaces() {
        spaces_ = findRooms(plan_);
        if (openDoorsInCorners(plan_, spaces_.rooms)) spaces_ = findRooms(plan_);
        cleanOutlines(plan_, spaces_);
        if (!spaces_.rooms.empty()) return true;
        refuse("NOT_ENCLOSED", whyNotEnclosed(plan_, spaces_));
        return false;
    }

    // The height class with the most wall round the room; the higher one of two that are equal but for how
    // exactly a sketch is drawn.
    double ceilingOf(const RoomPlan& room) const {
        std::map<double, double> length;
        for (const OutlineLoop& loop : room.loops)
            for (size_t i = 0; i < loop.points.size(); ++i)
                if (loop.edges[i].height > 0)
                    length[loop.edges[i].height] +=
                        glm::length(loop.points[(i + 1) % loop.points.size()] - loop.points[i]);
        double best = 10, most = 0;
        for (const auto& [height, sum] : length)
            if (sum >= (1 - kEven) * most) {
                most = std::max(most, sum);
                best = height;
            }
        return best;
    }

    // Windows and skylights with blinds of their own have a material of their own.
    template<class Opening>
    static std::vector<uint32_t> glazingOf(PlanMaterials& materials, const std::vector<Opening>& openings) {
        std::vector<uint32_t> out;
        for (const Opening& opening : openings) {
            const auto plain = materials.rooms.front().glazing;
            auto& all = materials.materials;
            Material glass = all[plain];
            glass.blind = opening.blind;
            auto found = std::ranges::find_if(
                all, [&](const Material& m) { return m.isOpening() && m.blind == glass.blind; });
            if (found == all.end()) {
                glass.name += std::to_string(
                    1 + std::ranges::count_if(all, [](const Material& m) { return m.isOpening(); }));
                found = all.insert(all.end(), glass);
            }
            out.push_back(static_cast<uint32_t>(found - all.begin()));
        }
        return out;
    }

    void build() {
        evenPartitions(plan_, spaces_.rooms);
        std::vector<double> ceilings;
        for (const RoomPlan& room : spaces_.rooms) ceilings.push_back(ceilingOf(room));
        const std::vector<WallRun> runs = wallRuns(plan_, spaces_.rooms);
        PlanMaterials materials = planMaterials(sketch_, plan_, spaces_.rooms, runs, options_);
        notes_.insert(notes_.end(), materials.notes.begin(), materials.notes.end());
        PlanWindows windows = placeWindows(sketch_, plan_, runs, ceilings);
        notes_.insert(notes_.end(), windows.notes.begin(), windows.notes.end());
        const auto make = [&](const std::vector<WindowHole>& holes) {
            Shells made{roomFaces({plan_, spaces_.rooms, runs, sketch_.skylights, ceilings, materials.rooms,
                                   materials.runs, materials.partitions, holes, glazingOf(materials, holes),
                                   glazingOf(materials, sketch_.skylights)}),
                        {}};
            made.building = weldFaces(made.faces.faces, static_cast<uint32_t>(spaces_.rooms.size()), kWeld);
            return made;
        };
        Shells made = make(windows.holes);
        if (!glassesCorrespond(made)) made = leaveOutOddWindows(windows, make);
        const RoomFaces& faces = made.faces;
        Building& building = made.building;
        building.materials = materials.materials;
        building.occluders = occluderSolids(plan_, spaces_.rooms);
        if (sketch_.north) building.northDeg = sketch_.north->dirDeg;
        building.northIsSaid = sketch_.north.has_value();

        out_.report.windowCount = windows.openings;
        out_.report.skylightPaneCount = faces.skylightPanes;
        noteSkylights(faces);
        roles(faces.partitionUsed);
        if (prove(made, ceilings)) {
            out_.building = std::move(building);
            conclude();
        }
    }

    void noteSkylights(const RoomFaces& faces) {
        for (size_t i = 0; i < sketch_.skylights.size(); ++i) {
            if (faces.skylightUsed[i]) continue;
            const Skylight& skylight = sketch_.skylights[i];
            if (std::min(skylight.size.x, skylight.size.y) < kLeastSkylight && inRoom(skylight.center))
                notes_.push_back({"SKYLIGHT_TOO_SMALL",
                                  fmt::format("skylight {} is too small and is ignored", skylight.id)});
            else if (mostOverRoom(skylight) >= kSmallestPane)
                notes_.push_back(
                    {"SKYLIGHT_COVERED",
                     fmt::format("skylight {} lies under others and adds nothing", skylight.id)});
            else
                notes_.push_back({"SKYLIGHT_OUTSIDE",
                                  fmt::format("skylight {} lies over no room and is ignored", skylight.id)});
        }
    }

    bool inRoom(glm::dvec2 p) const {
        return std::ranges::any_of(spaces_.rooms, [&](const RoomPlan& room) { return contains(room, p); });
    }

    // Square inches over the room of which it covers most.
    double mostOverRoom(const Skylight& skylight) const {
        const double angle = skylight.angleDeg * std::numbers::pi / 180;
        const glm::dvec2 u{std::cos(angle), std::sin(angle)};
        const std::array sides{std::pair(u, skylight.size.x), std::pair(-u, skylight.size.x),
                               std::pair(leftOf(u), skylight.size.y), std::pair(-leftOf(u), skylight.size.y)};
        double most = 0;
        std::vector<glm::dvec2> part, rest;
        for (const RoomPlan& room : spaces_.rooms) {
            double area = 0;
            for (const OutlineLoop& loop : room.loops) { // any polygon: what joins its parts has no area
                part = loop.points;
                for (const auto& [out, size] : sides) {
                    const auto within = [&](glm::dvec2 p) {
                        return size / 2 - glm::dot(p - skylight.center, out);
                    };
                    clip(part, within, rest);
                    std::swap(part, rest);
                }
                area += twiceArea(part) / 2;
            }
            most = std::max(most, area);
        }
        return most;
    }

    struct Shells {
        RoomFaces faces;
        Building building;
    };

    // What passes an interior window arrives on its other side: no glass there is without a twin.
    static bool glassesCorrespond(const Shells& made) {
        const auto drawn =
            std::ranges::count_if(made.faces.faces, [](const SoupFace& f) { return f.twinKey >= 0; });
        const auto paired =
            std::ranges::count_if(made.building.faces, [](const Face& f) { return f.twin >= 0; });
        return drawn == paired && twinsMirror(made.building, kTwinOff);
    }

    // Where walls cross at a small angle the two sides of an interior window may have different shapes. The
    // one window that is at fault, or all of them, are left out.
    template<class Make> Shells leaveOutOddWindows(PlanWindows& windows, Make make) {
        std::set<int> interior;
        for (const WindowHole& hole : windows.holes)
            if (hole.twin) interior.insert(hole.opening);
        std::vector<std::set<int>> tries;
        for (const int opening : interior) tries.push_back({opening});
        tries.push_back(interior);
        for (const std::set<int>& odd : tries) {
            std::vector<WindowHole> kept;
            std::set<std::string> ids;
            for (const WindowHole& hole : windows.holes)
                if (odd.contains(hole.opening))
                    ids.insert(hole.id);
                else
                    kept.push_back(hole);
            Shells made = make(kept);
            if (!glassesCorrespond(made) && odd != interior) continue;
            windows.openings -= static_cast<int>(odd.size());
            for (const std::string& id : ids)
                notes_.push_back({"WINDOW_SIDES_DIFFER",
                                  fmt::format("window {} is ignored: the two sides of its wall differ", id)});
            return made;
        }
        return make(windows.holes);
    }

    // Per room, of the coordinates as they are stored: the sum over floor and partition tops of area times
    // the height to the ceiling, in cubic metres.
    static std::vector<double> columnVolumes(const Building& building, const std::vector<double>& ceilings) {
        std::vector<double> volumes(building.roomCount, 0);
        for (const Face& face : building.faces) {
            double twice = 0; // of the area seen from above
            for (const auto& loop : face.loops) {
                const glm::dvec3 origin = building.vertices[loop[0]];
                for (size_t i = 1; i + 1 < loop.size(); ++i) {
                    const glm::dvec3 a = building.vertices[loop[i]] - origin,
                                     b = building.vertices[loop[i + 1]] - origin;
                    twice += a.z * b.x - a.x * b.z;
                }
            }
            const double top = kMetresPerInch * ceilings[face.room],
                         y = building.vertices[face.loops[0][0]].y;
            if (twice > 0) volumes[face.room] += 0.5 * twice * (top - y);
        }
        return volumes;
    }

    bool prove(const Shells& made, const std::vector<double>& ceilings) {
        const auto& [faces, building] = made;
        const std::vector<ShellProof> proofs = proveShells(building);
        const std::vector<double> columns = columnVolumes(building, ceilings);
        std::vector<RoomPlan> doubtful;
        for (size_t r = 0; r < proofs.size(); ++r) {
            RoomReport room;
            room.floorAreaFt2 = faces.floorArea[r];
            room.volumeFt3 = proofs[r].volume / kCubicInch;
            room.ceilingFt = ceilings[r];
            room.euler = proofs[r].euler;
            room.closed = proofs[r].closed;
            room.selfIntersecting = proofs[r].selfIntersecting;
            out_.report.rooms.push_back(room);
            const double expected = (faces.floorArea[r] + faces.lowArea[r]) * ceilings[r] -
                                    faces.lowArea[r] * heightInches(HeightClass::green);
            // As planned, but for the welding; as built, but for rounding.
            const bool volumeFits = std::abs(room.volumeFt3 - expected) <= 1e-6 * expected &&
                                    std::abs(proofs[r].volume - columns[r]) <= 1e-9 * columns[r];
            if (!(room.closed && !room.selfIntersecting && volumeFits &&
                  proofs[r].leastArea >= kLeastTriangle))
                doubtful.push_back(spaces_.rooms[r]);
        }
        const bool paired = glassesCorrespond(made), good = paired && doubtful.empty();
        if (!good) refuse("NOT_PROVEN", whyNotProven(plan_, paired ? doubtful : spaces_.rooms));
        return good;
    }

    // Holes of a door's size that were closed, each with the walls beside it; of wider ones there is a note.
    std::vector<std::string> closedDoors() const {
        std::set<std::string> sentences; // a hole between two rooms is in the outlines of both
        for (const RoomPlan& room : spaces_.rooms)
            for (const OutlineLoop& loop : room.loops) {
                const size_t n = loop.edges.size();
                for (size_t first = 0; first < n; ++first) {
                    if (!loop.edges[first].gap || loop.edges[(first + n - 1) % n].gap) continue;
                    double width = 0;
                    size_t end = first;
                    for (; loop.edges[end % n].gap; ++end)
                        width += glm::length(loop.points[(end + 1) % n] - loop.points[end % n]);
                    if (width < kDoor || width > kWideOpening) continue;
                    sentences.insert(fmt::format("an opening {:.1f} ft wide beside {} was closed", width,
                                                 joined(wallsBeside(plan_, loop, first, end))));
                }
            }
        return {sentences.begin(), sentences.end()};
    }

    void conclude() {
        ClosureReport& report = out_.report;
        for (const RoomPlan& room : spaces_.rooms)
            if (room.widestGap > kWideOpening)
                notes_.push_back(
                    {"WIDE_OPENING", fmt::format("an opening {:.1f} ft wide was closed", room.widestGap)});
        std::ranges::sort(notes_, {}, [](const PlanNote& n) { return std::pair(n.code, n.sentence); });
        report.message = counted(report.rooms.size(), "room");
        std::vector<std::string> outside;
        for (const WallRole& wall : report.walls)
            if (wall.role == "outside_extra") outside.push_back(wall.id);
        if (!outside.empty())
            report.message +=
                fmt::format("; {} enclose{} nothing and only cast{} shadows", joined(sortedIds(outside)),
                            outside.size() == 1 ? "s" : "", outside.size() == 1 ? "s" : "");
        for (const WallRole& wall : report.walls)
            if (wall.reason.starts_with("repeats")) report.message += "; " + wall.id + " " + wall.reason;
        for (const std::string& door : closedDoors()) report.message += "; " + door;
        for (const std::string& space : spaces_.outside) report.message += "; " + space;
        for (const PlanNote& note : notes_) report.message += "; " + note.sentence;
        report.outcome = notes_.empty() ? Outcome::ok : Outcome::warn;
        report.code = notes_.empty() ? "OK" : notes_[0].code;
    }

    const ClosureOptions& options_;
    std::string hintOfUnits_; // of the whole sketch, for refusals
    std::vector<PlanNote> notes_;
    std::vector<IgnoredWall> ignored_;
    Sketch sketch_;
    PlanWalls plan_;
    PlanRooms spaces_;
    Closure out_;
};

} // namespace

Closure closeSketch(const Sketch& sketch, const ClosureOptions& options) {
    return Closer(sketch, options).close();
}

double surfaceOfRooms(const Sketch& sketch, const ClosureOptions& options) {
    return Closer(sketch, options).surface();
}

std::vector<int> facetsOfArcs(const Sketch& sketch, const ClosureOptions& options) {
    const PlanWalls plan = planWalls(sketch, planOptions(options));
    std::vector<int> facets;
    for (const auto* pieces : {&plan.pieces, &plan.partitions})
        for (const WallPiece& piece : *pieces)
            if (piece.curved) facets.push_back(piece.facets);
    return facets;
}

} // namespace heliodon::geometry
