#include "geometry/plan_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"

namespace heliodon::geometry {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLongestBridge = 18; // inches
constexpr double kCornerGap = 1;      // inches: less is a corner that was left open
constexpr double kWidestMouth = 8;    // inches: between a corner and the wall opposite
constexpr double kOverlap = 0.02;     // inches: a line runs into what it ends on, so that they cross
constexpr double kBesideLine = 1e-6;  // inches
constexpr double kBeforeEnd = 0.01;   // inches: a ray starts within its wall, to meet the end face
constexpr int kMostCrossed = 8;       // outlines on the way out of walls that meet in a corner
constexpr double kGrowth = 1.0 / 16;  // of a line's weight along it
constexpr double kShortCut = 1.05;   // of the price of the way over an open corner: what others cost at least
constexpr double kSharpCorner = 2.8; // the way over an open corner: of the distance of its ends,
constexpr double kLongCorner = 4;    // or inches
constexpr double kSlanted = 1;       // inches from one side of a wall to the other along one that it ends on
constexpr double kOffCircle = 0.5;   // inches, and
constexpr double kOffRadius = 0.15;  // of the radius: by which arcs of one circle may miss one another
constexpr double kWidestTurn = 0.75 * kPi; // between them
constexpr double kParallel = 0.1;          // the sine of the angle between walls that meet in no corner
constexpr double kFacing = 0.97;           // the cosine of 14 degrees, and
constexpr double kOffFacade = 0.75;        // inches: by which pieces of a facade may miss one another
constexpr double kDearest = 3;             // an inch of bridge

class LineBuilder {
public:
    explicit LineBuilder(const PlanWalls& plan) : plan_(plan) {}

    PlanLines build() {
        for (size_t s = 0; s < plan_.solids.size(); ++s) {
            const PlanSolid& solid = plan_.solids[s];
            for (size_t k = 0; k < solid.outline.size(); ++k) {
                PlanLine line;
                line.solid = static_cast<int>(s);
                line.edge = static_cast<int>(k);
                add(solid.outline[k], solid.outline[(k + 1) % solid.outline.size()], line);
            }
        }
        findFreeEnds();
        bridgeAlongSides();
        bridgeFacades();
        bridgeAlongCircles();
        for (const WallEnd& end : freeEnds_) extend(end);
        for (const auto* ends : {&freeEnds_, &joinedEnds_})
            for (const WallEnd& end : *ends)
                if (isCorner(end)) runOn(end);
        bridgeEnds();
        return std::move(out_);
    }

private:
    struct Ahead {
        double way = 0; // to the first solid
        int solid = -1;
    };

    void add(glm::dvec2 a, glm::dvec2 b, PlanLine line) {
        if (a == b) return;
        out_.segments.push_back({a, b, static_cast<int32_t>(out_.lines.size())});
        out_.lines.push_back(line);
    }

    const WallPiece& piece(const WallEnd& end) const { return plan_.pieces[static_cast<size_t>(end.piece)]; }

    const Ahead& ahead(const WallEnd& freeEnd) const { return ahead_.at({freeEnd.piece, freeEnd.atB}); }

    void findFreeEnds() {
        for (size_t i = 0; i < plan_.pieces.size(); ++i) {
            const WallPiece& p = plan_.pieces[i];
            if (p.curved && p.a1 - p.a0 >= 2 * kPi - 1e-9) continue;
            for (const bool atB : {false, true}) {
                const WallEnd end = wallEnd(p, static_cast<int>(i), atB);
                const bool joined = touches(plan_.solids, end);
                (joined ? joinedEnds_ : freeEnds_).push_back(end);
                if (joined) continue;
                Ahead& ahead = ahead_[{end.piece, atB}];
                ahead.way = firstHit(plan_.solids, end.middle, end.out, end.piece, &ahead.solid);
            }
        }
    }

    // From piece to piece of one straight side, face to face.
    void bridgeAlongSides() {
        for (const WallEnd& e : freeEnds_)
            for (const WallEnd& f : freeEnds_) {
                if (e.piece >= f.piece || piece(e).line < 0 || piece(e).line != piece(f).line) continue;
                const double apart = glm::dot(f.middle - e.middle, e.out);
                if (apart <= 0 || glm::dot(e.out, f.out) > 0 || apart > kLongestBridge) continue;
                const int hit = ahead(e).solid;
                if (hit < 0 || plan_.solids[static_cast<size_t>(hit)].piece != f.piece) continue;
                add(e.right, f.left, {.start = e.right, .alongSide = piece(e).line});
                add(e.left, f.right, {.start = e.left, .alongSide = piece(e).line});
                alongSide_.insert({e.piece, e.atB});
                alongSide_.insert({f.piece, f.atB});
            }
    }

