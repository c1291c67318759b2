#include "geometry/wall_roles.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "geometry/perpendicular.h"
#include "geometry/plan_fillings.h"
#include "geometry/used_stretches.h"

namespace heliodon::geometry {

namespace {

constexpr double kCopyOff = 0.2; // inches: how far a copy may reach beyond the wall that it repeats,
constexpr double kAlike = 0.05;  // and how much thicker than that it may be
// Inches: how far before a wall's face it is asked what is there, and again behind a filling, up to the
// width of the corners and cracks that are filled. No round numbers: on a face that lies just there the
// answer would hang on rounding.
constexpr double kBefore = 0.15013, kFilled = 1.5;
constexpr double kBesideMiddle = 1.3e-4; // inches: likewise, where it is asked what covers a wall's middle
constexpr double kLeast = 0.3;           // inches: less of a side is none
constexpr double kTie = 1e-6;            // inches: lengths that differ by less are equal but for rounding

struct Box {
    glm::dvec2 low{}, high{};
};

class RoleFinder {
public:
    RoleFinder(const Sketch& sketch, const PlanWalls& plan, const PlanRooms& spaces)
        : sketch_(sketch), plan_(plan), spaces_(spaces) {
        for (const PlanSolid& solid : plan.solids) {
            Box box{solid.outline[0], solid.outline[0]};
            for (const glm::dvec2 p : solid.outline) box = {glm::min(box.low, p), glm::max(box.high, p)};
            boxes_.push_back(box);
        }
    }

    void add(std::vector<WallRole>& out, const std::vector<bool>& partitionUsed) const {
        for (const auto& [key, pieces] : piecesById(plan_.pieces)) {
            const std::string& id = key.second;
            out.push_back(reasoned(plan_.pieces, pieces, id, roleOf(pieces, id), "encloses nothing"));
        }
        const char* outside = plan_.pieces.empty() ? "too low to enclose a room" : "stands in no room";
        for (const auto& [key, pieces] : piecesById(plan_.partitions)) {
            const bool used = !partitionUsed.empty() &&
                              std::ranges::any_of(pieces, [&](size_t i) { return partitionUsed[i]; });
            out.push_back(reasoned(plan_.partitions, pieces, key.second, used ? "partition" : "outside_extra",
                                   outside));
        }
    }

private:
    // A primitive lies in several pieces where another one on its line is higher or thicker.
    // Walls and arcs may have the same ids.
    static std::map<std::pair<bool, std::string>, std::vector<size_t>>
    piecesById(const std::vector<WallPiece>& pieces) {
        std::map<std::pair<bool, std::string>, std::vector<size_t>> out;
        for (size_t i = 0; i < pieces.size(); ++i)
            for (const std::string& id : pieces[i].ids) out[{pieces[i].curved, id}].push_back(i);
        return out;
    }

    WallRole reasoned(const std::vector<WallPiece>& all, const std::vector<size_t>& pieces,
                      const std::string& id, const std::string& role, const char* outside) const {
        for (const size_t i : pieces)
            if (const std::string other = repeated(all[i], id); !other.empty())
                return {id, role, "repeats " + other};
        return {id, role, role == "outside_extra" ? outside : ""};
    }

    // Where the primitive lies along the piece that it was merged into, inches from its end a.
    Stretch stretchOf(const WallPiece& piece, const std::string& id) const {
        if (piece.curved) {
            const Arc& arc = *std::ranges::find(sketch_.arcs, id, &Arc::id);
            const double toRadians = std::numbers::pi / 180, half = (arc.a1Deg - arc.a0Deg) / 2 * toRadians;
            const double middle = (piece.a0 + piece.a1) / 2;
            const double off =
                std::remainder((arc.a0Deg + arc.a1Deg) / 2 * toRadians - middle, 2 * std::numbers::pi);
            const double at = middle + off - piece.a0;
            return {piece.radius * (at - half), piece.radius * (at + half)};
        }
        const Wall& wall = *std::ranges::find(sketch_.walls, id, &Wall::id);
        const glm::dvec2 d = glm::normalize(piece.b - piece.a);
        const auto [from, to] = std::minmax({glm::dot(wall.a - piece.a, d), glm::dot(wall.b - piece.a, d)});
        return {from, to};
    }

