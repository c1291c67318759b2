// After L. Freitag and C. Ollivier-Gooch, "Tetrahedral mesh improvement using swapping and smoothing" (1997),
// in that many cheap smoothings are followed by few costly ones where angles are still small; theirs leaves
// the number of points as it is.
#include "geometry/angle_optimiser.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include <glm/geometric.hpp>

namespace heliodon::geometry {

namespace {

constexpr int kOptimisations = 8, kTrials = 6, kJointPasses = 3;
const double kGoodCosine = std::cos(39 * std::numbers::pi / 180);  // angles above 39 degrees are left alone
const double kBadCosine = std::cos(36.5 * std::numbers::pi / 180); // those below 36.5 are worth a point

// From border to border where those are near: no point has room there.
bool inStrip(const PlanarNet& net, uint32_t t, double edge) {
    constexpr double kStrip = 0.4; // of the edge length
    double longest = 0;
    for (size_t k = 0; k < 3; ++k) {
        if (!net.onBorder(net.corner[t][k])) return false;
        longest = std::max(
            longest, glm::length(net.points[net.corner[t][(k + 1) % 3]] - net.points[net.corner[t][k]]));
    }
    return net.twiceArea(t) < kStrip * edge * longest;
}

bool mendable(const PlanarNet& net, uint32_t t, double edge) {
    return net.worstCosine(t) >= kBadCosine && !inStrip(net, t, edge) && !net.atSharpCorner(t);
}

size_t mostTries(const PlanarNet& net) {
    constexpr size_t kFewTries = 5, kTrianglesATry = 20;
    return kFewTries + net.corner.size() / kTrianglesATry;
}

class Optimiser {
public:
    Optimiser(PlanarNet& net, double edge) : net_(net), edge_(edge) {}

    size_t optimise(size_t mostAdded) {
        movePoints(net_, kOptimisations);
        return mendTriangles(mostAdded);
    }

private:
    // The triangles round a point, by their sides opposite to it.
    struct Side {
        glm::dvec2 from, run;
        double square; // of its length
        bool sharp;    // the triangle is at a sharp corner
    };

    // Only those of triangles with small angles, and again only where something near has moved.
    static void movePoints(PlanarNet& net, int passes) {
        std::vector<bool> stirred(net.points.size(), true);
        std::vector<Side> round;
        for (int pass = 0; pass < passes; ++pass) {
            std::vector<uint32_t> asked;
            std::vector<bool> known(net.points.size());
            for (uint32_t t = 0; t < net.corner.size(); ++t) {
                if (net.worstCosine(t) < kGoodCosine) continue;
                for (const uint32_t v : net.corner[t])
                    if (net.inner(v) && stirred[v] && !known[v]) {
                        known[v] = true;
                        asked.push_back(v);
                    }
            }
            if (asked.empty()) return;
            const Stars stars(net);
            stirred.assign(net.points.size(), false);
            bool moved = false;
            for (const uint32_t v : asked) {
                if (!move(net, v, stars, round)) continue;
                moved = true;
                for (uint32_t i = stars.first[v]; i < stars.first[v + 1]; ++i)
                    for (const uint32_t w : net.corner[stars.triangles[i]]) stirred[w] = true;
            }
            if (!moved) return;
            net.flipAll();
        }
    }

    // Each triangle that is still bad, with its surroundings alone: points move together or one is added in
    // or beside it.
    size_t mendTriangles(size_t mostAdded) {
        // Where many are bad the parts are small beside the edges: points would only crowd them, and those
        // there are have no room to make.
        const size_t most = mostTries(net_);
        size_t mendables = 0, tries = 0, added = 0;
        for (uint32_t t = 0; t < net_.corner.size(); ++t) mendables += mendable(net_, t, edge_);
        const bool crowded = mendables > most;
        std::optional<Stars> stars;
        for (uint32_t t = 0; t < net_.corner.size() && tries < most; ++t) {
            if (crowded && added == mostAdded) break; // nothing is left to try
            if (!mendable(net_, t, edge_)) continue;
            ++tries;
            if (!stars) stars.emplace(net_);
            const NetPart part(net_, *stars, t, kRings);
            const Badness before = badness(part.net);
            double least = before.sum - kWorthMoving;
            std::optional<NetPart> best;
            const auto consider = [&](NetPart&& tried, double worth) {
                if (!crowded) movePointsTogether(tried.net);
                const Badness bad = badness(tried.net);
                if (bad.sum >= least - worth || bad.worst > before.worst || bad.worstOpen > before.worstOpen)
                    return false;
                least = bad.sum;
                best.emplace(std::move(tried));
                return true;
            };
            if (!crowded) consider(NetPart(part), 0);
            if (added < mostAdded && least > kGoodEnough) {
                NetPart more = part;
                const auto [target, p] = placeFor(more.net, 0);
                more.net.insert(target, p);
                movePoints(more.net, kTrials);
                added += consider(std::move(more), kWorthAPoint);
            }
            if (!best) continue;
            best->putBack(net_);
            stars.reset();
        }
        return added;
    }

