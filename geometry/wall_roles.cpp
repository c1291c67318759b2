#include "geometry/wall_roles.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>

namespace heliodon::geometry {

namespace {

constexpr double kCopyOff = 0.2; // inches: how far a copy may reach beyond the wall that it repeats,
constexpr double kAlike = 0.05;  // and how much thicker than that it may be

struct Stretch {
    double from = 0, to = 0; // inches along a piece, from its end a
    double length() const { return to - from; }
};

double common(const Stretch& a, const Stretch& b) {
    return std::max(0.0, std::min(a.to, b.to) - std::max(a.from, b.from));
}

class RoleFinder {
public:
    RoleFinder(const Sketch& sketch, const PlanWalls& plan, const PlanRooms& spaces)
        : sketch_(sketch), plan_(plan), spaces_(spaces) {}

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

    // Where the primitive lies along the piece that it was merged into.
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

    // By what the rooms see of this primitive's own part of the pieces that it was merged into.
    const char* roleOf(const std::vector<size_t>& pieces, const std::string& id) const {
        if (spaces_.rooms.empty()) return "outside_extra";
        double sum = 0, both = 0;
        for (const size_t index : pieces) {
            const WallPiece& piece = plan_.pieces[index];
            const Stretch own = piece.curved ? Stretch{0, 1e9} : stretchOf(piece, id);
            const auto& [right, left] = spaces_.seen[index];
            for (const auto& side : {right, left})
                for (const auto& [a, b] : side) sum += common({a, b}, own);
            for (const auto& [a, b] : right)
                for (const auto& [c, d] : left) both += common({std::max(a, c), std::min(b, d)}, own);
        }
        if (sum < 0.3) return "outside_extra";
        return both > sum - 2 * both ? "interior" : "exterior";
    }

    const Sketch& sketch_;
    const PlanWalls& plan_;
    const PlanRooms& spaces_;
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