    // Height and thickness.
    std::pair<double, double> sizeOf(const WallPiece& piece, const std::string& id) const {
        const auto size = [](const auto& item) {
            return std::pair(heightInches(item.heightClass), item.thickness);
        };
        return piece.curved ? size(*std::ranges::find(sketch_.arcs, id, &Arc::id))
                            : size(*std::ranges::find(sketch_.walls, id, &Wall::id));
    }

    bool standsOut(const WallPiece& piece, const std::string& id, const std::string& of) const {
        const auto [height, thickness] = sizeOf(piece, id);
        const auto [otherHeight, otherThickness] = sizeOf(piece, of);
        return height > otherHeight || thickness > otherThickness + kAlike;
    }

    // Another primitive of the piece within whose length this one lies; of two that repeat one another the
    // shorter one does, of equals the one named last.
    std::string repeated(const WallPiece& piece, const std::string& id) const {
        if (piece.ids.size() < 2) return {};
        const auto rank = [&](const std::string& of) {
            return std::tuple(-std::round(stretchOf(piece, of).length() / kCopyOff), of.size(), of);
        };
        const Stretch own = stretchOf(piece, id);
        const double round = piece.curved ? 2 * std::numbers::pi * piece.radius - kCopyOff : 1e9;
        std::string best;
        for (const std::string& other : piece.ids) {
            if (other == id) continue;
            const Stretch cover = stretchOf(piece, other);
            if (standsOut(piece, id, other)) continue;
            const bool within =
                cover.length() > round || (own.from > cover.from - kCopyOff && own.to < cover.to + kCopyOff);
            if (within && rank(other) < rank(id) && (best.empty() || rank(other) < rank(best))) best = other;
        }
        return best;
    }

    enum class Beyond : uint8_t { room, outside, wall, covered };
    struct Part {
        Stretch on;
        Beyond beyond;
    };

    bool meets(const PlanSolid& solid, glm::dvec2 p, glm::dvec2 out) const {
        const WallPiece& wall = plan_.pieces[static_cast<size_t>(solid.piece)];
        return std::abs(glm::dot(glm::normalize(wayOf(wall, p)), out)) > kParallelSine;
    }

    static glm::dvec2 leftAt(const WallPiece& piece, double at) {
        if (!piece.curved) return leftOf(glm::normalize(piece.b - piece.a));
        const double angle = piece.a0 + at / piece.radius;
        return -glm::dvec2(std::cos(angle), std::sin(angle));
    }

    static glm::dvec2 middleAt(const WallPiece& piece, double at) {
        return piece.curved ? piece.center - piece.radius * leftAt(piece, at)
                            : piece.a + at * glm::normalize(piece.b - piece.a);
    }

    // Where along a piece the line so far to the left of its middle crosses the polygon's edges.
    static void addCrossings(const WallPiece& piece, double toLeft, const std::vector<glm::dvec2>& polygon,
                             std::vector<double>& out) {
        for (size_t i = 0; i < polygon.size(); ++i) {
            const glm::dvec2 p = polygon[i], q = polygon[(i + 1) % polygon.size()], d = q - p;
            if (!piece.curved) {
                const glm::dvec2 along = glm::normalize(piece.b - piece.a);
                const double atP = cross(along, p - piece.a) - toLeft,
                             atQ = cross(along, q - piece.a) - toLeft;
                if ((atP < 0) != (atQ < 0))
                    out.push_back(glm::dot(p + atP / (atP - atQ) * d - piece.a, along));
                continue;
            }
            const glm::dvec2 from = p - piece.center;
            const double radius = piece.radius - toLeft, a = glm::dot(d, d), b = glm::dot(from, d),
                         square = b * b - a * (glm::dot(from, from) - radius * radius);
            if (a == 0 || square < 0) continue;
            for (const double root : {-std::sqrt(square), std::sqrt(square)}) {
                const double t = (root - b) / a;
                if (t < 0 || t > 1) continue;
                const glm::dvec2 at = from + t * d;
                const double middle = (piece.a0 + piece.a1) / 2;
                out.push_back((std::remainder(std::atan2(at.y, at.x) - middle, 2 * std::numbers::pi) +
                               middle - piece.a0) *
                              piece.radius);
            }
        }
    }

