#include "geometry/wall_roles.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>

namespace heliodon::geometry {

namespace {

constexpr double kCopyOff = 0.2; // inches: how far a copy may reach beyond the wall that it repeats

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
        for (size_t i = 0; i < plan_.pieces.size(); ++i)
            for (const std::string& id : plan_.pieces[i].ids)
                out.push_back(reasoned(plan_.pieces[i], id, roleOf(i, id), "encloses nothing"));
        const char* outside = plan_.pieces.empty() ? "too low to enclose a room" : "stands in no room";
        for (size_t i = 0; i < plan_.partitions.size(); ++i) {
            const bool used = !partitionUsed.empty() && partitionUsed[i];
            for (const std::string& id : plan_.partitions[i].ids)
                out.push_back(
                    reasoned(plan_.partitions[i], id, used ? "partition" : "outside_extra", outside));
        }
    }

private:
    WallRole reasoned(const WallPiece& piece, const std::string& id, const std::string& role,
                      const char* outside) const {
        const std::string other = repeated(piece, id);
        return {id, role, !other.empty() ? "repeats " + other : role == "outside_extra" ? outside : ""};
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
            const bool within =
                cover.length() > round || (own.from > cover.from - kCopyOff && own.to < cover.to + kCopyOff);
            if (within && rank(other) < rank(id) && (best.empty() || rank(other) < rank(best))) best = other;
        }
        return best;
    }

    // By what the rooms see of this primitive's own part of the piece that it was merged into.
    const char* roleOf(size_t index, const std::string& id) const {
        if (spaces_.rooms.empty()) return "outside_extra";
        const WallPiece& piece = plan_.pieces[index];
        const Stretch own = piece.curved ? Stretch{0, 1e9} : stretchOf(piece, id);
        double sum = 0, both = 0;
        const auto& [right, left] = spaces_.seen[index];
        for (const auto& side : {right, left})
            for (const auto& [a, b] : side) sum += common({a, b}, own);
        for (const auto& [a, b] : right)
            for (const auto& [c, d] : left) both += common({std::max(a, c), std::min(b, d)}, own);
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
