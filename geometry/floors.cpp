#include "geometry/floors.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <glm/geometric.hpp>

#include "geometry/air_over_patches.h"
#include "geometry/decks.h"

namespace heliodon::geometry {

namespace {

constexpr double kWalkable = 0.969; // of the normal's rise: ramps up to 14 degrees

// Metres of the building.
constexpr double kRise = 0.3, kGap = 0.3;           // from a tread of a stair to the next one
constexpr double kLastRise = 0.55;                  // to what it leads to, where the last tread is not drawn
constexpr double kSame = 0.01;                      // of heights
constexpr double kCupboard = 0.9;                   // no single row of cupboards is so wide
constexpr double kLowStage = 0.6, kHighStage = 1.2; // tables are higher; few stages are
constexpr double kOneWall = 0.1, kFewWalls = 0.2, kSomeWalls = 0.4, kManyWalls = 0.52; // see walls()
constexpr double kBedHeight = 0.7, kBedArea = 5.5;                                     // at most

// Of what is level, at least.
struct Size {
    double area, width;
};
constexpr Size kFloor{1.5, 0.6}, kMain{6, 0.9}, kStage{6, 1.8}, kSmallStage{4, 1.4}, kTerrace{4, 0.75};
constexpr Size kNoTable{6, 2.5}, kNoLongTable{12, 1.8}; // that stands free

class FloorFinder {
public:
    FloorFinder(const PatchMesh& mesh, double scale) : mesh_(mesh), scale_(scale), air_(mesh, scale) {}

    Floors find() {
        Shells shells(mesh_);
        std::map<uint32_t, std::vector<size_t>> rooms, furniture; // what stands free in them
        for (size_t i = 0; i < mesh_.patchCount(); ++i)
            if (patchNormal(mesh_, i).y > kWalkable)
                (shells.volume(i) > 0 ? rooms : furniture)[mesh_.room[i]].push_back(i);
        for (auto& [room, patches] : rooms) findIn(patches, furniture[room]);
        return std::move(out_);
    }

private:
    // Of one room.
    void findIn(const std::vector<size_t>& patches, const std::vector<size_t>& furniture) {
        decks_.emplace(mesh_, patches, scale_);
        known_.clear();
        std::vector<Deck>& decks = decks_->all();
        const auto first = firstFloor();
        area_ = 0, first_ = main_ = &*first;
        for (Deck& deck : std::ranges::subrange(decks.begin(), first))
            if (isFree(deck, kFloor)) take(deck);
        take(*first);
        const std::ranges::subrange above(first + 1, decks.end());
        if (!above.empty()) {
            for (Deck& deck : above)
                if (isStage(deck, true)) take(deck);
            std::vector<Level> treads = levelsOf(mesh_, furniture);
            climb(treads);
            for (Deck& deck : above)
                if (!deck.isFloor) judge(deck);
        }
        std::set<size_t> isElsewhere; // than among the lowest
        std::vector<const Level*> upper;
        for (const Deck& deck : decks)
            for (const Level& level : deck.levels) {
                if (!deck.isFloor) continue;
                const bool isNone = isShelf(deck, level);
                if (!isNone && !deck.isUpper && !isOverFloor(deck, level)) continue;
                if (!isNone) upper.push_back(&level);
                isElsewhere.insert(level.patches.begin(), level.patches.end());
            }
        for (size_t k = 0; k < decks_->patches().size(); ++k)
            if (const size_t i = decks_->patches()[k]; decks_->of(k).isFloor && !isElsewhere.contains(i))
                out_.lowest.push_back(i);
        std::ranges::stable_sort(upper, {}, [](const Level* level) { return level->low; });
        for (const Level* level : upper)
            out_.upper.insert(out_.upper.end(), level->patches.begin(), level->patches.end());
    }

    // The lowest of a bookcase, a step above the floor that goes on under it.
    bool isShelf(const Deck& deck, const Level& level) {
        const double square = scale_ * scale_;
        if (level.low <= deck.low() + kSame * scale_ || level.area >= kFloor.area * square) return false;
        const Air air = air_.of(level.patches, level.area);
        return 2 * air.over * square > level.area && 2 * air.free * square < level.area;
    }

