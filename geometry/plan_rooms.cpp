// After the "enclosure" step of C. Cutler et al.'s virtual heliodon: an arrangement of the lines of all walls
// is divided into inside and outside, the best enclosed cells first, until every wall is used. Ours differs
// in two ways. The paper takes one cell after the other by the fraction of the view from its centroid that
// walls block, with all cells in the same combination of wall half-planes; we ask, for a rising price mu, for
// the set of cells with the least (length of open boundary) - mu (length of wall that it newly uses). That is
// a minimum cut (Boykov and Kolmogorov 2004), so it is the best of all sets, has no threshold to tune per
// room and does not depend on where centroids happen to lie. And it does not go on until all walls are used,
// which fails where a wall encloses nothing (a garden wall): a straight wall alone can never repay the
// boundary that using it would open, because mu stays below 1. Only for walls that are left over it rises
// further: of the spaces found then those are taken that a ring of walls surrounds.
#include "geometry/plan_rooms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include <glm/geometric.hpp>

#include "geometry/disjoint_sets.h"
#include "geometry/min_cut.h"
#include "geometry/perpendicular.h"
#include "geometry/plan_arrangement.h"
#include "geometry/plan_lines.h"
#include "geometry/plan_lobbies.h"
#include "geometry/plan_paths.h"
#include "geometry/plan_regions.h"
#include "geometry/plan_rings.h"
#include "geometry/plan_snapping.h"
#include "geometry/used_stretches.h"

namespace heliodon::geometry {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kThinCell = 0.06; // inches: cells thinner than this belong to a neighbour
constexpr double kThinRoom = 0.8;  // inches: twice the area over the perimeter; thinner spaces are cracks
constexpr double kLeastRoom = 2.3; // square inches: the inside of a ring 2 in across is that of a column
constexpr double kMostOpen = 0.4;  // of the perimeter; what is more open than this is not enclosed
// Logical walls; an arc counts as one for each quarter turn. An arc of 225 degrees has a mouth 1.3 times as
// wide as it is deep.
constexpr double kFewestWalls = 2.5;
constexpr double kTight = 0.1;  // of the perimeter: with less of it open, an arc and its chord will do
constexpr double kStub = 0.5;   // inches: what overshoots a corner by less is no wall of the space beyond
constexpr double kAhead = 1.2;  // of the price: what an inch of wall costs on which another one would end
constexpr double kBeside = 0.3; // the sine of the angle between walls that run beside one another
constexpr double kAside = 0.1;  // of a wall: how far what is before it may reach beyond its sides
constexpr std::array kPrices{0.02, 0.04, 0.07, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.75};
// Rings of walls of their own that leave more open: three gaps and more, none wider than the walls beside it.
constexpr std::array kRingPrices{1.0, 1.2, 1.4, 1.6};
constexpr double kMostOpenRing = 0.6;
constexpr double kTie = 1e-6;         // inches and prices: nearer ones are the same but for rounding
constexpr double kSamePoint = 1e-9;   // inches: what is nearer coincides but for rounding
constexpr double kCapacityUnit = 1e6; // of a length of 1 in: exact integer flow
constexpr int64_t kForever = int64_t{1} << 50;

// A half-edge along a wall, with air on its left.
struct WallFace {
    uint32_t half, group; // of cells
    int piece;
    Stretch stretch; // of the piece
    bool ahead;      // of a wall that ends before it
};

class RoomFinder {
public:
    explicit RoomFinder(const PlanWalls& plan) : plan_(plan), lines_(planLines(plan)) {
        map_ = arrange(snapped(lines_.segments, kSamePoint));
        measureCells();
        findSolids();
        tieThinCells();
        findFaces();
        graph_ = openEdges();
        used_.resize(plan.pieces.size());
    }

    PlanRooms find() {
        inside_.assign(map_.cellCount, false);
        forbidden_.assign(map_.cellCount, false);
        for (const double price : kPrices) {
            selectAll(price);
            if (unusedLength() < 1e-3) break;
        }
        ringsOnly_ = true;
        for (const double price : kRingPrices)
            if (unusedWalls() >= kFewestGaps) selectAll(price);
        ringsOnly_ = false;
        const std::vector<SeenWall> seen = seenWalls();
        dropPaths(plan_, lines_, map_, solid_, seen, inside_);
        accept(sealed());
        for (const LobbyHoles holes :
             {LobbyHoles::betweenPieces, LobbyHoles::outOfLine, LobbyHoles::beforeEnds})
            accept(withLobbies(plan_, lines_, map_, solid_, seen, inside_, holes));
        PlanRooms out = trace();
        out.outside = nearlyLobbies(plan_, lines_, map_, solid_, seen, inside_, kLeastRoom);
        return out;
    }

private:
    double edgeLength(uint32_t half) const {
        return glm::length(map_.points[map_.target[half]] - map_.points[map_.source(half)]);
    }