    // From arc to arc of one circle, or round the rest of its own, face to face.
    void bridgeAlongCircles() {
        for (const WallEnd& e : freeEnds_) {
            const WallEnd* nearest = nullptr;
            double least = kWidestTurn;
            for (const WallEnd& f : freeEnds_)
                if (onOneCircle(e, f) && turnBetween(e, f) < least) {
                    nearest = &f;
                    least = turnBetween(e, f);
                }
            if (nearest) bridgeAlongCircle(e, *nearest, least);
        }
    }

    // Where both run counter-clockwise, e is the end of the first and f the start of the second.
    bool onOneCircle(const WallEnd& e, const WallEnd& f) const {
        const WallPiece &p = piece(e), &q = piece(f);
        return p.curved && q.curved && e.atB && !f.atB &&
               std::abs(p.radius - q.radius) < kOffRadius * p.radius &&
               std::abs(glm::length(f.middle - p.center) - p.radius) < kOffCircle &&
               std::abs(glm::length(e.middle - q.center) - q.radius) < kOffCircle;
    }

    double turnBetween(const WallEnd& e, const WallEnd& f) const {
        const glm::dvec2 center = 0.5 * (piece(e).center + piece(f).center), from = e.middle - center,
                         to = f.middle - center;
        const double turn = std::atan2(cross(from, to), glm::dot(from, to));
        return turn < 0 ? turn + 2 * kPi : turn;
    }

    // So many facets are about as wide as those of the arc, and 10 degrees at most.
    static double facetsOver(const WallPiece& arc, double turn) {
        return std::max(
            {1.0, std::round(turn * arc.facets / (arc.a1 - arc.a0)), std::ceil(turn / (kPi / 18))});
    }

    // The distance from the centre changes evenly.
    static std::vector<glm::dvec2> wayRound(glm::dvec2 center, glm::dvec2 from, glm::dvec2 to, double turn,
                                            double count) {
        const double first = glm::length(from - center), last = glm::length(to - center),
                     start = std::atan2(from.y - center.y, from.x - center.x);
        std::vector<glm::dvec2> points{from};
        for (double k = 1; k < count; ++k) {
            const double angle = start + turn * k / count, radius = glm::mix(first, last, k / count);
            points.push_back(center + radius * glm::dvec2(std::cos(angle), std::sin(angle)));
        }
        points.push_back(to);
        return points;
    }

    bool isFree(const std::vector<glm::dvec2>& way, int own) const {
        for (size_t k = 0; k + 1 < way.size(); ++k) {
            const double step = glm::length(way[k + 1] - way[k]);
            if (firstHit(plan_.solids, way[k], (way[k + 1] - way[k]) / step, own) < step - kOverlap)
                return false;
        }
        return true;
    }

    void bridgeAlongCircle(const WallEnd& e, const WallEnd& f, double turn) {
        const glm::dvec2 center = 0.5 * (piece(e).center + piece(f).center);
        const double count = std::max(facetsOver(piece(e), turn), facetsOver(piece(f), turn));
        const auto inner = wayRound(center, e.left, f.right, turn, count),
                   outer = wayRound(center, e.right, f.left, turn, count);
        if (!isFree(inner, e.piece)) return;
        for (const auto* way : {&inner, &outer})
            for (size_t k = 0; k + 1 < way->size(); ++k)
                add((*way)[k], (*way)[k + 1], {.start = way->front()});
        alongCircle_.insert({e.piece, e.atB});
        alongCircle_.insert({f.piece, f.atB});
    }

    // Of a line so long that starts at 1 an inch.
    static double price(double way) { return way * (1 + kGrowth * way / 2); }

    // Another piece of a facade begins ahead, though out of line.
    static bool faces(const WallEnd& end, const WallEnd& other) {
        const glm::dvec2 way = other.middle - end.middle;
        const double along = glm::dot(way, end.out);
        return along > 0 && along < kWidestMouth && std::abs(cross(end.out, way)) < kOffFacade &&
               glm::dot(other.out, end.out) < -kFacing;
    }

    bool facesEnd(const WallEnd& end) const {
        const auto isAhead = [&](const WallEnd& other) { return faces(end, other); };
        return std::ranges::any_of(freeEnds_, isAhead) || std::ranges::any_of(joinedEnds_, isAhead);
    }

