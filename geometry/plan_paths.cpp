#include "geometry/plan_paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <map>
#include <optional>
#include <set>

#include <glm/geometric.hpp>

#include "geometry/disjoint_sets.h"
#include "geometry/perpendicular.h"
#include "geometry/plan_fillings.h"

namespace heliodon::geometry {

namespace {

constexpr double kLeast = 0.5;      // inches: less of a wall, or of an opening, is none
constexpr double kDoor = 2;         // inches: as wide as doors are drawn
constexpr double kAcross = 0.5;     // the sine of the angle between walls and the way from one to the other
constexpr double kBent = 0.36;      // the sine of 21 degrees, by which pieces of one wall turn off its way
constexpr double kAtEnd = 1;        // inches: from the end of a wall
constexpr double kOffRow = 0.75;    // inches: by which pieces of one wall may miss one another
constexpr double kSamePoint = 1e-6; // inches: nearer points are one but for rounding

class PathFinder {
public:
    PathFinder(const PlanWalls& plan, const PlanLines& lines, const PlanArrangement& map,
               const std::vector<bool>& solid, const std::vector<SeenWall>& seen,
               const std::vector<bool>& inside)
        : plan_(plan), lines_(lines), map_(map), solid_(solid), inside_(inside), cells_(map.cellCount) {
        for (uint32_t h = 0; h < map.cell.size(); h += 2)
            if (inside[map.cell[h]] && inside[map.cell[h + 1]] && !isInSide(h))
                cells_.join(map.cell[h], map.cell[h + 1]);
        for (uint32_t h = 0; h < map.cell.size(); ++h) addOpening(h);
        for (const SeenWall& wall : seen)
            if (inside[map.cell[wall.half]])
                parts_[cells_.root(map.cell[wall.half])].walls[faceOf(wall)] +=
                    glm::length(point(map.target[wall.half]) - point(map.source(wall.half)));
    }

    void drop(std::vector<bool>& inside) {
        std::set<uint32_t> dropped;
        for (const auto& [id, part] : parts_)
            if (isPath(id, part)) dropped.insert(id);
        if (dropped.empty()) return;
        for (const auto& [id, part] : parts_) // and what lies between the two faces of the opening
            if (part.walls.empty() &&
                std::ranges::any_of(part.beyond, [&](uint32_t other) { return dropped.contains(other); }))
                dropped.insert(id);
        std::set<uint32_t> plazas; // between wings, with no wall of their own
        for (const auto& [id, part] : parts_)
            if (!dropped.contains(id) && isPlaza(id, part, dropped)) plazas.insert(id);
        dropped.merge(plazas);
        for (uint32_t c = 0; c < map_.cellCount; ++c)
            if (inside[c] && dropped.contains(cells_.root(c))) inside[c] = false;
    }

private:
    struct Face { // one of the two long ones of a wall
        int piece = 0;
        bool left = false; // as the wall runs from a to b
        auto operator<=>(const Face&) const = default;
    };

    struct Part {                     // of a room, up to the openings of straight sides
        std::map<Face, double> walls; // length that it sees of them
        std::vector<uint32_t> open;   // half-edges to the outside, but openings of straight sides
        std::vector<uint32_t> beyond; // parts
    };

    glm::dvec2 point(uint32_t i) const { return map_.points[i]; }

    const WallPiece& wallOf(Face face) const { return plan_.pieces[static_cast<size_t>(face.piece)]; }

    Face faceOf(const SeenWall& seen) const {
        const WallPiece& wall = plan_.pieces[static_cast<size_t>(seen.piece)];
        const glm::dvec2 from = point(map_.source(seen.half)), way = point(map_.target[seen.half]) - from;
        return {seen.piece, glm::dot(way, wayOf(wall, from)) > 0};
    }