    // The middle of the triangle's longest side that is not on the boundary.
    static std::pair<uint32_t, glm::dvec2> placeFor(const PlanarNet& net, uint32_t t) {
        const auto& c = net.corner[t];
        double longest = 0;
        glm::dvec2 place = (net.points[c[0]] + net.points[c[1]] + net.points[c[2]]) / 3.0;
        const glm::dvec2 middle = place;
        for (size_t k = 0; k < 3; ++k) {
            const glm::dvec2 a = net.points[c[(k + 1) % 3]], b = net.points[c[(k + 2) % 3]];
            if (net.fixed[t][k] || glm::length(b - a) <= longest) continue;
            longest = glm::length(b - a);
            place = 0.5 * (a + b) + 0.02 * (middle - 0.5 * (a + b)); // inside the triangle
        }
        return {t, place};
    }

    // Of an angle below the good one, in terms of a cosine; to a power, so that the worst count most.
    static double shortfall(double cosine) {
        const double off = std::max(0.0, cosine - kGoodCosine);
        return off * off * off * off;
    }

    struct Badness {
        double sum = 0;                  // of shortfalls in the open, that is not in strips
        double worst = 0, worstOpen = 0; // the largest cosine; in the open
    };

    // But for triangles at sharp corners, which cannot be good.
    Badness badness(const PlanarNet& net) const {
        Badness bad;
        for (uint32_t t = 0; t < net.corner.size(); ++t) {
            const double cosine = net.worstCosine(t);
            if (cosine <= kGoodCosine || net.atSharpCorner(t)) continue;
            bad.worst = std::max(bad.worst, cosine);
            if (inStrip(net, t, edge_)) continue;
            bad.sum += shortfall(cosine);
            bad.worstOpen = std::max(bad.worstOpen, cosine);
        }
        bad.sum = std::sqrt(std::sqrt(bad.sum));
        return bad;
    }

    struct Angle {
        double square, squares; // of its cosine, as a fraction
        bool turned;            // over
    };

    // The smallest one of the triangle from p to a side. Twice the area over the dot product of the sides at
    // a corner is the tangent of the angle there: the largest dot product belongs to the smallest angle.
    static Angle smallestAngle(const Side& side, glm::dvec2 p) {
        const glm::dvec2 u = p - side.from;
        const double along = glm::dot(side.run, u), twice = cross(side.run, u);
        const double most = std::max(std::max(along, side.square - along), glm::dot(u, u) - along);
        return {most * most, most * most + twice * twice, twice <= 0};
    }

    // Squared cosine of the smallest angle round p; 1 when it is `limit` or more. `strictest`: the side that
    // said so last, which most places tried fail at, too.
    static double worst(const std::vector<Side>& round, glm::dvec2 p, double limit, size_t& strictest) {
        double up = 0, down = 1; // as a fraction
        const auto passes = [&](const Side& side) {
            const auto [square, squares, turned] = smallestAngle(side, p);
            if (turned || square >= limit * squares) return false;
            if (square * down > up * squares) {
                up = square;
                down = squares;
            }
            return true;
        };
        if (!passes(round[strictest])) return 1;
        for (size_t i = 0; i < round.size(); ++i)
            if (i != strictest && !passes(round[i])) {
                strictest = i;
                return 1;
            }
        return up / down;
    }

    // Of the triangles round v; returns the square of the distance to the nearest corner.
    static double findSides(const PlanarNet& net, uint32_t v, const Stars& stars, std::vector<Side>& round) {
        round.clear();
        double nearest = 1e300;
        const glm::dvec2 start = net.points[v];
        for (uint32_t i = stars.first[v]; i < stars.first[v + 1]; ++i) {
            const auto& c = net.corner[stars.triangles[i]];
            const size_t k = c[0] == v ? 0 : c[1] == v ? 1 : 2;
            const glm::dvec2 a = net.points[c[(k + 1) % 3]], b = net.points[c[(k + 2) % 3]];
            round.push_back({a, b - a, glm::dot(b - a, b - a), net.atSharpCorner(stars.triangles[i])});
            nearest = std::min({nearest, glm::dot(a - start, a - start), glm::dot(b - start, b - start)});
        }
        return nearest;
    }

