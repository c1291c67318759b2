// After iterated snap rounding (D. Halperin and E. Packer 2002), but without a grid: the corners of the
// outlines are where everything snaps to.
#include "geometry/plan_overlay.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <glm/geometric.hpp>

#include "geometry/plan_regions.h"

namespace heliodon::geometry {

namespace {

constexpr double kSnap = 0.005;       // inches
constexpr double kThinPiece = 0.02;   // inches: thinner slips of floor or ceiling go to their neighbour
constexpr double kTouchSquare = 0.05; // inches: half the side of a square over a point where things touch

// What runs from a to b, as the tags say.
void addSegments(const std::vector<PlanArrangement::Tag>& tags, glm::dvec2 a, glm::dvec2 b,
                 std::vector<PlanSegment>& out) {
    for (const PlanArrangement::Tag& tag : tags)
        out.push_back({tag.forward ? a : b, tag.forward ? b : a, tag.tag});
}

// One round of snapping: which point of the arrangement goes where.
class Snapper {
public:
    Snapper(const PlanArrangement& map, int32_t outlineTags,
            const std::set<std::pair<double, double>>& corners)
        : map_(map), outlineTags_(outlineTags), place_(map.points), kind_(map.points.size(), Kind::loose) {
        lines_.resize(map.points.size());
        for (uint32_t e = 0; e < map.edgeCount(); ++e)
            for (const PlanArrangement::Tag& tag : map.tags[e])
                for (const uint32_t v : {map.target[2 * e], map.target[2 * e + 1]})
                    if (tag.tag < outlineTags) {
                        kind_[v] = Kind::onOutline;
                        lines_[v].push_back(tag.tag);
                    }
        for (size_t v = 0; v < map.points.size(); ++v)
            if (corners.contains({map.points[v].x, map.points[v].y})) kind_[v] = Kind::corner;
        for (uint32_t e = 0; e < map.edgeCount(); ++e)
            if (onOutline(e)) outlineEdges_.push_back(e);
    }

    // False when nothing has to move.
    bool snap() {
        bool any = false;
        for (const Kind kind : {Kind::corner, Kind::onOutline, Kind::loose})
            for (uint32_t v = 0; v < place_.size(); ++v)
                if (kind_[v] == kind) any |= settle(v);
        for (uint32_t e = 0; e < map_.edgeCount(); ++e) any |= bend(e);
        return any;
    }

    std::vector<PlanSegment> segments() const {
        std::vector<PlanSegment> out;
        for (uint32_t e = 0; e < map_.edgeCount(); ++e)
            for (size_t k = 0; k + 1 < chains_[e].size(); ++k)
                addSegments(map_.tags[e], chains_[e][k], chains_[e][k + 1], out);
        return out;
    }

private:
    enum class Kind : uint8_t { corner, onOutline, loose };

    bool onOutline(uint32_t edge) const {
        return std::ranges::any_of(map_.tags[edge], [&](const auto& tag) { return tag.tag < outlineTags_; });
    }

    struct Settled {
        glm::dvec2 at;
        std::vector<int32_t> lines; // edges of outlines on which it lies
    };

    // Goes to the nearest of what is settled and close, of equals the first, else stays.
    bool settle(uint32_t v) {
        const glm::dvec2 p = map_.points[v];
        if (kind_[v] != Kind::corner) {
            std::pair nearest(kSnap, settled_.size());
            forSettled(p.x - kSnap, p.x + kSnap, [&](size_t i) {
                const double apart = glm::length(settled_[i].at - p);
                if (apart < kSnap && std::pair(apart, i) < nearest && mayGo(v, settled_[i]))
                    nearest = {apart, i};
            });
            if (nearest.second < settled_.size())
                place_[v] = settled_[nearest.second].at;
            else if (kind_[v] == Kind::loose)
                place_[v] = onNearEdge(p);
        }
        bool known = false;
        forSettled(place_[v].x, place_[v].x, [&](size_t i) { known |= settled_[i].at == place_[v]; });
        if (place_[v] == p || !known) {
            byX_.emplace(place_[v].x, settled_.size());
            settled_.push_back({place_[v], lines_[v]});
        }
        return place_[v] != p;
    }