    // Calls use(part) for the parts into which the places divide the stretch.
    template<class Use> static void divide(Stretch on, std::vector<double> places, const Use& use) {
        std::ranges::sort(places);
        places.push_back(on.to);
        double from = on.from;
        for (const double place : places) {
            const double to = std::min(place, on.to);
            if (to - from <= kTie * kTie) continue;
            use(Stretch{from, to});
            from = to;
        }
    }

    // What is before a face of the piece, by exact parts of its length.
    std::vector<Part> sideOf(size_t index, Stretch own, bool onLeft,
                             const std::vector<const PlanSolid*>& near) const {
        const WallPiece& piece = plan_.pieces[index];
        const auto& seen = spaces_.seen[index][onLeft];
        std::vector<double> ends;
        for (const auto& [from, to] : seen) ends.insert(ends.end(), {from, to});
        std::vector<Part> out;
        std::vector<Stretch> open;
        divide(own, ends, [&](Stretch part) {
            const double at = (part.from + part.to) / 2;
            if (std::ranges::any_of(seen, [&](const auto& s) { return at > s.first && at < s.second; }))
                out.push_back({part, Beyond::room});
            else
                open.push_back(part);
        });
        if (open.empty()) return out;
        std::vector<double> overMiddle;
        const double way = onLeft ? 1 : -1;
        for (const PlanSolid* solid : near)
            addCrossings(piece, way * kBesideMiddle, solid->outline, overMiddle);
        for (double depth = kBefore; depth < kFilled && !open.empty(); depth += kBefore) {
            const double toLeft = way * (piece.thickness / 2 + depth);
            std::vector<double> places = overMiddle;
            for (const RoomPlan& room : spaces_.rooms)
                for (const OutlineLoop& loop : room.loops) addCrossings(piece, toLeft, loop.points, places);
            for (const PlanSolid* solid : near) addCrossings(piece, toLeft, solid->outline, places);
            std::vector<Stretch> behind;
            for (const Stretch& whole : open)
                divide(whole, places, [&](Stretch part) {
                    const double at = (part.from + part.to) / 2;
                    const glm::dvec2 left = way * leftAt(piece, at), middle = middleAt(piece, at);
                    const Beyond found = beyond(near, middle + kBesideMiddle * left,
                                                middle + (piece.thickness / 2 + depth) * left, left);
                    if (found == Beyond::covered)
                        behind.push_back(part);
                    else
                        out.push_back({part, found});
                });
            open = std::move(behind);
        }
        for (const Stretch& rest : open) out.push_back({rest, Beyond::outside});
        return out;
    }

    // What is at a point before a face that rooms do not see there. Fillings, and copies of the wall off its
    // line, may cover what is behind. Only walls that meet the face hide what it would look at; one that
    // stands beside it is outside.
    Beyond beyond(const std::vector<const PlanSolid*>& near, glm::dvec2 middle, glm::dvec2 p,
                  glm::dvec2 out) const {
        if (inRoom(p)) return Beyond::room;
        bool covered = false, beside = false;
        for (const PlanSolid* solid : near) {
            if (!contains(solid->outline, p)) continue;
            const bool filling = solid->piece < 0;
            if (!filling && meets(*solid, p, out)) return Beyond::wall;
            (filling || contains(solid->outline, middle) ? covered : beside) = true;
        }
        return beside || !covered ? Beyond::outside : Beyond::covered;
    }