    void measureCells() {
        area_ = cellAreas(map_);
        perimeter_.assign(map_.cellCount, 0);
        for (uint32_t h = 0; h < map_.cell.size(); ++h)
            if (map_.cell[h] != map_.cell[h ^ 1u]) perimeter_[map_.cell[h]] += edgeLength(h);
    }

    void findSolids() {
        const std::vector<int> depth =
            coverage(map_, [&](int32_t tag) { return lines_.lines[static_cast<size_t>(tag)].solid >= 0; });
        solid_.resize(map_.cellCount);
        for (uint32_t c = 0; c < map_.cellCount; ++c) solid_[c] = depth[c] > 0;
    }

    uint32_t group(uint32_t cell) const {
        while (parent_[cell] != cell) cell = parent_[cell];
        return cell;
    }

    bool isThin(uint32_t cell) const { return 2 * area_[cell] <= kThinCell * perimeter_[cell]; }

    // An open edge of a cell and the cell beyond.
    struct Neighbour {
        double length = 0, weight = 0, area = 0;
        uint32_t cell = 0;
    };

    // Over the longest edge. Lines that coincide but for rounding have a cell between them with two longest
    // edges: there over the dearer one, so that a bridge there costs what the cheaper line does, however the
    // sketch lies on the table; at the same price to the larger cell.
    static uint32_t nearestOf(std::vector<Neighbour> neighbours) {
        for (const auto criterion : {&Neighbour::length, &Neighbour::weight, &Neighbour::area}) {
            const double best = std::ranges::max(neighbours, {}, criterion).*criterion;
            std::erase_if(neighbours, [&](const Neighbour& n) { return n.*criterion < best - kTie; });
        }
        return std::ranges::max(neighbours, {}, &Neighbour::cell).cell;
    }

    // A thin cell goes with one neighbour; without one it is solid.
    void tieThinCells() {
        parent_.resize(map_.cellCount);
        std::iota(parent_.begin(), parent_.end(), 0u);
        std::vector<std::vector<Neighbour>> neighbours(map_.cellCount);
        for (uint32_t h = 0; h < map_.cell.size(); ++h) {
            const uint32_t own = map_.cell[h], other = map_.cell[h ^ 1u];
            if (own != other && open(h) && isThin(own))
                neighbours[own].push_back({edgeLength(h), bridgeWeight(h), area_[other], other});
        }
        for (uint32_t c = 1; c < map_.cellCount; ++c) {
            if (solid_[c] || !isThin(c)) continue;
            if (neighbours[c].empty())
                solid_[c] = true;
            else if (const uint32_t nearest = nearestOf(neighbours[c]); group(nearest) != group(c))
                parent_[group(c)] = group(nearest);
        }
        if (group(0) != 0) { // the unbounded cell stays a root
            parent_[group(0)] = 0;
            parent_[0] = 0;
        }
    }

    bool open(uint32_t half) const { return !solid_[map_.cell[half]] && !solid_[map_.cell[half ^ 1u]]; }

    double bridgeWeight(uint32_t half) const {
        const glm::dvec2 middle = 0.5 * (map_.points[map_.source(half)] + map_.points[map_.target[half]]);
        double least = 3;
        for (const PlanArrangement::Tag& tag : map_.tags[half / 2]) {
            const PlanLine& line = lines_.lines[static_cast<size_t>(tag.tag)];
            if (line.solid < 0)
                least = std::min(least, line.weight + line.growth * glm::length(middle - line.start));
        }
        return least;
    }

    // The piece whose long face the half-edge is, with air on its left; -1 when there is none.
    int faceOf(uint32_t half) const { return wallOf(half, false); }

    int wallOf(uint32_t half, bool endsToo) const {
        for (const PlanArrangement::Tag& tag : map_.tags[half / 2]) {
            const PlanLine& line = lines_.lines[static_cast<size_t>(tag.tag)];
            if (line.solid < 0 || tag.forward == (half % 2 == 0)) continue;
            const PlanSolid& solid = plan_.solids[static_cast<size_t>(line.solid)];
            const bool isEnd = solid.sides[static_cast<size_t>(line.edge)] == SolidSide::end;
            if (solid.piece >= 0 && (endsToo || !isEnd)) return solid.piece;
        }
        return -1;
    }

