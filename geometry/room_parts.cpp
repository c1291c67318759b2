#include "geometry/room_parts.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/bounds.h"
#include "geometry/counted.h"
#include "geometry/ground_in_rooms.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

// A small thing: of the largest room's volume. A thin one, as walls, columns and cupboards are: twice its
// volume over its surface, of the largest room's height (a wall 0.2 m thick 0.07, a cupboard 0.6 m square
// 0.09, a lavatory of 0.9 by 1.2 m 0.18).
constexpr double kSmall = 0.05, kThin = 0.12;
constexpr double kNothing = 1e-3; // of a part's surface

class RoomFinder {
public:
    RoomFinder(const SpaceParts& space, double tolerance) : space_(space), tolerance_(tolerance) {}

    RoomParts find() {
        placeParts();
        out_.warnings = guesses();
        return std::move(out_);
    }

private:
    const SpacePart& partOf(uint32_t id) const { return space_.parts.at(id); }
    bool isAir(uint32_t id) const { return partOf(id).volume > 0 && !solid_.contains(id); }

    // Air for its glass: an alcove, or what lies between two panes unless it is the inside of a wall, whose
    // faces look out and which is no glass for the most part.
    static bool isBehindGlass(const SpacePart& part, const SpacePart& largest) {
        return part.alcove || (part.between && (part.glass >= 0.5 * part.area || !contrary(part, largest)));
    }

    // How a part of space stands in another one, told from what was drawn of its boundary.
    struct Stand {
        bool within = false; // it takes a piece out of a room that was drawn without regard to it
        bool touchesWall = false;
        bool drawnThere = false; // it has faces of its own where it touches that room's
    };

    static bool contrary(const SpacePart& part, const SpacePart& largest) {
        return largest.looksIn() && part.looksOut();
    }

    static bool isSolid(const Stand& stand, const SpacePart& part, const SpacePart& largest, double height) {
        const bool thin = 2 * part.volume < kThin * height * part.area,
                   agreed = largest.looksIn() && part.looksIn();
        if (contrary(part, largest))
            return thin || (stand.within && (!stand.touchesWall || part.volume < kSmall * largest.volume));
        if (!stand.within) return false;
        if (!stand.touchesWall) return thin || !agreed; // a column, a block on the floor
        return thin && stand.drawnThere && !agreed;
    }

    // However large, as in nestShells(): a neighbour, the ground. That is told by its size, too, where rooms
    // share faces that look out of them.
    bool isBodyOutside(const SpacePart& part, const SpacePart& largest) const {
        if (part.glass > 0 || largest.window == 0) return false;
        if (contrary(part, largest) || (insideOut_ && part.looksIn())) return true;
        if (largest.looksOut() || !part.looksOut()) return false;
        const Bounds box = part.box(), house = boxOfWindows();
        return box.low.y < house.low.y - tolerance_ && isMuchLarger(box, house);
    }

    Bounds boxOfWindows() const { // of what has them
        Bounds out{dvec3(1e300), dvec3(-1e300)};
        for (const auto& [id, part] : space_.parts) {
            if (!isAir(id) || part.window == 0) continue;
            out = united(out, part.box());
        }
        return out;
    }

    Stand standOf(uint32_t id) const {
        const SpacePart& part = partOf(id);
        Stand out;
        double alone = 0; // where nothing but its own faces parts it from the outside
        bool touches = false;
        for (uint32_t f = 0; f < space_.welded.faces.size(); ++f)
            for (uint32_t s = 0; s < 2; ++s) {
                const uint32_t other = space_.partAt(f, 1 - s);
                if (space_.partAt(f, s) != id || other == id) continue;
                touches |= solid_.contains(other);
                if (partOf(other).volume > 0) continue;
                const auto& drawn = space_.sheetOf(f).drawn;
                bool beyond = false, own = false; // faces that reach beyond its own boundary
                for (const auto& list : drawn)
                    for (const uint32_t k : list)
                        (space_.drawn[k].borders->contains(id) ? own : beyond) = true;
                if (!beyond && (drawn[0].empty() || drawn[1].empty())) {
                    alone += space_.area[f];
                    continue;
                }
                touches = true;
                out.drawnThere |= own;
                out.touchesWall |= std::abs(space_.normalOf(f).y) < 0.7;
            }
        out.within = touches && alone < kNothing * part.area;
        return out;
    }

    // Nothing but the air of a room with windows is about it, which it touches in edges alone.
    bool isIsland(const SpacePart& part) const {
        if (part.glass > 0 || part.neighbours.size() != 1) return false;
        const SpacePart& around = partOf(*part.neighbours.begin());
        return around.volume > 0 && around.window > 0 && around.shell == part.shell;
    }