    bool isInSide(uint32_t half) const {
        return std::ranges::any_of(map_.tags[half / 2], [&](const PlanArrangement::Tag& tag) {
            const PlanLine& line = lines_.lines[static_cast<size_t>(tag.tag)];
            return line.alongSide >= 0 || line.facade[0] >= 0;
        });
    }

    void addOpening(uint32_t half) {
        const uint32_t own = map_.cell[half], other = map_.cell[half ^ 1u];
        if (!inside_[own] || solid_[other]) return;
        if (isInSide(half)) besideHoles_.insert({map_.source(half), map_.target[half]});
        if (!inside_[other]) {
            if (!isInSide(half)) parts_[cells_.root(own)].open.push_back(half);
        } else if (cells_.root(own) != cells_.root(other))
            parts_[cells_.root(own)].beyond.push_back(cells_.root(other));
    }

    bool isPath(uint32_t id, const Part& part) const {
        return (!part.beyond.empty() && isBetweenTwo(part)) || isBeforeFreeWall(id, part);
    }

    // Pieces of one wall, also where a hand laid them so much out of line that they have sides of their own.
    static bool inOneRow(const WallPiece& p, const WallPiece& q) {
        const glm::dvec2 d = glm::normalize(p.b - p.a), e = glm::normalize(q.b - q.a),
                         between = 0.5 * (q.a + q.b - p.a - p.b);
        return p.line == q.line ||
               (std::abs(cross(d, e)) <= kParallelSine &&
                std::max(std::abs(cross(d, between)), std::abs(cross(e, between))) < kOffRow);
    }

    bool isBetweenTwo(const Part& part) const {
        std::vector<const WallPiece*> rows;
        glm::dvec2 along{0};
        for (const auto& [face, length] : part.walls) {
            const WallPiece& wall = wallOf(face);
            if (length < kLeast) continue;
            if (wall.curved) return false;
            const glm::dvec2 d = glm::normalize(wall.b - wall.a);
            if (rows.empty()) along = d;
            if (std::abs(cross(along, d)) > kParallelSine) return false;
            if (std::ranges::none_of(rows, [&](const WallPiece* row) { return inOneRow(*row, wall); }))
                rows.push_back(&wall);
        }
        return rows.size() == 2 && isOpenAtBothEnds(part, along, kLeast, true);
    }

    // Between one wall, straight or of pieces that turn a little, and walls of other rooms, however these are
    // bent, a door's width from them at both ends.
    bool isBeforeFreeWall(uint32_t id, const Part& part) const {
        std::vector<const WallPiece*> own;
        for (const auto& [face, length] : part.walls) {
            if (length < kLeast || isSeenFromBehind(id, face)) continue;
            if (wallOf(face).curved) return false;
            own.push_back(&wallOf(face));
        }
        const std::optional<glm::dvec2> along = wayOfOneWall(own);
        return along && isOpenAtBothEnds(part, *along, kDoor, !part.beyond.empty());
    }

    static bool goOn(const WallPiece& p, const WallPiece& q) {
        return std::min({glm::length(p.a - q.a), glm::length(p.a - q.b), glm::length(p.b - q.a),
                         glm::length(p.b - q.b)}) < kAtEnd;
    }

    static std::optional<glm::dvec2> wayOfOneWall(const std::vector<const WallPiece*>& pieces) {
        if (pieces.empty()) return std::nullopt;
        DisjointSets parts(pieces.size());
        glm::dvec2 along{0};
        for (uint32_t i = 0; i < pieces.size(); ++i) {
            const glm::dvec2 way = pieces[i]->b - pieces[i]->a;
            along += glm::dot(way, pieces[0]->b - pieces[0]->a) < 0 ? -way : way;
            for (uint32_t j = 0; j < i; ++j)
                if (inOneRow(*pieces[i], *pieces[j]) || goOn(*pieces[i], *pieces[j])) parts.join(i, j);
        }
        along = glm::normalize(along);
        for (uint32_t i = 0; i < pieces.size(); ++i)
            if (parts.root(i) != parts.root(0) ||
                std::abs(cross(along, glm::normalize(pieces[i]->b - pieces[i]->a))) > kBent)
                return std::nullopt;
        return along;
    }