    double along(const WallPiece& piece, glm::dvec2 p) const {
        if (!piece.curved) return glm::dot(p - piece.a, glm::normalize(piece.b - piece.a));
        const double middle = (piece.a0 + piece.a1) / 2;
        const double angle = std::atan2(p.y - piece.center.y, p.x - piece.center.x);
        return (std::remainder(angle - middle, 2 * kPi) + middle - piece.a0) * piece.radius;
    }

    Stretch stretch(uint32_t half, int piece) const {
        const WallPiece& wall = plan_.pieces[static_cast<size_t>(piece)];
        const double u = along(wall, map_.points[map_.source(half)]),
                     v = along(wall, map_.points[map_.target[half]]);
        return {std::min(u, v), std::max(u, v)};
    }

    double unused(size_t piece) const { return used_[piece].unused({0, lengthOf(plan_.pieces[piece])}); }

    double unusedLength() const {
        double sum = 0;
        for (size_t i = 0; i < used_.size(); ++i) sum += unused(i);
        return sum;
    }

    size_t unusedWalls() const {
        size_t count = 0;
        for (size_t i = 0; i < used_.size(); ++i) count += unused(i) > kStub;
        return count;
    }

    void selectAll(double price) {
        for (int attempt = 0; attempt < 8 && !select(price); ++attempt) {
        }
    }

    void findFaces() {
        for (uint32_t h = 0; h < map_.cell.size(); ++h) {
            if (solid_[map_.cell[h]] || !solid_[map_.cell[h ^ 1u]]) continue;
            if (const int piece = faceOf(h); piece >= 0)
                faces_.push_back({h, group(map_.cell[h]), piece, stretch(h, piece), isAhead(h)});
        }
    }

    std::vector<SeenWall> seenWalls() const {
        std::vector<SeenWall> out;
        for (const WallFace& face : faces_) out.push_back({face.half, face.piece});
        return out;
    }

    // Where a wall would stand if it were lengthened. A gap before that is filled in line with the side of
    // that wall that its room sees: what lies between its two sides belongs to no room. A face that goes on
    // beside it was not divided there: nothing has to be filled.
    bool isAhead(uint32_t face) const {
        const glm::dvec2 from = map_.points[map_.source(face)], to = map_.points[map_.target[face]];
        return std::ranges::any_of(lines_.ahead, [&](const WallAhead& wall) {
            if (std::abs(cross(to - from, wall.out)) < kBeside * edgeLength(face)) return false;
            const glm::dvec2 across = wall.left - wall.right;
            const auto aside = [&](glm::dvec2 p) {
                return glm::dot(p - wall.right, across) / glm::dot(across, across);
            };
            const double one = aside(from), other = aside(to);
            const double along = glm::dot(0.5 * (from + to) - wall.right, wall.out);
            return along > 0 && along < wall.reach && std::min(one, other) > -kAside &&
                   std::max(one, other) < 1 + kAside;
        });
    }

    // Between spaces, with what it costs to part them.
    MinCut openEdges() const {
        std::vector<MinCut::Link> links;
        for (uint32_t h = 0; h < map_.cell.size(); h += 2) {
            const uint32_t a = group(map_.cell[h]), b = group(map_.cell[h + 1]);
            if (open(h) && a != b)
                links.push_back({a, b, std::llround(edgeLength(h) * bridgeWeight(h) * kCapacityUnit)});
        }
        return {map_.cellCount, links};
    }

    // One cut at this price. False when a space turned out too thin to be a room and the cut is to be made
    // again.
    bool select(double price) {
        std::vector<int64_t> gain(map_.cellCount, 0), cost(map_.cellCount, 0);
        cost[group(0)] = kForever;
        for (uint32_t c = 0; c < map_.cellCount; ++c) {
            if (inside_[c])
                gain[group(c)] += kForever;
            else if (forbidden_[c])
                cost[group(c)] += kForever;
        }
        for (const WallFace& face : faces_) {
            if (face.ahead)
                cost[face.group] += std::llround(kAhead * price * edgeLength(face.half) * kCapacityUnit);
            else
                gain[face.group] += std::llround(
                    price * used_[static_cast<size_t>(face.piece)].unused(face.stretch) * kCapacityUnit);
        }
        const std::vector<bool> side = graph_.sourceSide(std::move(gain), std::move(cost));
        std::vector<bool> proposed(map_.cellCount);
        for (uint32_t c = 0; c < map_.cellCount; ++c) proposed[c] = !solid_[c] && side[group(c)];
        return accept(proposed);
    }

