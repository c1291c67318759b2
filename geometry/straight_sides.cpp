#include "geometry/straight_sides.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"
#include "geometry/used_stretches.h"

namespace heliodon::geometry {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSamePoint = 1e-6;                   // inches: what is nearer coincides but for rounding
constexpr double kSameLineOffset = 0.25 + 1e-6;       // inches: nearer pieces lie on one straight side
const double kSameLineSine = std::sin(4 * kPi / 180); // and do not turn by more than this
constexpr double kSameLineGap = 12;                   // inches along the side
constexpr double kAsLong = 1e-6;                      // inches: nothing but rounding parts lengths so near
constexpr double kAside = 1;                          // inches: how far a wall goes past what it parts
constexpr double kPilaster = 0.5;   // of a wall's length: a shorter piece within it that stands out
constexpr double kStandsOut = 0.18; // by so many inches on one side,
constexpr double kFlush = 0.05;     // and no more than so many on the other one, is no copy of it

// The ends of both as one wall, from the lower to the higher.
std::optional<std::pair<glm::dvec2, glm::dvec2>> asOne(const WallPiece& p, const WallPiece& q) {
    if (p.height != q.height || std::abs(p.thickness - q.thickness) > kSamePoint) return std::nullopt;
    for (const auto& [farP, nearP] : {std::pair(p.a, p.b), std::pair(p.b, p.a)})
        for (const auto& [nearQ, farQ] : {std::pair(q.a, q.b), std::pair(q.b, q.a)}) {
            if (glm::length(nearQ - nearP) > kSamePoint || glm::dot(farP - nearP, farQ - nearQ) >= 0)
                continue;
            const glm::dvec2 way = glm::normalize(farQ - farP);
            if (std::abs(cross(way, nearP - farP)) > kSamePoint) continue;
            const bool forward = std::pair(farP.x, farP.y) < std::pair(farQ.x, farQ.y);
            return forward ? std::pair(farP, farQ) : std::pair(farQ, farP);
        }
    return std::nullopt;
}

class LineFinder {
public:
    LineFinder(std::vector<WallPiece>& pieces, std::vector<WallLine>& lines)
        : pieces_(pieces), lines_(lines) {}

    // Longest first: a long wall knows its direction best.
    void find() {
        std::vector<size_t> byLength(pieces_.size());
        for (size_t i = 0; i < byLength.size(); ++i) byLength[i] = i;
        std::ranges::stable_sort(byLength, std::greater(), [&](size_t i) { return length(pieces_[i]); });
        for (auto first = byLength.begin(); first != byLength.end();) {
            if (pieces_[*first].line >= 0) {
                ++first;
                continue;
            }
            const std::vector<size_t> members = longestSide(std::span(first, byLength.end()));
            for (const size_t i : members) pieces_[i].line = static_cast<int>(lines_.size());
            lines_.push_back(fit(members));
            if (members.size() > 1)
                for (const size_t i : members) project(pieces_[i], lines_.back());
        }
    }

private:
    static double length(const WallPiece& p) { return glm::length(p.b - p.a); }

    struct Side {
        std::vector<size_t> members;
        double length = 0, aside = 0; // of all; how far they lie off the first one's line, times length
    };

    // From one of the longest pieces left. Which of several as long comes first rounding decides, as the
    // sketch lies on the table: it is the one that has most in line with it, and that best.
    std::vector<size_t> longestSide(std::span<const size_t> byLength) {
        const Side none;
        const Side* best = &none;
        for (const size_t seed : byLength) {
            if (pieces_[seed].line >= 0) continue;
            if (length(pieces_[seed]) < length(pieces_[byLength[0]]) - kAsLong) break;
            const Side& side = sideOf(seed, byLength);
            if (side.length > best->length + kAsLong ||
                (side.length > best->length - kAsLong && side.aside < best->aside - kAsLong))
                best = &side;
        }
        return best->members;
    }

    // As it was, where all that was found in line with the piece is still there.
    const Side& sideOf(size_t seed, std::span<const size_t> byLength) {
        Side& side = sides_[seed];
        const auto isTaken = [&](size_t i) { return pieces_[i].line >= 0; };
        if (!side.members.empty() && std::ranges::none_of(side.members, isTaken)) return side;
        side = {.members = inLine(seed, byLength)};
        const glm::dvec2 d = glm::normalize(pieces_[seed].b - pieces_[seed].a);
        for (const size_t i : side.members) {
            const WallPiece& p = pieces_[i];
            side.length += length(p);
            side.aside += length(p) * std::abs(cross(d, (p.a + p.b) / 2.0 - pieces_[seed].a));
        }
        return side;
    }

    std::vector<size_t> inLine(size_t seed, std::span<const size_t> byLength) const {
        std::vector<size_t> members{seed};
        for (bool grown = true; grown;) {
            grown = false;
            for (const size_t i : byLength) {
                if (pieces_[i].line >= 0 || std::ranges::count(members, i) ||
                    !fits(pieces_[seed], members, pieces_[i]))
                    continue;
                members.push_back(i);
                grown = true;
            }
        }
        return members;
    }