    // Calls visit(index) for what is settled between these x, both included.
    template<class Visit> void forSettled(double low, double high, const Visit& visit) const {
        for (auto i = byX_.lower_bound(low); i != byX_.end() && i->first <= high; ++i) visit(i->second);
    }

    // Points on an outline only along it: the other side of a sharp corner may be near, too.
    bool mayGo(uint32_t v, const Settled& to) const {
        return kind_[v] == Kind::loose || std::ranges::find_first_of(lines_[v], to.lines) != lines_[v].end();
    }

    glm::dvec2 onNearEdge(glm::dvec2 p) const {
        double least = kSnap;
        glm::dvec2 best = p;
        for (const uint32_t e : outlineEdges_) {
            const glm::dvec2 a = map_.points[map_.source(2 * e)], d = map_.points[map_.target[2 * e]] - a;
            const double t = glm::dot(p - a, d) / glm::dot(d, d), apart = glm::length(p - a - t * d);
            if (!(t > 0 && t < 1 && apart < least)) continue; // edges may round to a point
            least = apart;
            best = a + t * d;
        }
        return best;
    }

    // Through the settled points that the edge passes closely by; an outline only through those on it. Of a
    // triangle with sides a little over kSnap only the longest passes by a corner: each of them would go over
    // to the two others, round after round.
    bool bend(uint32_t e) {
        const glm::dvec2 a = place_[map_.source(2 * e)], b = place_[map_.target[2 * e]];
        chains_.push_back({});
        if (a == b) return true;
        const double near = onOutline(e) ? kOn : kSnap;
        const double length = glm::length(b - a);
        const glm::dvec2 d = glm::normalize(b - a);
        std::vector<std::pair<double, size_t>> found;
        forSettled(std::min(a.x, b.x) - near, std::max(a.x, b.x) + near, [&](size_t i) {
            const glm::dvec2 p = settled_[i].at;
            if (p.y < std::min(a.y, b.y) - near || p.y > std::max(a.y, b.y) + near || p == a || p == b)
                return;
            const double t = glm::dot(p - a, d);
            const double longest = std::max(glm::length(p - a), glm::length(p - b));
            if (t > 0 && longest < length && glm::length(p - a - t * d) < near) found.emplace_back(t, i);
        });
        std::ranges::sort(found);
        chains_.back().push_back(a);
        for (const auto& [t, i] : found) // crossings may round to one point
            if (settled_[i].at != chains_.back().back()) chains_.back().push_back(settled_[i].at);
        chains_.back().push_back(b);
        return !found.empty();
    }

    static constexpr double kOn = 1e-9; // inches: rounding
    const PlanArrangement& map_;
    int32_t outlineTags_;
    std::vector<glm::dvec2> place_;
    std::vector<Kind> kind_;
    std::vector<Settled> settled_;
    std::multimap<double, size_t> byX_; // of them
    std::vector<uint32_t> outlineEdges_;
    std::vector<std::vector<int32_t>> lines_;     // per point: edges of outlines on which it lies
    std::vector<std::vector<glm::dvec2>> chains_; // per edge
};

class OverlayBuilder {
public:
    OverlayBuilder(const std::vector<RoomPlan>& rooms, const std::vector<std::vector<glm::dvec2>>& shapes,
                   Touching touching)
        : touching_(touching), roomCount_(rooms.size()), shapeCount_(shapes.size()) {
        for (size_t r = 0; r < rooms.size(); ++r)
            for (const OutlineLoop& loop : rooms[r].loops) {
                addLoop(loop.points, roomOfTag_, static_cast<int>(r));
                for (const glm::dvec2 p : loop.points) corners_.insert({p.x, p.y});
            }
        overlay_.outlineTags = static_cast<int32_t>(segments_.size());
        for (size_t s = 0; s < shapes.size(); ++s) {
            for (size_t k = 0; k < shapes[s].size(); ++k) overlay_.shapeEdge.emplace_back(s, k);
            addLoop(shapes[s], shapeOfTag_, static_cast<int>(s));
        }
    }