    // Of a deck to parts of which stairs lead.
    bool isOverFloor(const Deck& deck, const Level& level) {
        return level.low >= deck.low() + kHeadroom * scale_ && level.area >= kFloor.area * scale_ * scale_ &&
               air_.of(level.patches, level.area).walkedUnderInRoom >= kFloor.area;
    }

    void take(Deck& deck) {
        deck.isFloor = true;
        for (Level& level : deck.levels) level.isReached = true;
        area_ += deck.area;
    }

    // The lowest that is large and has headroom; what is below it and as good as none does not count where
    // there is one that is like a room's main floor.
    std::vector<Deck>::iterator firstFloor() {
        std::vector<Deck>& decks = decks_->all();
        if (decks.size() == 1 || isFree(decks[0], kFloor)) return decks.begin();
        const auto first = std::ranges::find_if(
            decks, [&](const Deck& deck) { return isFree(deck, kStage) && walls(deck) >= kFewWalls; });
        return first == decks.end() ? decks.begin() : first;
    }

    // From floor beside it, or from the main floor's height where that is nearer.
    Decks::Rise riseOf(const Deck& deck, bool orTerraces) {
        Decks::Rise rise = decks_->riseOf(
            deck, [&](const Deck& from) { return from.isFloor || (orTerraces && from.mayBeTerrace); });
        if (deck.low() > main_->low()) rise.height = std::min(rise.height, deck.low() - main_->low());
        return rise;
    }

    // Whether one runs along the other, as rows of seats do.
    bool isAlong(const Bounds& a, const Bounds& b) const {
        const auto longest = [](const glm::dvec3& size) { return std::max(size.x, size.z); };
        const glm::dvec3 both = glm::min(a.high, b.high) - glm::max(a.low, b.low);
        return longest(both) >= 0.8 * std::max(longest(a.high - a.low), longest(b.high - b.low));
    }

    bool is(const Deck& deck, Size size) const {
        return deck.area >= size.area * scale_ * scale_ && deck.width >= size.width * scale_;
    }

    const Air& airOf(const Deck& deck) {
        const auto [air, isNew] = known_.try_emplace(&deck);
        if (isNew) air->second = air_.of(deck.patches(), deck.area);
        return air->second;
    }

    bool isFree(const Deck& deck, Size size) { return is(deck, size) && airOf(deck).free >= size.area; }

    // What lies at a height between walls, building metres, if it is larger than all floor so far; else 0.
    double mainArea(const Deck& deck) {
        double most = 0, area = 0; // the second with walls, which take longer to find
        const auto addTo = [&](double& sum, const auto& counts) {
            for (const Deck& other : decks_->all())
                if (std::abs(other.low() - deck.low()) <= kSame * scale_ && counts(other)) sum += other.area;
            return sum >= 1.25 * area_;
        };
        const auto hasWalls = [&](const Deck& other) { return walls(other) >= kManyWalls; };
        if (!addTo(most, [](const Deck&) { return true; }) || !hasWalls(deck) || !addTo(area, hasWalls))
            return 0;
        return area / (scale_ * scale_);
    }

