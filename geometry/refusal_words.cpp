#include "geometry/refusal_words.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/geometric.hpp>

namespace heliodon::geometry {

namespace {

constexpr size_t kMostNames = 8;

// Those of which rooms see most come first, of equals by name.
std::vector<std::string> wallsOf(const PlanWalls& plan, const std::vector<RoomPlan>& rooms) {
    std::map<std::string, double> seen;
    for (const RoomPlan& room : rooms)
        for (const OutlineLoop& loop : room.loops)
            for (size_t i = 0, n = loop.edges.size(); i < n; ++i)
                if (const int piece = loop.edges[i].piece; piece >= 0)
                    seen[std::ranges::min(plan.pieces[static_cast<size_t>(piece)].ids)] +=
                        glm::length(loop.points[(i + 1) % n] - loop.points[i]);
    std::vector<std::string> ids;
    for (const auto& [id, length] : seen) ids.push_back(id);
    // Lengths that are one but for rounding are equal, however the sketch lies on the table.
    std::ranges::stable_sort(ids, {}, [&](const std::string& id) { return -std::round(seen[id] / 1e-3); });
    return ids;
}

std::vector<std::string> idsOf(const std::vector<WallPiece>& pieces) {
    std::vector<std::string> ids;
    for (const WallPiece& piece : pieces) ids.insert(ids.end(), piece.ids.begin(), piece.ids.end());
    std::ranges::sort(ids);
    return ids;
}

// "a, b, c", and how many more.
std::string firstOf(std::vector<std::string> ids) {
    const size_t others = ids.size() > kMostNames + 1 ? ids.size() - kMostNames : 0; // one is named, too
    ids.resize(ids.size() - others);
    std::ranges::sort(ids);
    return fmt::format("{}{}", fmt::join(ids, ", "), others > 0 ? fmt::format(" and {} others", others) : "");
}

bool standsIn(const WallPiece& piece, const std::vector<RoomPlan>& rooms) {
    return std::ranges::any_of(rooms, [&](const RoomPlan& room) {
        return contains(room, piece.a) || contains(room, piece.b) ||
               contains(room, 0.5 * (piece.a + piece.b));
    });
}

} // namespace

std::string someOf(std::vector<std::string> ids) {
    std::ranges::sort(ids);
    return firstOf(std::move(ids));
}

std::vector<std::string> wallsBeside(const PlanWalls& plan, const OutlineLoop& loop, size_t first,
                                     size_t end) {
    const size_t n = loop.edges.size();
    std::set<std::string> ids;
    const auto add = [&](size_t i, size_t step) {
        for (size_t k = 0; k < n; ++k, i += step)
            if (const int piece = loop.edges[i % n].piece; piece >= 0) {
                ids.insert(std::ranges::min(plan.pieces[static_cast<size_t>(piece)].ids));
                return;
            }
    };
    add(first + n - 1, n - 1);
    add(end, 1);
    return {ids.begin(), ids.end()};
}

std::string whyNotEnclosed(const PlanWalls& plan, const PlanRooms& found) {
    const std::string none = "the walls enclose no space: ";
    if (found.nearest.loops.empty()) return none + someOf(idsOf(plan.pieces));
    if (found.nearestIsNarrow)
        return none + fmt::format("what lies between {} is too narrow for a room",
                                  firstOf(wallsOf(plan, {found.nearest})));
    double widest = 0;
    std::vector<std::string> beside;
    const OutlineLoop& loop = found.nearest.loops.front();
    const size_t n = loop.edges.size();
    for (size_t first = 0; first < n; ++first) {
        if (!loop.edges[first].gap || loop.edges[(first + n - 1) % n].gap) continue;
        size_t end = first;
        while (loop.edges[end % n].gap) ++end;
        const double width = glm::length(loop.points[end % n] - loop.points[first]);
        if (width <= widest + 1e-6) continue;
        widest = width;
        beside = wallsBeside(plan, loop, first, end);
    }
    return none + fmt::format("{} leave an opening {:.1f} ft wide beside {}",
                              firstOf(wallsOf(plan, {found.nearest})), widest, fmt::join(beside, ", "));
}

std::string whyNotProven(const PlanWalls& plan, const std::vector<RoomPlan>& rooms) {
    std::vector<std::string> low;
    for (const WallPiece& piece : plan.partitions)
        if (standsIn(piece, rooms)) low.push_back(std::ranges::min(piece.ids));
    return "the walls leave no room that could be proven closed: " + firstOf(wallsOf(plan, rooms)) +
           (low.empty() ? "" : ", with the low walls " + someOf(low) + " in it");
}

} // namespace heliodon::geometry