    bool isPlaza(uint32_t id, const Part& part, const std::set<uint32_t>& dropped) const {
        return !part.beyond.empty() &&
               std::ranges::all_of(part.beyond, [&](uint32_t other) { return dropped.contains(other); }) &&
               std::ranges::all_of(part.walls, [&](const auto& wall) {
                   return wall.second < kLeast || isSeenFromBehind(id, wall.first, dropped);
               });
    }

    // By another part: the wall is one of that, however far it runs on as one of this.
    bool isSeenFromBehind(uint32_t id, Face face, const std::set<uint32_t>& but = {}) const {
        return std::ranges::any_of(parts_, [&](const auto& other) {
            const auto wall = other.second.walls.find({face.piece, !face.left});
            return other.first != id && !but.contains(other.first) && wall != other.second.walls.end() &&
                   wall->second >= kLeast;
        });
    }

    // Whether two stretches of its border lead from wall to wall; where it may be a porch not both from end
    // to end.
    bool isOpenAtBothEnds(const Part& part, glm::dvec2 along, double least, bool mayBePorch) const {
        DisjointSets points(map_.points.size());
        for (const uint32_t h : part.open) points.join(map_.source(h), map_.target[h]);
        std::map<uint32_t, std::map<uint32_t, int>> borders; // stretch: point: edges that come, less those
        for (const uint32_t h : part.open) {                 // that leave
            std::map<uint32_t, int>& border = borders[points.root(map_.source(h))];
            --border[map_.source(h)];
            ++border[map_.target[h]];
        }
        int across = 0;
        bool fromEnds = true;
        for (const auto& [id, border] : borders) {
            glm::dvec2 way{0};
            bool atEnds = true;
            for (const auto& [i, count] : border) {
                way += static_cast<double>(count) * point(i);
                atEnds = atEnds && (count == 0 || isAtEnd(part, point(i), along));
            }
            if (glm::length(way) < least || std::abs(cross(along, way)) < kAcross * glm::length(way))
                continue;
            ++across;
            fromEnds = fromEnds && atEnds;
        }
        return across > 1 && !(mayBePorch && fromEnds);
    }

    // Of a wall along the path that ends there, and is not only interrupted by a hole.
    bool isAtEnd(const Part& part, glm::dvec2 p, glm::dvec2 along) const {
        return std::ranges::any_of(part.walls, [&](const auto& seen) {
            return std::ranges::any_of(std::array{false, true}, [&](bool atB) {
                const WallEnd end = wallEnd(wallOf(seen.first), seen.first.piece, atB);
                return glm::length(end.middle - p) < kAtEnd &&
                       std::abs(cross(along, end.out)) <= kParallelSine && !isBesideHole(end);
            });
        });
    }

    bool isBesideHole(const WallEnd& end) const {
        return std::ranges::any_of(besideHoles_, [&](uint32_t i) {
            return std::min(glm::length(point(i) - end.right), glm::length(point(i) - end.left)) < kSamePoint;
        });
    }

    const PlanWalls& plan_;
    const PlanLines& lines_;
    const PlanArrangement& map_;
    const std::vector<bool>& solid_;
    const std::vector<bool>& inside_;
    DisjointSets cells_;
    std::map<uint32_t, Part> parts_;
    std::set<uint32_t> besideHoles_; // ends of openings of straight sides into rooms
};

} // namespace

void dropPaths(const PlanWalls& plan, const PlanLines& lines, const PlanArrangement& map,
               const std::vector<bool>& solid, const std::vector<SeenWall>& seen, std::vector<bool>& inside) {
    PathFinder(plan, lines, map, solid, seen, inside).drop(inside);
}

} // namespace heliodon::geometry