    // Which parts are rooms, and of which room's air those are that lie outside of a shell.
    void placeParts() {
        std::map<uint32_t, std::vector<uint32_t>> shells; // parts of each
        for (const auto& [id, part] : space_.parts) shells[part.shell].push_back(id);
        std::map<uint32_t, std::vector<uint32_t>> around; // per shell: bounded parts of others that hold it
        for (const auto& [shell, own] : shells) {
            // A part between faces that lie on one another may have none.
            const auto drawn =
                std::ranges::find_if(own, [&](uint32_t id) { return !partOf(id).triangles.empty(); });
            if (drawn == own.end()) continue;
            for (const auto& [id, part] : space_.parts)
                if (part.shell != shell && part.volume > 0 && !part.triangles.empty() &&
                    crossings(part.triangles, partOf(*drawn).triangles.front().middle()) % 2 == 1)
                    around[shell].push_back(id);
        }
        const auto nested = [&](uint32_t shell) { return around[shell].size() % 2 == 1; };
        for (const auto& [id, part] : space_.parts)
            if (part.inGlass) solid_.insert(id);
        dropOutsides(shells, around);
        findWallsOfWindows(shells, around);
        for (const auto& [id, part] : space_.parts) // nothing but a closed box in a room's air
            if (part.volume > 0 && nested(part.shell) && shells[part.shell].size() == 2) solid_.insert(id);
        for (const auto& [id, part] : space_.parts)
            if (part.volume > 0 && isIsland(part)) solid_.insert(id);
        findWallsAllRound();
        findSolids(nested);
        for (const auto& [id, part] : space_.parts)
            if (isAir(id)) out_.room[id] = out_.count++;
        for (const auto& [id, part] : space_.parts) {
            if (part.volume > 0 || !nested(part.shell)) continue;
            const auto& holders = around[part.shell];
            const auto holder = out_.room.find(*std::ranges::max_element(
                holders, {}, [&](uint32_t o) { return around[partOf(o).shell].size(); }));
            if (holder != out_.room.end()) out_.room[id] = holder->second;
        }
        countSolids();
    }

    // Those found, by whether a room's air touches them.
    void countSolids() {
        std::set<uint32_t> inRooms;
        for (uint32_t f = 0; f < space_.welded.faces.size(); ++f)
            for (uint32_t s = 0; s < 2; ++s)
                if (out_.room.contains(space_.partAt(f, 1 - s))) inRooms.insert(space_.partAt(f, s));
        for (const auto& [id, volume] : found_) {
            if (!inRooms.contains(id)) {
                ++solidsOutside_;
                continue;
            }
            ++solids_;
            largestSolid_ = std::max(largestSolid_, volume);
        }
    }

    // The outside of walls that have a thickness is no room, as in nestShells().
    void dropOutsides(const std::map<uint32_t, std::vector<uint32_t>>& shells,
                      std::map<uint32_t, std::vector<uint32_t>>& around) {
        constexpr double kFilled = 0.125;
        std::vector<uint32_t> outsides;
        for (const auto& [id, outer] : space_.parts) {
            if (outer.volume <= 0 || shells.at(outer.shell).size() != 2 || !around[outer.shell].empty() ||
                !outer.looksOut())
                continue;
            double filled = 0;
            bool inwards = true;
            for (const auto& [other, part] : space_.parts)
                if (part.volume > 0 && around[part.shell] == std::vector<uint32_t>{id}) {
                    filled += part.volume;
                    inwards = inwards && part.looksIn();
                }
            if (inwards && filled > kFilled * outer.volume) outsides.push_back(id);
        }
        for (const uint32_t id : outsides) {
            solid_.insert(id);
            for (auto& [shell, holders] : around) std::erase(holders, id);
        }
        outsides_ = outsides.size();
    }

    // Walls, however thick, round rooms that have windows: glass has none in them. What touches such a room
    // and the outside is its walls where nothing but that and glass parts the rooms from the outside, unless
    // its faces look as theirs do; where several parts do, or floors and ceilings are drawn without
    // thickness, it must look out, and in the latter case reach as far as the rooms all round.
    std::vector<uint32_t> wallsOfWindows(const std::vector<uint32_t>& parts) {
        std::vector<uint32_t> rooms, walls;
        Bounds all{dvec3(1e300), dvec3(-1e300)};
        bool open = false, lookIn = true, lookOut = true;
        double largest = 0; // what is small beside it, as bars of a frame, is found with other solids
        for (const uint32_t id : parts) {
            const SpacePart& part = partOf(id);
            if (part.volume <= 0 || part.window == 0) continue;
            rooms.push_back(id);
            all = united(all, part.box());
            open |= part.open > kNothing * part.area;
            lookIn &= part.looksIn(), lookOut &= part.looksOut();
            largest = std::max(largest, part.volume);
        }
        for (const uint32_t id : parts) {
            const SpacePart& part = partOf(id);
            if (part.volume <= kSmall * largest || solid_.contains(id) || part.glass > 0 || part.open == 0)
                continue;
            const bool beside =
                std::ranges::any_of(rooms, [&](uint32_t room) { return part.neighbours.contains(room); });
            if (beside && !(lookIn && part.looksIn()) && (!open || isRound(part.box(), all, tolerance_)))
                walls.push_back(id);
        }
        if (open || walls.size() > 1)
            std::erase_if(walls, [&](uint32_t id) { return !lookIn || !partOf(id).looksOut(); });
        for (const uint32_t id : walls) insideOut_ |= lookOut && partOf(id).looksIn();
        return walls;
    }

