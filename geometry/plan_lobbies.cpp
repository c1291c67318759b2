#include "geometry/plan_lobbies.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/geometric.hpp>

#include "geometry/disjoint_sets.h"
#include "geometry/plan_regions.h"

namespace heliodon::geometry {

namespace {

constexpr double kBesideHole = 0.25;  // of its width: how much wall a space sees beside a hole at least
constexpr double kNearlyBeside = 0.1; // and what is no more than an error in the walls of a recess
constexpr double kLeast = 0.5;        // inches: less of a wall is none

using Sides = std::set<int>; // straight sides: more than one where a hole parts pieces out of line

class LobbyFinder {
public:
    LobbyFinder(const PlanWalls& plan, const PlanLines& lines, const PlanArrangement& map,
                const std::vector<bool>& solid, const std::vector<bool>& inside, LobbyHoles holes)
        : plan_(plan), lines_(lines), map_(map), solid_(solid), inside_(inside), holes_(holes),
          cells_(map.cellCount) {
        for (uint32_t h = 0; h < map.cell.size(); h += 2)
            if (isAir(map.cell[h]) && isAir(map.cell[h + 1]) && holeIn(h).empty())
                cells_.join(map.cell[h], map.cell[h + 1]);
        spaces_[cells_.root(0)].closed = false;
        for (uint32_t h = 0; h < map.cell.size(); ++h) addBorder(h);
    }

    void see(const SeenWall& wall) {
        const uint32_t own = map_.cell[wall.half];
        if (!isAir(own)) return;
        const int side = plan_.pieces[static_cast<size_t>(wall.piece)].line;
        spaces_[cells_.root(own)].seen[side] += length(wall.half);
        spaces_[cells_.root(own)].pieces[wall.piece] += length(wall.half);
        seen_[side] += length(wall.half);
    }

    std::vector<bool> find() {
        std::vector<bool> out = inside_;
        for (uint32_t c = 0; c < map_.cellCount; ++c)
            if (isAir(c)) out[c] = isLobby(spaces_[cells_.root(c)]);
        openDoors(out);
        return out;
    }

    // By the walls that they see.
    std::map<std::set<std::string>, std::string> nearly(double leastArea) {
        const std::vector<double> areas = cellAreas(map_);
        std::map<uint32_t, double> area;
        for (uint32_t c = 0; c < map_.cellCount; ++c) area[cells_.root(c)] += areas[c];
        std::map<std::set<std::string>, std::string> out;
        for (auto& [root, space] : spaces_) {
            if (space.holes.empty() || area[root] < leastArea) continue;
            if (isLobby(space) || !isLobby(space, kNearlyBeside)) continue;
            std::set<std::string> walls;
            for (const auto& [piece, length] : space.pieces)
                if (const auto& ids = plan_.pieces[static_cast<size_t>(piece)].ids; length >= kLeast)
                    walls.insert(ids.begin(), ids.end());
            double open = 0;
            for (const auto& [sides, length] : space.holes) open += length;
            out.emplace(walls, fmt::format("the space between {}, open by {:.1f} ft, is outside",
                                           fmt::join(walls, ", "), open));
        }
        return out;
    }

private:
    struct Space {
        bool closed = true;            // but for holes of straight sides
        std::map<Sides, double> holes; // length of what is open between their walls
        std::map<int, double> seen;    // straight side: length of its walls
        std::map<int, double> pieces;  // and of each piece
    };

    double length(uint32_t half) const {
        return glm::length(map_.points[map_.target[half]] - map_.points[map_.source(half)]);
    }

    bool isAir(uint32_t cell) const { return !solid_[cell] && !inside_[cell]; }

