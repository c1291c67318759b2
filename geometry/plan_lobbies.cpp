#include "geometry/plan_lobbies.h"

#include <algorithm>
#include <map>
#include <set>

#include <glm/geometric.hpp>

#include "geometry/disjoint_sets.h"

namespace heliodon::geometry {

namespace {

constexpr double kBesideHole = 0.25; // of its width: how much wall a space sees beside a hole at least

struct Space {
    bool closed = true;                    // but for holes of straight sides
    std::map<std::set<int>, double> holes; // straight sides: length of what is open between their walls
    std::map<int, double> seen;            // straight side: length of its walls
};

} // namespace

std::vector<bool> withLobbies(const PlanWalls& plan, const PlanLines& lines, const PlanArrangement& map,
                              const std::vector<bool>& solid, const std::vector<SeenWall>& seen,
                              const std::vector<bool>& inside, LobbyHoles holes) {
    const auto length = [&](uint32_t half) {
        return glm::length(map.points[map.target[half]] - map.points[map.source(half)]);
    };
    const auto holeIn = [&](uint32_t half) {
        std::set<int> sides;
        for (const PlanArrangement::Tag& tag : map.tags[half / 2])
            if (const PlanLine& line = lines.lines[static_cast<size_t>(tag.tag)]; line.alongSide >= 0)
                sides.insert(line.alongSide);
            else if (holes == LobbyHoles::beforeEnds && line.lengthens >= 0)
                sides.insert(line.lengthens);
        return sides;
    };
    const auto isAir = [&](uint32_t cell) { return !solid[cell] && !inside[cell]; };

    DisjointSets cells(map.cellCount);
    for (uint32_t h = 0; h < map.cell.size(); h += 2)
        if (isAir(map.cell[h]) && isAir(map.cell[h + 1]) && holeIn(h).empty())
            cells.join(map.cell[h], map.cell[h + 1]);
    std::map<uint32_t, Space> spaces;
    spaces[cells.root(0)].closed = false;
    for (uint32_t h = 0; h < map.cell.size(); ++h) {
        const uint32_t own = map.cell[h], other = map.cell[h ^ 1u];
        if (!isAir(own) || solid[other] || cells.root(own) == cells.root(other)) continue;
        Space& space = spaces[cells.root(own)];
        if (inside[other])
            space.closed = false;
        else
            space.holes[holeIn(h)] += length(h);
    }
    std::set<std::set<int>> doors; // holes that rooms open to
    for (uint32_t h = 0; h < map.cell.size(); ++h)
        if (inside[map.cell[h]] && isAir(map.cell[h ^ 1u])) doors.insert(holeIn(h));
    std::map<int, double> ofAll; // straight side: length of its walls that some space outside rooms sees
    for (const SeenWall& wall : seen) {
        const uint32_t own = map.cell[wall.half];
        const int side = plan.pieces[static_cast<size_t>(wall.piece)].line;
        if (!isAir(own)) continue;
        spaces[cells.root(own)].seen[side] += length(wall.half);
        ofAll[side] += length(wall.half);
    }

    // Beside a door one sees wall; beside a hole in an outer wall, which that of a court at the end of a
    // passage is not, one does from both its sides.
    const auto isFilled = [&](Space& space, const std::set<int>& sides, double width) {
        double own = 0, all = 0;
        for (const int side : sides) {
            own += space.seen[side];
            all += ofAll[side];
        }
        return (doors.contains(sides) ? own : std::min(own, all - own)) >= kBesideHole * width;
    };
    std::vector<bool> out = inside;
    for (uint32_t c = 0; c < map.cellCount; ++c) {
        if (!isAir(c)) continue;
        Space& space = spaces[cells.root(c)];
        out[c] = space.closed && std::ranges::all_of(space.holes, [&](const auto& hole) {
                     return isFilled(space, hole.first, hole.second);
                 });
    }
    // A door between a lobby and a room, taken for a hole in the facade until now, is open.
    std::set<uint32_t> toRoom, toLobby;
    for (uint32_t h = 0; h < map.cell.size(); ++h) {
        const uint32_t own = map.cell[h], other = map.cell[h ^ 1u];
        if (!isAir(own) || out[own] || !spaces[cells.root(own)].seen.empty()) continue;
        if (out[other]) (inside[other] ? toRoom : toLobby).insert(cells.root(own));
    }
    for (uint32_t c = 0; c < map.cellCount; ++c)
        if (isAir(c) && toRoom.contains(cells.root(c)) && toLobby.contains(cells.root(c))) out[c] = true;
    return out;
}

} // namespace heliodon::geometry