    bool inRoom(glm::dvec2 p) const {
        return std::ranges::any_of(spaces_.rooms, [&](const RoomPlan& room) { return contains(room, p); });
    }

    // The parts of a stretch of the piece that are wall: where it runs on past another one by little it ends
    // there, and the rest is air of a room.
    std::vector<Stretch> standing(const WallPiece& piece, Stretch own) const {
        std::vector<double> places;
        for (const RoomPlan& room : spaces_.rooms)
            for (const OutlineLoop& loop : room.loops)
                for (const double toLeft : {-kBesideMiddle, kBesideMiddle})
                    addCrossings(piece, toLeft, loop.points, places);
        std::vector<Stretch> out;
        divide(own, places, [&](Stretch part) {
            const double at = (part.from + part.to) / 2;
            const glm::dvec2 middle = middleAt(piece, at), beside = kBesideMiddle * leftAt(piece, at);
            if (!inRoom(middle - beside) || !inRoom(middle + beside)) out.push_back(part);
        });
        return out;
    }

    std::vector<const PlanSolid*> solidsNear(size_t piece) const {
        const Box& own = boxes_[piece];
        std::vector<const PlanSolid*> out;
        for (size_t i = 0; i < boxes_.size(); ++i)
            if (i != piece && glm::all(glm::lessThan(boxes_[i].low, own.high + kFilled)) &&
                glm::all(glm::greaterThan(boxes_[i].high, own.low - kFilled)))
                out.push_back(&plan_.solids[i]);
        return out;
    }

    // By what is on both sides of this primitive's own part of the pieces that it was merged into.
    const char* roleOf(const std::vector<size_t>& pieces, const std::string& id) const {
        if (spaces_.rooms.empty()) return "outside_extra";
        double both = 0, one = 0, outside = 0;
        for (const size_t index : pieces) {
            const WallPiece& piece = plan_.pieces[index];
            const double length = lengthOf(piece);
            Stretch own = piece.curved ? Stretch{0, length} : stretchOf(piece, id);
            own = {std::max(own.from, 0.0), std::min(own.to, length)};
            if (own.length() <= 0) continue;
            const std::vector<const PlanSolid*> near = solidsNear(index);
            for (const Stretch& wall : standing(piece, own)) {
                const std::vector<Part> atLeft = sideOf(index, wall, true, near);
                for (const Part& right : sideOf(index, wall, false, near))
                    for (const Part& left : atLeft) {
                        const double common =
                            std::min(right.on.to, left.on.to) - std::max(right.on.from, left.on.from);
                        if (common <= 0 || (right.beyond != Beyond::room && left.beyond != Beyond::room))
                            continue;
                        (right.beyond == left.beyond ? both : one) += common;
                        if (right.beyond == Beyond::outside || left.beyond == Beyond::outside)
                            outside += common;
                    }
            }
        }
        if (2 * both + one < kLeast - kTie) return "outside_extra";
        return both > one + kTie || (both > kTie && outside < kLeast - kTie) ? "interior" : "exterior";
    }

    const Sketch& sketch_;
    const PlanWalls& plan_;
    const PlanRooms& spaces_;
    std::vector<Box> boxes_; // of the plan's solids
};

} // namespace

std::vector<WallRole> wallRoles(const Sketch& sketch, const PlanWalls& plan, const PlanRooms& spaces,
                                const std::vector<bool>& partitionUsed,
                                const std::vector<IgnoredWall>& ignored) {
    std::vector<WallRole> out;
    RoleFinder(sketch, plan, spaces).add(out, partitionUsed);
    for (const IgnoredWall& wall : ignored) out.push_back({wall.id, "ignored", wall.reason});
    std::ranges::sort(out, {}, [](const WallRole& w) { return std::pair(w.id.size(), w.id); });
    return out;
}

} // namespace heliodon::geometry