    // Floor without stairs that lead there.
    bool isStage(Deck& deck, bool orTerraces) {
        const double metre = scale_, square = scale_ * scale_;
        const auto isAsHighAs = [&](const Deck& other) {
            return std::abs(deck.low() - other.low()) <= kFloorStep * metre;
        };
        if (isAsHighAs(*first_) || (isAsHighAs(*main_) && walls(deck) > 0)) return true;
        if (deck.area < kFloor.area * square) return false;
        const Air air = airOf(deck);
        if (air.free < kFloor.area || 2 * air.over * square > deck.area) return false;
        if (mainArea(deck) >= kMain.area ||
            (is(deck, kMain) && walls(deck) >= kSomeWalls &&
             (deck.area >= 1.01 * area_ || (air.walkedUnder < kFloor.area && isRoundAllBelow(deck))))) {
            main_ = &deck;
            return true;
        }
        if (air.free < kTerrace.area) return false;
        const Decks::Rise rise = riseOf(deck, orTerraces);
        if (rise.height >= kHeadroom * metre) return false;
        if (rise.height > kHighStage * metre && walls(deck) < kManyWalls) return false;
        if (is(deck, kStage) && air.free >= kStage.area &&
            (rise.height <= kLowStage * metre || walls(deck) >= kFewWalls))
            return true;
        if (!is(deck, kTerrace)) return false;
        deck.mayBeTerrace = true;
        if (!rise.from || !rise.from->mayBeTerrace || !isAlong(deck.largest().box, rise.from->largest().box))
            return false;
        if (!rise.from->isFloor) take(*rise.from);
        return true;
    }

    // Of what is no floor without stairs: floor where they lead, or undecided.
    void judge(Deck& deck) {
        const double metre = scale_;
        if (isStage(deck, false)) return take(deck);
        const bool isMain = deck.area >= kFloor.area * metre * metre && mainArea(deck) > 0;
        if (!is(deck, kFloor) && !isMain) return;
        const Air air = airOf(deck);
        if (air.free < kFloor.area) return;
        const Decks::Rise from = riseOf(deck, false);
        const double rise = from.height;
        const bool isHigh = rise >= kHeadroom * metre,
                   isStorey = isHigh || (air.walkedUnderInRoom >= kFloor.area && !standsOn(deck, from));
        const bool mayBeFloor =
            isStorey ? air.walkedUnder >= kFloor.area || (isHigh && deck.width >= kCupboard * metre)
                     : isMain || mayBeStage(deck, rise);
        if (!mayBeFloor) return;
        const bool isReached = std::ranges::any_of(deck.levels, &Level::isReached);
        if (!isReached || (!isStorey && rise <= kLastRise * metre))
            return out_.undecided.push_back(deck.largest().patches[0]);
        deck.isUpper = isStorey;
        take(deck);
    }

    // As a bed on an upper floor, that is walked under like this.
    bool standsOn(const Deck& deck, const Decks::Rise& rise) const {
        return rise.from && std::ranges::any_of(rise.from->levels, [&](const Level& level) {
                   return std::abs(deck.low() - rise.height - level.high) <= kSame * scale_ &&
                          level.area > deck.area;
               });
    }

    bool mayBeStage(const Deck& deck, double rise) {
        const double metre = scale_;
        if (deck.area < kBedArea * metre * metre && rise <= kBedHeight * metre) return false;
        if (!is(deck, kSmallStage) && !(is(deck, kTerrace) && rise <= kLastRise * metre)) return false;
        return walls(deck) >= kOneWall || is(deck, kNoTable) || is(deck, kNoLongTable);
    }

    using Border = std::pair<uint32_t, uint32_t>; // edge, the vertex that comes first first

    // Whether something goes up from it.
    bool hasWall(const Border& edge) {
        if (!risen_) risen_ = risenEdges();
        return risen_->contains(edge);
    }

    std::set<Border> risenEdges() const {
        std::set<Border> risen;
        for (size_t i = 0; i < mesh_.patchCount(); ++i) {
            if (patchNormal(mesh_, i).y > kWalkable) continue;
            const double middle = patchCentroid(mesh_, i).y;
            const auto corner = mesh_.patch(i);
            for (size_t c = 0; c < corner.size(); ++c) {
                const Border edge = std::minmax(corner[c], corner[(c + 1) % corner.size()]);
                if (middle > 0.5 * (mesh_.vertices[edge.first].y + mesh_.vertices[edge.second].y))
                    risen.insert(edge);
            }
        }
        return risen;
    }

    // Share of the border from which something goes up.
    double walls(const Deck& deck) {
        double up = 0, all = 0;
        for (const Level& level : deck.levels) {
            all += level.perimeter;
            for (const auto& edge : level.border)
                if (hasWall(edge))
                    up += glm::distance(mesh_.vertices[edge.first], mesh_.vertices[edge.second]);
        }
        return up / all;
    }