    bool fits(const WallPiece& seed, const std::vector<size_t>& members, const WallPiece& candidate) const {
        const glm::dvec2 d = glm::normalize(seed.b - seed.a);
        if (std::abs(cross(d, glm::normalize(candidate.b - candidate.a))) > kSameLineSine) return false;
        if (std::abs(cross(d, candidate.a - seed.a)) > kSameLineOffset ||
            std::abs(cross(d, candidate.b - seed.a)) > kSameLineOffset)
            return false;
        const auto along = [&](const WallPiece& p) {
            const auto [from, to] = std::minmax({glm::dot(p.a - seed.a, d), glm::dot(p.b - seed.a, d)});
            return Stretch{from, to};
        };
        const Stretch own = along(candidate);
        bool near = false;
        for (const size_t m : members) {
            const Stretch other = along(pieces_[m]);
            if (isPilaster(candidate, own, pieces_[m], other)) return false;
            const double from = std::min(own.to, other.to), to = std::max(own.from, other.from);
            near = near || (to < from + kSameLineGap && !isParted(seed.a + from * d, d, to - from));
        }
        return near;
    }

    // A gap from there, by a wall that runs on to both sides, a step from either end: what is beyond is
    // another building's.
    bool isParted(glm::dvec2 from, glm::dvec2 d, double gap) const {
        return gap > 2 * kAside && std::ranges::any_of(pieces_, [&](const WallPiece& wall) {
                   const double offA = cross(d, wall.a - from), offB = cross(d, wall.b - from);
                   const double at = glm::dot(glm::mix(wall.a, wall.b, offA / (offA - offB)) - from, d);
                   return offA * offB < 0 && std::min(std::abs(offA), std::abs(offB)) > kAside &&
                          at > kAside && at < gap - kAside;
               });
    }

    // Flat on the wall's face: within its length, much shorter, and standing out by more than a hand errs, on
    // one side alone. A thicker piece of the wall does on both.
    static bool isPilaster(const WallPiece& p, Stretch on, const WallPiece& wall, Stretch whole) {
        if (on.length() > kPilaster * whole.length() || on.from < whole.from || on.to > whole.to)
            return false;
        const glm::dvec2 d = glm::normalize(wall.b - wall.a);
        const double toA = cross(d, p.a - wall.a), toB = cross(d, p.b - wall.a),
                     off = toA * toB > 0 ? std::min(std::abs(toA), std::abs(toB)) : 0,
                     thicker = (p.thickness - wall.thickness) / 2;
        return thicker + off > kStandsOut && thicker - off < kFlush;
    }

    WallLine fit(const std::vector<size_t>& members) const {
        const WallPiece& seed = pieces_[members[0]];
        const glm::dvec2 d = seed.b - seed.a;
        if (members.size() == 1) return {seed.a, glm::normalize(d)};
        // Least squares through the pieces, weighted by length: direction from the second moments.
        glm::dvec2 middle{0};
        double total = 0;
        for (const size_t i : members) {
            middle += length(pieces_[i]) * (pieces_[i].a + pieces_[i].b) / 2.0;
            total += length(pieces_[i]);
        }
        middle /= total;
        double xx = 0, xy = 0, yy = 0;
        for (const size_t i : members)
            for (const glm::dvec2 end : {pieces_[i].a, pieces_[i].b}) {
                const glm::dvec2 r = end - middle;
                xx += length(pieces_[i]) * r.x * r.x;
                xy += length(pieces_[i]) * r.x * r.y;
                yy += length(pieces_[i]) * r.y * r.y;
            }
        const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
        glm::dvec2 direction(std::cos(angle), std::sin(angle));
        if (glm::dot(direction, d) < 0) direction = -direction;
        return {middle, direction};
    }

    static void project(WallPiece& piece, const WallLine& line) {
        auto [s0, s1] = std::minmax({line.along(piece.a), line.along(piece.b)});
        piece.a = line.origin + s0 * line.direction;
        piece.b = line.origin + s1 * line.direction;
    }

    std::vector<WallPiece>& pieces_;
    std::vector<WallLine>& lines_;
    std::map<size_t, Side> sides_; // by their first piece
};

} // namespace

void joinEndToEnd(std::vector<WallPiece>& pieces) {
    for (size_t i = 0; i < pieces.size(); ++i)
        for (size_t j = i + 1; j < pieces.size(); ++j)
            if (const auto ends = asOne(pieces[i], pieces[j])) {
                std::tie(pieces[i].a, pieces[i].b) = *ends;
                pieces[i].ids.insert(pieces[i].ids.end(), pieces[j].ids.begin(), pieces[j].ids.end());
                pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(j));
                j = i; // what goes on from the whole
            }
}

void findStraightSides(std::vector<WallPiece>& pieces, std::vector<WallLine>& lines) {
    LineFinder(pieces, lines).find();
}

} // namespace heliodon::geometry