    // What is inside, and spaces without any opening of which nothing is, as most of their walls lie ahead of
    // others.
    std::vector<bool> sealed() const {
        std::vector<bool> air(map_.cellCount);
        for (uint32_t c = 0; c < map_.cellCount; ++c) air[c] = !solid_[c];
        const std::vector<uint32_t> root = components(air);
        std::set<uint32_t> known{root[0]};
        for (uint32_t c = 0; c < map_.cellCount; ++c)
            if (inside_[c]) known.insert(root[c]);
        for (uint32_t c = 0; c < map_.cellCount; ++c)
            air[c] = inside_[c] || (air[c] && !known.contains(root[c]));
        return air;
    }

    struct Space {
        double area = 0, perimeter = 0, gap = 0;
        std::map<int, double> walls;      // piece: length that the space sees of it
        bool grows = false, isNew = true; // some of its cells, all of them are new
    };

    std::vector<uint32_t> components(const std::vector<bool>& in) const {
        DisjointSets cells(map_.cellCount);
        for (uint32_t h = 0; h < map_.cell.size(); h += 2)
            if (in[map_.cell[h]] && in[map_.cell[h + 1]]) cells.join(map_.cell[h], map_.cell[h + 1]);
        std::vector<uint32_t> root(map_.cellCount);
        for (uint32_t c = 0; c < map_.cellCount; ++c) root[c] = cells.root(c);
        return root;
    }

    // Two straight walls enclose nothing, however near to one another they stand; an arc and its chord may.
    bool tooFewWalls(const Space& space) const {
        std::set<int> sides;
        double count = 0;
        bool curved = false;
        for (const auto& [i, length] : space.walls) {
            const WallPiece& p = plan_.pieces[static_cast<size_t>(i)];
            if (length < kStub) continue;
            curved = curved || p.curved;
            if (p.curved)
                count += std::max(1.0, (p.a1 - p.a0) / (kPi / 2));
            else if (sides.insert(p.line).second)
                ++count;
        }
        return count < kFewestWalls && !(curved && space.gap <= kTight * space.perimeter);
    }

    bool isEnclosed(const Space& space, const std::vector<uint32_t>& root, uint32_t id) const {
        if (!ringsOnly_) return space.gap <= kMostOpen * space.perimeter;
        const bool ownWalls = std::ranges::all_of(space.walls, [&](const auto& wall) {
            const auto piece = static_cast<size_t>(wall.first);
            return unused(piece) > 0.5 * lengthOf(plan_.pieces[piece]);
        });
        return space.isNew && ownWalls && space.gap <= kMostOpenRing * space.perimeter &&
               isRing(map_, solid_, traceRegions(map_, labelsOf(root, id)).front().loops.front());
    }

    std::vector<int> labelsOf(const std::vector<uint32_t>& root, uint32_t id) const {
        std::vector<int> labels(map_.cellCount);
        for (uint32_t c = 0; c < map_.cellCount; ++c) labels[c] = root[c] == id ? 0 : -1;
        return labels;
    }

    bool accept(const std::vector<bool>& proposed) {
        const std::vector<uint32_t> root = components(proposed);
        std::map<uint32_t, Space> spaces;
        for (uint32_t c = 0; c < map_.cellCount; ++c) {
            if (!proposed[c]) continue;
            spaces[root[c]].area += area_[c];
            spaces[root[c]].grows |= !inside_[c];
            spaces[root[c]].isNew &= !inside_[c];
        }
        for (uint32_t h = 0; h < map_.cell.size(); ++h) {
            const uint32_t own = map_.cell[h], other = map_.cell[h ^ 1u];
            if (!proposed[own] || proposed[other]) continue;
            Space& space = spaces[root[own]];
            space.perimeter += edgeLength(h);
            if (!solid_[other]) space.gap += edgeLength(h);
        }
        for (const WallFace& face : faces_)
            if (const uint32_t own = map_.cell[face.half]; proposed[own])
                spaces[root[own]].walls[face.piece] += edgeLength(face.half);
        bool allThick = true;
        for (const auto& [id, space] : spaces) {
            if (!space.grows) continue;
            const bool thin = 2 * space.area < kThinRoom * space.perimeter || space.area < kLeastRoom;
            allThick = allThick && !thin;
            const bool enclosed = thin || (!tooFewWalls(space) && isEnclosed(space, root, id));
            if ((thin || !enclosed) && space.area > nearestArea_ + kTie) {
                nearest_ = labelsOf(root, id);
                nearestArea_ = space.area;
                nearestIsNarrow_ = thin;
            }
            if (!enclosed) continue;
            for (uint32_t c = 0; c < map_.cellCount; ++c)
                if (proposed[c] && root[c] == id) (thin ? forbidden_ : inside_)[c] = !thin || !inside_[c];
        }
        for (const WallFace& face : faces_)
            if (inside_[map_.cell[face.half]]) used_[static_cast<size_t>(face.piece)].add(face.stretch);
        return allThick;
    }