    // Whether what is floor below it lies in holes of it, as a pool, however large: nothing goes up from
    // these.
    bool isRoundAllBelow(const Deck& deck) {
        const Level& level = deck.largest();
        DisjointSets loops(mesh_.vertices.size());
        for (const auto& [a, b] : level.border) loops.join(a, b);
        std::set<uint32_t> outer; // loops with walls
        for (const auto& edge : level.border)
            if (hasWall(edge)) outer.insert(loops.root(edge.first));
        const auto isInHole = [&](const Deck& below) {
            const glm::dvec3 p = patchCentroid(mesh_, below.largest().patches[0]);
            std::map<uint32_t, bool> holds; // by how often a line from p crosses the loop
            for (const auto& [v, w] : level.border) {
                const glm::dvec3 a = mesh_.vertices[v], b = mesh_.vertices[w];
                if ((a.z > p.z) != (b.z > p.z) && p.x < a.x + (p.z - a.z) / (b.z - a.z) * (b.x - a.x))
                    holds[loops.root(v)] ^= true;
            }
            return std::ranges::any_of(
                holds, [&](const auto& loop) { return loop.second && !outer.contains(loop.first); });
        };
        return std::ranges::all_of(decks_->all(), [&](const Deck& below) {
            return !below.isFloor || below.low() >= deck.low() || isInHole(below);
        });
    }

    // By stairs, of whatever stands in the room.
    void climb(std::vector<Level>& treads) {
        std::vector<Level*> all, todo;
        for (Level& level : treads) all.push_back(&level);
        for (Deck& deck : decks_->all())
            for (Level& level : deck.levels) all.push_back(&level);
        std::ranges::sort(all, {}, [](const Level* l) { return l->low; });
        for (Level* level : all)
            if (level->isReached) todo.push_back(level);
        const double rise = kRise * scale_, last = kLastRise * scale_, gap = kGap * scale_,
                     large = kFloor.area * scale_ * scale_;
        while (!todo.empty()) {
            const Level& from = *todo.back();
            todo.pop_back();
            for (auto at = std::ranges::lower_bound(all, from.low, {}, [](const Level* l) { return l->low; });
                 at != all.end() && (*at)->low <= from.high + last; ++at) {
                const Bounds &a = from.box, &b = (*at)->box;
                if ((*at)->isReached || ((*at)->low > from.high + rise && (*at)->area < large) ||
                    a.low.x > b.high.x + gap || b.low.x > a.high.x + gap || a.low.z > b.high.z + gap ||
                    b.low.z > a.high.z + gap)
                    continue;
                (*at)->isReached = true;
                todo.push_back(*at);
            }
        }
    }

    const PatchMesh& mesh_;
    double scale_; // world metres a metre of building
    AirOverPatches air_;
    std::optional<std::set<Border>> risen_; // see hasWall()
    Floors out_;
    // Of one room:
    std::optional<Decks> decks_;
    std::map<const Deck*, Air> known_;        // airOf()
    Deck *first_ = nullptr, *main_ = nullptr; // the lowest floor, and that beside pits
    double area_ = 0;                         // of what is floor
};

} // namespace

Shells::Shells(const PatchMesh& mesh)
    : mesh_(mesh), shells_(mesh.vertices.size()), volume_(mesh.vertices.size(), 0) {
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        for (const uint32_t v : mesh.patch(i)) shells_.join(v, mesh.patch(i)[0]);
    for (size_t i = 0; i < mesh.patchCount(); ++i) // normals point into the air
        volume_[of(i)] -= glm::dot(patchAreaVector(mesh, i), patchCentroid(mesh, i)) / 6;
}

Floors findFloors(const PatchMesh& mesh, double worldPerBuilding) {
    return FloorFinder(mesh, worldPerBuilding).find();
}

} // namespace heliodon::geometry