    void findWallsOfWindows(const std::map<uint32_t, std::vector<uint32_t>>& shells,
                            std::map<uint32_t, std::vector<uint32_t>>& around) {
        for (const auto& [shell, own] : shells) {
            if (!around[shell].empty()) continue;
            for (const uint32_t id : wallsOfWindows(own)) {
                ++out_.walls;
                solid_.insert(id);
                for (auto& [other, holders] : around) std::erase(holders, id);
            }
        }
    }

    // On all six sides, or no more than `within` short of it.
    static bool isRound(const Bounds& box, const Bounds& inner, double within = 0) {
        return glm::all(glm::lessThan(box.low, inner.low + within)) &&
               glm::all(glm::greaterThan(box.high, inner.high - within));
    }

    // What is round all others, no larger than these together, with faces that look out of it.
    void findWallsAllRound() {
        for (const auto& [id, part] : space_.parts) {
            if (!isAir(id) || !part.looksOut()) continue;
            const Bounds box = part.box();
            double inner = 0;
            bool round = true;
            for (const auto& [other, room] : space_.parts) {
                if (other == id || !isAir(other)) continue;
                inner += room.volume;
                round = round && !room.looksOut() && isRound(box, room.box());
            }
            if (!round || inner < part.volume) continue;
            solid_.insert(id);
            ++out_.walls;
        }
    }

    // What stands on a solid is one after that was found. Compared with the largest room, of those with
    // windows where there are any: the ground below a house may be larger.
    template<class Nested> void findSolids(Nested nested) {
        const bool windows = std::ranges::any_of(
            space_.parts, [&](const auto& p) { return isAir(p.first) && p.second.window > 0; });
        const auto air = [&](const auto& p) {
            return isAir(p.first) && (!windows || p.second.window > 0) ? p.second.volume : 0;
        };
        const auto& [first, largest] = *std::ranges::max_element(space_.parts, {}, air);
        const Bounds room = largest.box();
        const double height = room.high.y - room.low.y;
        for (bool changed = true; changed;) {
            changed = false;
            contrary_ = insides_ = 0;
            for (const auto& [id, part] : space_.parts) {
                if (id == first || !isAir(id) || isBehindGlass(part, largest)) continue;
                Stand stand = standOf(id);
                stand.within |= nested(part.shell);
                if (isSolid(stand, part, largest, height)) {
                    changed = true;
                    solid_.insert(id);
                    if (isRound(part.box(), room)) {
                        ++out_.walls;
                        continue;
                    }
                    found_[id] = part.volume / largest.volume;
                } else if (isBodyOutside(part, largest)) {
                    changed = true;
                    solid_.insert(id);
                    ++solidsOutside_;
                } else {
                    contrary_ += contrary(part, largest);
                    insides_ += stand.within && !stand.touchesWall;
                }
            }
        }
    }

    std::vector<std::string> guesses() const {
        const auto oneOrMany = [](size_t n, const char* one, const char* many) {
            return n == 1 ? fmt::format("1 {}", one) : fmt::format("{} {}", n, many);
        };
        std::vector<std::string> out;
        if (outsides_ > 0)
            out.push_back(oneOrMany(outsides_,
                                    "outside of walls was left out: only shells within it are rooms",
                                    "outsides of walls were left out: only shells within them are rooms"));
        if (solids_ > 0)
            out.push_back(
                fmt::format("{} {:.2g} % of the largest room's volume: what stands in a room is solid unless "
                            "its faces look into it as those of the room do, and so is what is small or thin "
                            "and has faces that look out",
                            oneOrMany(solids_, "solid was cut out of the room where it stands, of",
                                      "solids were cut out of the room where they stand, the largest of"),
                            100 * largestSolid_));
        if (solidsOutside_ > 0) out.push_back(solidsOutside(solidsOutside_));
        if (insides_ > 0)
            out.push_back(oneOrMany(
                insides_, "space within a room was taken as a room of its own: its faces look into it",
                "spaces within a room were taken as rooms: their faces look into them"));
        if (contrary_ > 0)
            out.push_back(oneOrMany(
                contrary_,
                "space was taken as a room though its faces look out of it (those of the largest look in)",
                "spaces were taken as rooms though their faces look out of them (those of the largest look "
                "in)"));
        return out;
    }

    const SpaceParts& space_;
    double tolerance_;
    RoomParts out_;
    std::set<uint32_t> solid_;
    std::map<uint32_t, double>
        found_; // solids that stand against walls or floors: of the largest part's volume
    size_t solids_ = 0, solidsOutside_ = 0; // of these; the latter with bodies of their own
    double largestSolid_ = 0;
    bool insideOut_ = false;            // rooms and the walls round them are drawn so, as all else then is
    size_t outsides_ = 0;               // of walls with a thickness
    size_t contrary_ = 0, insides_ = 0; // rooms whose faces look out, or that stand in others
};

} // namespace

RoomParts roomsAmong(const SpaceParts& space, double tolerance) {
    return RoomFinder(space, tolerance).find();
}

} // namespace heliodon::geometry