    bool isBoundary(uint32_t half) const {
        return inside_[map_.cell[half]] && !inside_[map_.cell[half ^ 1u]];
    }

    PlanRooms trace() const {
        PlanRooms out;
        std::vector<int> labels(map_.cellCount);
        for (uint32_t c = 0; c < map_.cellCount; ++c) labels[c] = inside_[c] ? 0 : -1;
        for (const PlanRegion& region : traceRegions(map_, labels)) out.rooms.push_back(roomOf(region));
        out.nearestIsNarrow = nearestIsNarrow_;
        if (out.rooms.empty() && !nearest_.empty())
            out.nearest = roomOf(traceRegions(map_, nearest_).front());
        std::ranges::sort(out.rooms, {}, [](const RoomPlan& room) {
            std::pair lowest(room.loops[0].points[0].x, room.loops[0].points[0].y);
            for (const glm::dvec2 p : room.loops[0].points) lowest = std::min(lowest, std::pair(p.x, p.y));
            return lowest;
        });
        measureSides(out);
        return out;
    }

    RoomPlan roomOf(const PlanRegion& region) const {
        RoomPlan room;
        for (const auto& loop : region.loops) room.loops.push_back(traceLoop(loop, room));
        return room;
    }

    OutlineLoop traceLoop(const std::vector<uint32_t>& halves, RoomPlan& room) const {
        OutlineLoop loop;
        for (const uint32_t h : halves) {
            OutlineEdge edge;
            edge.gap = !solid_[map_.cell[h ^ 1u]];
            if (!edge.gap) edge.piece = faceOf(h) >= 0 ? faceOf(h) : wallOf(h, true);
            if (edge.piece >= 0) edge.height = plan_.pieces[static_cast<size_t>(edge.piece)].height;
            loop.points.push_back(map_.points[map_.source(h)]);
            loop.edges.push_back(edge);
        }
        // From where none lies over the loop's first corner.
        const auto wall = std::ranges::find(loop.edges, false, &OutlineEdge::gap);
        double gap = 0;
        for (size_t k = 0, n = halves.size(); k < n; ++k) {
            const size_t i = (static_cast<size_t>(wall - loop.edges.begin()) + k) % n;
            gap = loop.edges[i].gap ? gap + edgeLength(halves[i]) : 0;
            room.widestGap = std::max(room.widestGap, gap);
        }
        return loop;
    }

    void measureSides(PlanRooms& out) const {
        std::vector<std::array<Used, 2>> sides(plan_.pieces.size());
        for (uint32_t h = 0; h < map_.cell.size(); ++h) {
            if (!isBoundary(h)) continue;
            for (const PlanArrangement::Tag& tag : map_.tags[h / 2]) {
                const PlanLine& line = lines_.lines[static_cast<size_t>(tag.tag)];
                if (line.solid < 0 || tag.forward == (h % 2 == 0)) continue;
                const PlanSolid& solid = plan_.solids[static_cast<size_t>(line.solid)];
                const SolidSide side = solid.sides[static_cast<size_t>(line.edge)];
                if (solid.piece < 0 || side == SolidSide::end) continue;
                sides[static_cast<size_t>(solid.piece)][side == SolidSide::left].add(stretch(h, solid.piece));
            }
        }
        for (const auto& [right, left] : sides) out.seen.push_back({right.stretches(), left.stretches()});
    }

    const PlanWalls& plan_;
    PlanLines lines_;
    PlanArrangement map_;
    std::vector<double> area_, perimeter_;
    std::vector<bool> solid_, inside_, forbidden_;
    std::vector<int> nearest_; // labels of the cells of what comes nearest to a room, should there be none
    double nearestArea_ = 0;
    bool nearestIsNarrow_ = false;
    std::vector<WallFace> faces_;
    MinCut graph_;
    bool ringsOnly_ = false;
    std::vector<uint32_t> parent_;
    std::vector<Used> used_;
};

} // namespace

bool contains(const RoomPlan& room, glm::dvec2 p) {
    return std::ranges::count_if(room.loops, [&](const OutlineLoop& loop) {
               return contains(loop.points, p);
           }) == 1; // in its outline and in no island
}

PlanRooms findRooms(const PlanWalls& plan) {
    if (plan.pieces.empty()) return {};
    return RoomFinder(plan).find();
}

} // namespace heliodon::geometry