    // From piece to piece of a facade out of line, face to face. These only say where the hole is: no bridge
    // is dearer.
    void bridgeFacades() {
        for (const WallEnd& e : freeEnds_)
            for (const WallEnd& f : freeEnds_) {
                if (e.piece >= f.piece || piece(e).line < 0 || piece(f).line < 0) continue;
                if (piece(e).line == piece(f).line || !faces(e, f) || !faces(f, e)) continue;
                const double apart = glm::length(f.middle - e.middle);
                if (firstHit(plan_.solids, e.middle, (f.middle - e.middle) / apart, e.piece) <
                    apart - kOverlap)
                    continue;
                const std::array sides{piece(e).line, piece(f).line};
                add(e.right, f.left, {.weight = kDearest, .start = e.right, .facade = sides});
                add(e.left, f.right, {.weight = kDearest, .start = e.left, .facade = sides});
            }
    }

    struct OpenCorner {
        double price = 0,
               sideways = 0; // of lengthening both walls, and what an inch square to them is to cost
    };

    // Two ends that point to a corner which was left open. No way past it is to be cheaper than that through
    // it. None where something stands before it, or where it is so sharp and far that a short side may be
    // missing.
    OpenCorner openCorner(const WallEnd& e, const WallEnd& f) const {
        const double turn = cross(e.out, f.out);
        if (std::abs(turn) < kParallel) return {};
        const glm::dvec2 d = f.middle - e.middle;
        const double alongE = cross(d, f.out) / turn, alongF = cross(d, e.out) / turn;
        const double most = std::max(kLongCorner, kSharpCorner * glm::length(d));
        if (alongE < 0 || alongF < 0 || alongE + alongF > most) return {};
        if (ahead(e).way < alongE || ahead(f).way < alongF) return {};
        const double both = price(alongE) + price(alongF);
        // Square to both walls from their ends one goes tan(angle / 2) times as far.
        const double halfTangent = std::abs(turn) / (1 + glm::dot(e.out, f.out));
        return {both, kShortCut * both / (halfTangent * (alongE + alongF))};
    }

    void ray(glm::dvec2 from, glm::dvec2 direction, int own, PlanLine line) {
        const double t = std::min(firstHit(plan_.solids, from, direction, own) + kOverlap, kLongestBridge);
        line.start = from;
        if (t > 0.025) add(from, from + t * direction, line);
    }

    void extend(const WallEnd& end) {
        const glm::dvec2 side = glm::normalize(end.left - end.right);
        if (!alongSide_.contains({end.piece, end.atB})) {
            const double right = firstHit(plan_.solids, end.right, end.out, end.piece),
                         left = firstHit(plan_.solids, end.left, end.out, end.piece);
            // Before a wall at a slant both sides cost the same: the shorter way is no reason to take one.
            const auto weight = [&](double way) {
                return std::abs(right - left) < kSlanted
                           ? price(std::max(right, left) + kOverlap) / price(way + kOverlap)
                           : 1;
            };
            const auto onwards = [&](double way) {
                return PlanLine{.weight = weight(way),
                                .growth = weight(way) * kGrowth,
                                .lengthens = facesEnd(end) ? piece(end).line : -1};
            };
            ray(end.right, end.out, end.piece, onwards(right));
            ray(end.left, end.out, end.piece, onwards(left));
            if (std::min(right, left) < kLongestBridge)
                out_.ahead.push_back({end.right, end.left, end.out, std::min(right, left) + kSlanted});
        }
        if (piece(end).curved && !alongCircle_.contains({end.piece, end.atB})) continueArc(end);
        double sideways = 1.5;
        for (const WallEnd& other : freeEnds_)
            if (other.piece != end.piece) sideways = std::max(sideways, openCorner(end, other).sideways);
        ray(end.right, -side, end.piece, {.weight = sideways, .growth = kGrowth});
        ray(end.left, side, end.piece, {.weight = sideways, .growth = kGrowth});
    }

    // Another wall ends there too, and turns off.
    bool isCorner(const WallEnd& end) const {
        const auto turnsOff = [&](const WallEnd& other) {
            return other.piece != end.piece && glm::length(other.middle - end.middle) < 1 &&
                   std::abs(glm::dot(other.out, end.out)) < 0.9;
        };
        return std::ranges::any_of(joinedEnds_, turnsOff) || std::ranges::any_of(freeEnds_, turnsOff);
    }