    // Likewise for the sum of all shortfalls round each point: one that is well off itself makes room.
    static void movePointsTogether(PlanarNet& net) {
        std::vector<Side> round;
        for (int pass = 0; pass < kJointPasses; ++pass) {
            const Stars stars(net);
            bool moved = false;
            for (uint32_t v = net.boundaryCount; v < net.points.size(); ++v)
                moved |= moveTogether(net, v, stars, round);
            if (!moved) return;
            net.flipAll();
        }
    }

    // Sum over the triangles round p; no less than `limit` as soon as it is that.
    static double shortfalls(const std::vector<Side>& round, glm::dvec2 p, double limit) {
        double sum = 0;
        for (const Side& side : round) {
            const auto [square, squares, turned] = smallestAngle(side, p);
            if (turned) return kTurned;
            if (side.sharp || square <= kGoodCosine * kGoodCosine * squares) continue;
            sum += shortfall(std::sqrt(square / squares));
            if (sum >= limit) return sum;
        }
        return sum;
    }

    static bool moveTogether(PlanarNet& net, uint32_t v, const Stars& stars, std::vector<Side>& round) {
        const double shortest = std::sqrt(findSides(net, v, stars, round));
        glm::dvec2 best = net.points[v];
        const double before = shortfalls(round, best, kTurned);
        double least = before;
        for (double step = 0.1 * shortest; least > 0 && step > 0.01 * shortest;) {
            bool better = false;
            for (const glm::dvec2 d : directions(net, v)) {
                const glm::dvec2 p = best + step * d;
                const double sum = shortfalls(round, p, 0.999 * least);
                if (sum >= 0.999 * least) continue;
                least = sum;
                best = p;
                better = true;
                break;
            }
            if (!better) step *= 0.5;
        }
        net.points[v] = best;
        return least < 0.99 * before;
    }

    static std::span<const glm::dvec2> directions(const PlanarNet& net, uint32_t v) {
        if (net.slides[v]) return kUpAndDown;
        return kDirections;
    }

    // A pattern search with shrinking steps. `round`: room for the sides round v.
    static bool move(PlanarNet& net, uint32_t v, const Stars& stars, std::vector<Side>& round) {
        const double shortest = std::sqrt(findSides(net, v, stars, round));
        const glm::dvec2 start = net.points[v];
        size_t strictest = 0;
        const double before = std::sqrt(worst(round, start, 1, strictest));
        glm::dvec2 best = start;
        double least = before;
        for (double step = 0.25 * shortest; step > 0.01 * shortest;) {
            bool better = false;
            const double wanted = least - 1e-4;
            for (const glm::dvec2 d : directions(net, v)) {
                const glm::dvec2 p = best + step * d;
                const double square = worst(round, p, wanted * wanted, strictest);
                if (square >= wanted * wanted) continue;
                least = std::sqrt(square);
                best = p;
                better = true;
                break;
            }
            if (!better) step *= 0.5;
        }
        net.points[v] = best;
        return least < before - 1e-3;
    }

    static constexpr int kRings = 2;
    static constexpr double kWorthMoving = 0.001, kWorthAPoint = 0.004; // in terms of a cosine
    static constexpr double kGoodEnough = 0.03, kTurned = 1e300;
    static constexpr double kHalf = 0.70710678;
    static constexpr std::array<glm::dvec2, 8> kDirections{{{1, 0},
                                                            {kHalf, kHalf},
                                                            {0, 1},
                                                            {-kHalf, kHalf},
                                                            {-1, 0},
                                                            {-kHalf, -kHalf},
                                                            {0, -1},
                                                            {kHalf, -kHalf}}};
    static constexpr std::array<glm::dvec2, 2> kUpAndDown{{{0, 1}, {0, -1}}};
    PlanarNet& net_;
    double edge_;
};

} // namespace

size_t raiseAngles(PlanarNet& net, double edge, size_t mostAdded) {
    return Optimiser(net, edge).optimise(mostAdded);
}

SmallAngles smallAngles(const PlanarNet& net, double edge) {
    SmallAngles found;
    for (uint32_t t = 0; t < net.corner.size(); ++t) {
        if (inStrip(net, t, edge) || net.atSharpCorner(t)) continue;
        const double cosine = net.worstCosine(t);
        found.triangles += cosine >= kBadCosine;
        if (cosine <= found.worst) continue;
        found.worst = cosine;
        found.atInner = std::ranges::any_of(net.corner[t], [&](uint32_t v) { return net.inner(v); });
    }
    found.crowded = found.triangles > mostTries(net);
    return found;
}

} // namespace heliodon::geometry
