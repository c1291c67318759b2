#include "geometry/board_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <glm/geometric.hpp>

namespace heliodon::geometry {

namespace {

constexpr double kMostRows = 6;
constexpr double kMostCells = 0.35, kMostWithRims = 0.5; // of the triangles asked for
constexpr double kLeastAspect = 4;
constexpr double kParallelogram = 0.01;       // of the depth: by how much its corners may miss one
constexpr double kDeepest = 4.5, kWidest = 2; // depth and gap, of the edge length: wider ones are told apart
constexpr double kFarthest =
    1.3; // times the depth: light between boards farther apart is within 1 % as it is
constexpr double kOpposed = -0.7, kParallel = 0.95; // cosines: of normals, of long sides
constexpr double kThin = 1.0 / 3;                   // of the depth
constexpr double kTouching = 1e-6;                  // of the depth: what a sheet's two sides may be apart
constexpr size_t kMostBoards = 1000;

struct Board {
    size_t domain;
    uint32_t room;
    glm::dvec3 middle, normal, along; // unit
    double length, depth;
};

std::optional<Board> parallelogram(const Building& building, const std::vector<MeshDomain>& domains,
                                   size_t d) {
    const MeshDomain& domain = domains[d];
    const Face& face = building.faces[domain.faces[0]];
    if (domain.frames.size() != 1 || domain.loops.size() != 1 || domain.loops[0].size() != 4 ||
        face.twin >= 0 || building.materials[face.material].isOpening())
        return std::nullopt;
    std::array<glm::dvec3, 4> p;
    for (size_t k = 0; k < 4; ++k) p[k] = building.vertices[domain.loops[0][k]];
    const glm::dvec3 first = p[1] - p[0], second = p[3] - p[0],
                     along = glm::length(first) > glm::length(second) ? first : second;
    const double length = glm::length(along), depth = domainArea(domain) / length;
    if (glm::length(p[0] - p[1] + p[2] - p[3]) > kParallelogram * depth) return std::nullopt;
    const MeshDomain::Frame& frame = domain.frames[0];
    return Board{
        d,      face.room, 0.25 * (p[0] + p[1] + p[2] + p[3]), glm::cross(frame.u, frame.v), along / length,
        length, depth};
}

// How far b stands before a, where they look at one another (or away from one another, where it is negative)
// and lie over one another by half or more.
std::optional<double> gapBetween(const Board& a, const Board& b) {
    if (a.room != b.room || glm::dot(a.normal, b.normal) > kOpposed ||
        std::abs(glm::dot(a.along, b.along)) < kParallel)
        return std::nullopt;
    const glm::dvec3 d = b.middle - a.middle;
    const double overA = glm::dot(d, a.normal), overB = -glm::dot(d, b.normal);
    if (std::abs(glm::dot(d, a.along)) > 0.5 * std::max(a.length, b.length) ||
        std::abs(glm::dot(d, glm::cross(a.normal, a.along))) > 0.5 * std::max(a.depth, b.depth))
        return std::nullopt;
    if (overA > 0 && overB > 0) return std::max(overA, overB);
    return overA <= 0 && overB <= 0 ? std::optional(std::min(overA, overB)) : std::nullopt;
}

// Those that face another one nearby, with the other sides of these.
std::vector<bool> areClose(const std::vector<Board>& boards, double edge) {
    struct Pair {
        size_t one, other;
        double gap;
    };
    std::vector<Pair> facing;
    std::vector<std::optional<size_t>> backs(boards.size()); // the other side of a thin solid
    for (size_t i = 0; i < boards.size(); ++i)
        for (size_t k = i + 1; k < boards.size(); ++k) {
            const auto gap = gapBetween(boards[i], boards[k]);
            if (!gap) continue;
            const double depth = std::min(boards[i].depth, boards[k].depth);
            if (*gap <= kTouching * depth && *gap >= -kThin * depth) backs[i] = k, backs[k] = i;
            if (*gap > 0) facing.push_back({i, k, *gap});
        }
    std::vector<bool> close(boards.size(), false);
    for (const auto& [i, k, gap] : facing) {
        const double depth = std::max(backs[i] ? boards[i].depth : 0, backs[k] ? boards[k].depth : 0);
        if (gap <= kTouching * depth || gap > std::min(kFarthest * depth, kWidest * edge)) continue;
        for (const size_t board : {i, k}) {
            close[board] = true;
            if (backs[board]) close[*backs[board]] = true;
        }
    }
    return close;
}

// What joins two boards, or two sides of one, across little of their depth.
struct Rim {
    size_t domain;
    bool lengthwise; // along the boards: as many cells as these have columns, else as they have rows
    double length;
};

std::vector<Rim> rimsOf(const Building& building, const std::vector<MeshDomain>& domains,
                        const std::vector<Board>& parallelograms, const std::vector<Board>& boards) {
    using Side = std::pair<uint32_t, uint32_t>;
    const auto sideOf = [&](size_t domain, size_t k) -> Side {
        const auto& loop = domains[domain].loops[0];
        return std::minmax(loop[k % 4], loop[(k + 1) % 4]);
    };
    const auto lengthOf = [&](Side side) {
        return glm::distance(building.vertices[side.first], building.vertices[side.second]);
    };
    std::map<Side, const Board*> sides;
    std::set<size_t> taken;
    for (const Board& board : boards) {
        taken.insert(board.domain);
        for (size_t k = 0; k < 4; ++k) sides[sideOf(board.domain, k)] = &board;
    }
    std::vector<Rim> rims;
    for (const Board& rim : parallelograms) {
        for (size_t k = 0; k < 2 && !taken.contains(rim.domain); ++k) {
            const Side side = sideOf(rim.domain, k);
            const auto one = sides.find(side), other = sides.find(sideOf(rim.domain, k + 2));
            if (one == sides.end() || other == sides.end()) continue;
            const double depth = std::min(one->second->depth, other->second->depth), length = lengthOf(side);
            if (lengthOf(sideOf(rim.domain, k + 1)) > kThin * depth) continue;
            rims.push_back({rim.domain, length > 0.5 * one->second->length, length});
            taken.insert(rim.domain);
        }
    }
    return rims;
}

} // namespace

std::vector<uint32_t> boardRows(const Building& building, const std::vector<MeshDomain>& domains, double edge,
                                double triangles) {
    std::vector<uint32_t> rows(domains.size(), 0);
    std::vector<Board> parallelograms, boards;
    for (size_t d = 0; d < domains.size(); ++d)
        if (const auto board = parallelogram(building, domains, d)) {
            parallelograms.push_back(*board);
            if (board->length >= kLeastAspect * board->depth && board->depth <= kDeepest * edge)
                boards.push_back(*board);
        }
    if (boards.size() > kMostBoards) return rows;
    const std::vector<bool> close = areClose(boards, edge);
    std::vector<Board> chosen;
    for (size_t i = 0; i < boards.size(); ++i)
        if (close[i]) chosen.push_back(boards[i]);
    if (chosen.empty()) return rows;
    const std::vector<Rim> rims = rimsOf(building, domains, parallelograms, chosen);
    const auto columns = [&](double length) { return std::max(1.0, length / (kBoardColumn * edge)); };
    double aRow = 0, rimsOfRow = 0, rimsAlong = 0; // cells
    for (const Board& board : chosen) aRow += columns(board.length);
    for (const Rim& rim : rims) {
        if (rim.lengthwise)
            rimsAlong += columns(rim.length);
        else
            ++rimsOfRow;
    }
    const double most = std::floor(std::min(kMostCells * triangles / aRow,
                                            (kMostWithRims * triangles - rimsAlong) / (aRow + rimsOfRow)));
    if (most < 2) return rows;
    for (const Board& board : chosen) rows[board.domain] = static_cast<uint32_t>(std::min(most, kMostRows));
    for (const Rim& rim : rims) rows[rim.domain] = 1;
    return rows;
}

} // namespace heliodon::geometry