    PlanOverlay build() {
        constexpr int kMostRounds = 8;
        place(segments_);
        for (int round = 0; round < kMostRounds; ++round) {
            const size_t known = segments_.size();
            if (!coverTouches()) break;
            // The rest is settled already.
            std::vector<PlanSegment> segments(segments_.begin() + static_cast<std::ptrdiff_t>(known),
                                              segments_.end());
            const PlanArrangement& map = overlay_.map;
            for (uint32_t e = 0; e < map.edgeCount(); ++e)
                addSegments(map.tags[e], map.points[map.source(2 * e)], map.points[map.target[2 * e]],
                            segments);
            place(segments);
        }
        return std::move(overlay_);
    }

private:
    void addLoop(const std::vector<glm::dvec2>& loop, std::vector<int>& owner, int id) {
        for (size_t k = 0; k < loop.size(); ++k) {
            segments_.push_back(
                {loop[k], loop[(k + 1) % loop.size()], static_cast<int32_t>(segments_.size())});
            owner.push_back(id);
        }
    }

    void place(const std::vector<PlanSegment>& segments) {
        if (shapeCount_ == 0) return outlinesAlone();
        constexpr int kMostRounds = 6;
        overlay_.map = arrange(segments);
        for (int round = 0; round < kMostRounds; ++round) {
            Snapper snapper(overlay_.map, overlay_.outlineTags, corners_);
            if (!snapper.snap()) break;
            overlay_.map = arrange(snapper.segments());
        }
        overlay_.room = firstOver(roomOfTag_, 0);
        overlay_.shape = firstOver(shapeOfTag_, static_cast<size_t>(overlay_.outlineTags));
        const std::vector<int> square =
            firstOver(squareOfTag_, static_cast<size_t>(overlay_.outlineTags) + shapeOfTag_.size());
        overlay_.label.assign(overlay_.map.cellCount, -1);
        for (uint32_t c = 0; c < overlay_.map.cellCount; ++c)
            if (overlay_.room[c] >= 0) overlay_.label[c] = 2 * overlay_.room[c] + (overlay_.shape[c] >= 0);
        absorbThinCells(overlay_.map, overlay_.label, kThinPiece);
        for (uint32_t c = 0; c < overlay_.map.cellCount; ++c)
            if (overlay_.room[c] >= 0 && square[c] >= 0)
                overlay_.label[c] = 2 * overlay_.room[c] + (touching_ == Touching::joined);
    }

    // Outlines cross nothing: each room is a cell as it is, and what is no room another.
    void outlinesAlone() {
        PlanArrangement& map = overlay_.map;
        map.cellCount = static_cast<uint32_t>(roomCount_) + 1;
        overlay_.room.assign(map.cellCount, -1);
        overlay_.shape.assign(map.cellCount, -1);
        overlay_.label.assign(map.cellCount, -1);
        for (uint32_t c = 1; c < map.cellCount; ++c) {
            overlay_.room[c] = static_cast<int>(c - 1);
            overlay_.label[c] = 2 * overlay_.room[c];
        }
        for (uint32_t first = 0, past = 0; first < segments_.size(); first = past) {
            do map.points.push_back(segments_[past].a);
            while (segments_[past++].b != segments_[first].a);
            const uint32_t n = past - first;
            for (uint32_t k = 0; k < n; ++k) {
                const uint32_t after = first + (k + 1) % n, before = first + (k + n - 1) % n;
                map.target.insert(map.target.end(), {after, first + k});
                map.next.insert(map.next.end(), {2 * after, 2 * before + 1});
                map.cell.insert(map.cell.end(), {static_cast<uint32_t>(roomOfTag_[first + k]) + 1, 0u});
                map.tags.push_back({{static_cast<int32_t>(first + k), true}});
            }
        }
    }