    Sides holeIn(uint32_t half) const {
        Sides sides;
        for (const PlanArrangement::Tag& tag : map_.tags[half / 2])
            if (const PlanLine& line = lines_.lines[static_cast<size_t>(tag.tag)]; line.alongSide >= 0)
                sides.insert(line.alongSide);
            else if (holes_ == LobbyHoles::outOfLine && line.facade[0] >= 0)
                sides.insert(line.facade.begin(), line.facade.end());
            else if (holes_ == LobbyHoles::beforeEnds && line.lengthens >= 0)
                sides.insert(line.lengthens);
        return sides;
    }

    void addBorder(uint32_t half) {
        const uint32_t own = map_.cell[half], other = map_.cell[half ^ 1u];
        if (inside_[own] && isAir(other)) doors_.insert(holeIn(half));
        if (!isAir(own) || solid_[other] || cells_.root(own) == cells_.root(other)) return;
        Space& space = spaces_[cells_.root(own)];
        if (inside_[other])
            space.closed = false;
        else
            space.holes[holeIn(half)] += length(half);
    }

    bool isLobby(Space& space, double besideHole = kBesideHole) {
        return space.closed && std::ranges::all_of(space.holes, [&](const auto& hole) {
                   return isFilled(space, hole.first, besideHole * hole.second);
               });
    }

    // Beside a door one sees wall; beside a hole in an outer wall, which that of a court at the end of a
    // passage is not, one does from both its sides.
    bool isFilled(Space& space, const Sides& sides, double least) {
        double own = 0, all = 0;
        for (const int side : sides) {
            own += space.seen[side];
            all += seen_[side];
        }
        return (doors_.contains(sides) ? own : std::min(own, all - own)) >= least;
    }

    // A door between a lobby and a room, taken for a hole in the facade until now, is open.
    void openDoors(std::vector<bool>& out) {
        std::set<uint32_t> toRoom, toLobby;
        for (uint32_t h = 0; h < map_.cell.size(); ++h) {
            const uint32_t own = map_.cell[h], other = map_.cell[h ^ 1u];
            if (!isAir(own) || out[own] || !spaces_[cells_.root(own)].seen.empty()) continue;
            if (out[other]) (inside_[other] ? toRoom : toLobby).insert(cells_.root(own));
        }
        for (uint32_t c = 0; c < map_.cellCount; ++c)
            if (isAir(c) && toRoom.contains(cells_.root(c)) && toLobby.contains(cells_.root(c)))
                out[c] = true;
    }

    const PlanWalls& plan_;
    const PlanLines& lines_;
    const PlanArrangement& map_;
    const std::vector<bool>&solid_, &inside_;
    LobbyHoles holes_;
    DisjointSets cells_; // of air: spaces
    std::map<uint32_t, Space> spaces_;
    std::map<int, double> seen_; // straight side: length of its walls that some space outside rooms sees
    std::set<Sides> doors_;      // holes that rooms open to
};

} // namespace

std::vector<bool> withLobbies(const PlanWalls& plan, const PlanLines& lines, const PlanArrangement& map,
                              const std::vector<bool>& solid, const std::vector<SeenWall>& seen,
                              const std::vector<bool>& inside, LobbyHoles holes) {
    LobbyFinder finder(plan, lines, map, solid, inside, holes);
    for (const SeenWall& wall : seen) finder.see(wall);
    return finder.find();
}

std::vector<std::string> nearlyLobbies(const PlanWalls& plan, const PlanLines& lines,
                                       const PlanArrangement& map, const std::vector<bool>& solid,
                                       const std::vector<SeenWall>& seen, const std::vector<bool>& inside,
                                       double leastArea) {
    std::map<std::set<std::string>, std::string> byWalls;
    for (const LobbyHoles holes : {LobbyHoles::outOfLine, LobbyHoles::beforeEnds}) {
        LobbyFinder finder(plan, lines, map, solid, inside, holes);
        for (const SeenWall& wall : seen) finder.see(wall);
        byWalls.merge(finder.nearly(leastArea));
    }
    std::vector<std::string> out;
    for (const auto& [walls, sentence] : byWalls) out.push_back(sentence);
    return out;
}

} // namespace heliodon::geometry