    // Past the corner in which the wall ends, to the wall opposite: where a passage begins behind a corner.
    void runOn(const WallEnd& end) {
        const glm::dvec2 side = glm::normalize(end.left - end.right);
        for (const glm::dvec2 corner : {end.right, end.left}) {
            const auto at = [&](double t) { return corner + t * end.out; };
            double from = -kBeforeEnd;
            for (int crossed = 0; crossed < kMostCrossed; ++crossed) {
                const double to = from + firstHit(plan_.solids, at(from), end.out, -2);
                const glm::dvec2 middle = at((from + std::min(to, from + kLongestBridge)) / 2);
                // On both sides: along the side of a solid rounding has it, which the line itself lies in.
                const bool air = std::ranges::none_of(plan_.solids, [&](const PlanSolid& solid) {
                    return contains(solid.outline, middle + kBesideLine * side) ||
                           contains(solid.outline, middle - kBesideLine * side);
                });
                if (air && to - from > kCornerGap) {
                    if (to - from < kWidestMouth)
                        add(at(from - kOverlap), at(to + kOverlap), {.growth = kGrowth, .start = at(from)});
                    break;
                }
                from = to;
            }
        }
    }

    // Round the rest of the circle until something solid is met. Both ends walk over the same points: a step
    // costs what it does from the nearer one.
    void continueArc(const WallEnd& end) {
        const WallPiece& p = piece(end);
        const double rest = 2 * kPi - (p.a1 - p.a0);
        const int count = std::max(2, static_cast<int>(facetsOver(p, rest)));
        for (const double radius : {p.radius - p.thickness / 2, p.radius + p.thickness / 2}) {
            const auto at = [&](int k) {
                const glm::dvec2 corner = wallEnd(p, 0, k == 0).right, other = wallEnd(p, 0, k == 0).left;
                if (k == 0) return radius > p.radius ? corner : other;
                if (k == count) return radius > p.radius ? other : corner;
                const double angle = p.a1 + rest * k / count;
                return p.center + radius * glm::dvec2(std::cos(angle), std::sin(angle));
            };
            double length = 0;
            for (int i = 0; i < count && length < kLongestBridge; ++i) {
                const int k = end.atB ? i : count - 1 - i;
                const glm::dvec2 a = at(end.atB ? k : k + 1), b = at(end.atB ? k + 1 : k);
                const double step = glm::length(b - a);
                const double hit = i + 1 < count ? firstHit(plan_.solids, a, (b - a) / step, -2) : step;
                length += step;
                const bool stops = hit < step && hit > 1e-6;
                add(a, stops ? a + (hit + kOverlap) / step * (b - a) : b,
                    {.weight = 1 + length / 16, .start = end.middle});
                if (stops) break;
            }
        }
    }

    // Straight from a free end to the two free ends nearest to it, where nothing stands between.
    void bridgeEnds() {
        std::set<std::pair<size_t, size_t>> done;
        for (size_t i = 0; i < freeEnds_.size(); ++i) {
            std::vector<std::pair<double, size_t>> others;
            for (size_t j = 0; j < freeEnds_.size(); ++j)
                if (freeEnds_[i].piece != freeEnds_[j].piece)
                    others.emplace_back(glm::length(freeEnds_[i].middle - freeEnds_[j].middle), j);
            std::ranges::sort(others);
            for (size_t k = 0; k < others.size() && k < 2; ++k)
                if (others[k].first < kLongestBridge && done.insert(std::minmax(i, others[k].second)).second)
                    bridge(freeEnds_[i], freeEnds_[others[k].second]);
        }
    }

    void bridge(const WallEnd& e, const WallEnd& f) {
        glm::dvec2 from{}, to{};
        double shortest = std::numeric_limits<double>::infinity();
        for (const glm::dvec2 a : {e.right, e.left})
            for (const glm::dvec2 b : {f.right, f.left})
                if (glm::length(b - a) < shortest) {
                    shortest = glm::length(b - a);
                    from = a;
                    to = b;
                }
        if (shortest < 1e-6) return;
        const glm::dvec2 direction = (to - from) / shortest;
        if (firstHit(plan_.solids, from + 1e-4 * direction, direction, -2) < shortest - 2e-4) return;
        add(from, to,
            {.weight = std::max(1.6, kShortCut * openCorner(e, f).price / shortest), .start = from});
    }

    const PlanWalls& plan_;
    PlanLines out_;
    std::vector<WallEnd> freeEnds_, joinedEnds_;
    std::map<std::pair<int, bool>, Ahead> ahead_; // of the middle of free ends
    std::set<std::pair<int, bool>> alongSide_, alongCircle_;
};

} // namespace

PlanLines planLines(const PlanWalls& plan) {
    return LineBuilder(plan).build();
}

} // namespace heliodon::geometry