    std::vector<int> firstOver(const std::vector<int>& owner, size_t firstTag) const {
        std::vector<int> found(overlay_.map.cellCount, -1);
        const auto depth = coverageOfEach(overlay_.map, [&](int32_t tag) {
            const size_t i = static_cast<size_t>(tag) - firstTag;
            return static_cast<size_t>(tag) >= firstTag && i < owner.size() ? owner[i] : -1;
        });
        for (uint32_t c = 0; c < overlay_.map.cellCount; ++c)
            if (const auto first = std::ranges::find_if(depth[c], [](const auto& d) { return d.second > 0; });
                first != depth[c].end())
                found[c] = first->first;
        return found;
    }

    // Squares over the points at which something of one label is in two places. True when there were any.
    bool coverTouches() {
        const PlanArrangement& map = overlay_.map;
        std::vector<bool> seen(map.cell.size());
        bool any = false;
        for (uint32_t start = 0; start < map.cell.size(); ++start) {
            if (seen[start]) continue;
            std::vector<int> round; // labels of the cells round the point that the half-edge leaves
            uint32_t h = start;
            do {
                seen[h] = true;
                if (round.empty() || round.back() != overlay_.label[map.cell[h]])
                    round.push_back(overlay_.label[map.cell[h]]);
                h = map.next[h ^ 1u];
            } while (h != start);
            if (round.size() > 1 && round.front() == round.back()) round.pop_back();
            std::ranges::sort(round);
            const bool pinched = std::ranges::adjacent_find(round) != round.end();
            const bool shaped = std::ranges::any_of(round, [](int label) { return label >= 0 && label % 2; });
            if (!pinched || !shaped) continue;
            const Square square = squareOver(map.points[map.source(start)]);
            if (square.walk > kMostWalk + 1) continue;
            const auto& [p, u, v, walk] = square;
            addLoop({p - u - v, p + u - v, p + u + v, p - u + v}, squareOfTag_,
                    static_cast<int>(squares_.size()));
            squares_.push_back(square);
            any = true;
        }
        return any;
    }

    Touching touching_;
    struct Square {
        glm::dvec2 middle, u, v; // half its sides
        int walk;                // how many before it, each at the side of the last
    };

    // A wedge of a few hundredths of a radian touches anew wherever a square cuts it: those that walk along
    // it become rectangles, each eight times as long as the last, until the wedge is wide enough to stay
    // open. Where the last crosses an outline beyond, one more square is laid.
    Square squareOver(glm::dvec2 p) const {
        Square square{p, {kTouchSquare, 0}, {0, kTouchSquare}, 0};
        for (const Square& other : squares_) {
            const glm::dvec2 off = p - other.middle;
            const auto reaches = [&](glm::dvec2 half) {
                const double size = glm::length(half);
                return std::abs(glm::dot(off, half)) < size * (size + kSnap);
            };
            if (!reaches(other.u) || !reaches(other.v) || other.walk < square.walk) continue;
            square.walk = other.walk + 1;
            if (square.walk <= kShortWalk || square.walk > kMostWalk || off == glm::dvec2(0)) continue;
            square.u = kTouchSquare * std::pow(8.0, square.walk - kShortWalk) * glm::normalize(off);
            square.v = kTouchSquare * glm::normalize(glm::dvec2(-off.y, off.x));
        }
        return square;
    }

    static constexpr int kShortWalk = 1, kMostWalk = 3;
    size_t roomCount_, shapeCount_;
    std::vector<Square> squares_;
    PlanOverlay overlay_;
    std::vector<PlanSegment> segments_;
    std::set<std::pair<double, double>> corners_; // of the outlines
    std::vector<int> roomOfTag_, shapeOfTag_, squareOfTag_;
};

} // namespace

PlanOverlay overlay(const std::vector<RoomPlan>& rooms, const std::vector<std::vector<glm::dvec2>>& shapes,
                    Touching touching) {
    return OverlayBuilder(rooms, shapes, touching).build();
}

} // namespace heliodon::geometry
