// Seeds on a hexagonal lattice after L. Freitag and C. Ollivier-Gooch, "Tetrahedral mesh improvement using
// swapping and smoothing" (1997), in that many cheap smoothings are followed by few costly ones where angles
// are still small.
#include "geometry/planar_mesher.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <glm/geometric.hpp>

#include "geometry/planar_net.h"

namespace heliodon::geometry {

namespace {

constexpr double kFromBoundary = 0.62; // of the edge length
constexpr double kOnLattice = 0.9;     // of the edge length: where sizes are smaller there are no seeds
constexpr int kSmoothings = 8;
constexpr int kOptimisations = 8, kTrials = 6;
const double kGoodCosine = std::cos(39 * 3.14159265358979 / 180);  // angles above 39 degrees are left alone
const double kBadCosine = std::cos(36.5 * 3.14159265358979 / 180); // those below 36.5 are worth a point

size_t loopCount(const PlanarDomain& domain) {
    return domain.loopStart.size() - 1;
}

uint32_t nextOnLoop(const PlanarDomain& domain, size_t loop, uint32_t i) {
    return i + 1 < domain.loopStart[loop + 1] ? i + 1 : domain.loopStart[loop];
}

// Rows of the inside of the domain and the boundary near a point, by bucketing the boundary segments.
class Inside {
public:
    Inside(const PlanarDomain& domain, double edge) : domain_(domain), cell_(edge) {
        low_ = high_ = domain.boundary[0];
        for (const glm::dvec2 p : domain.boundary) {
            low_ = glm::min(low_, p);
            high_ = glm::max(high_, p);
        }
        columns_ = static_cast<int>((high_.x - low_.x) / cell_) + 3;
        rows_ = static_cast<int>((high_.y - low_.y) / cell_) + 3;
        buckets_.resize(static_cast<size_t>(columns_) * static_cast<size_t>(rows_));
        rowSegments_.resize(static_cast<size_t>(rows_));
        for (size_t l = 0; l < loopCount(domain); ++l)
            for (uint32_t i = domain.loopStart[l]; i < domain.loopStart[l + 1]; ++i)
                add(i, nextOnLoop(domain, l, i));
    }

    bool contains(glm::dvec2 p) const {
        bool in = false;
        for (const auto& [i, j] : rowSegments_[static_cast<size_t>(row(p.y))]) {
            const glm::dvec2 a = domain_.boundary[i], b = domain_.boundary[j];
            if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x) in = !in;
        }
        return in;
    }

    bool nearBoundary(glm::dvec2 p, double distance) const {
        const int c = column(p.x), r = row(p.y);
        for (int dr = -1; dr <= 1; ++dr)
            for (int dc = -1; dc <= 1; ++dc) {
                if (c + dc < 0 || r + dr < 0 || c + dc >= columns_ || r + dr >= rows_) continue;
                for (const auto& [i, j] : buckets_[static_cast<size_t>((r + dr) * columns_ + c + dc)]) {
                    const glm::dvec2 a = domain_.boundary[i], d = domain_.boundary[j] - a;
                    const double t = std::clamp(glm::dot(p - a, d) / glm::dot(d, d), 0.0, 1.0);
                    const glm::dvec2 off = p - a - t * d;
                    if (glm::dot(off, off) < distance * distance) return true;
                }
            }
        return false;
    }

    glm::dvec2 low() const { return low_; }
    glm::dvec2 high() const { return high_; }

private:
    int column(double x) const { return std::clamp(static_cast<int>((x - low_.x) / cell_), 0, columns_ - 1); }
    int row(double y) const { return std::clamp(static_cast<int>((y - low_.y) / cell_), 0, rows_ - 1); }

    void add(uint32_t i, uint32_t j) {
        const glm::dvec2 a = domain_.boundary[i], b = domain_.boundary[j];
        for (int r = row(std::min(a.y, b.y)); r <= row(std::max(a.y, b.y)); ++r)
            rowSegments_[static_cast<size_t>(r)].emplace_back(i, j);
        const int steps = static_cast<int>(glm::length(b - a) / (0.5 * cell_)) + 1;
        size_t last = buckets_.size();
        for (int s = 0; s <= steps; ++s) {
            const glm::dvec2 p = a + (b - a) * (static_cast<double>(s) / steps);
            const auto bucket = static_cast<size_t>(row(p.y) * columns_ + column(p.x));
            if (bucket != last) buckets_[bucket].emplace_back(i, j);
            last = bucket;
        }
    }

    const PlanarDomain& domain_;
    double cell_;
    glm::dvec2 low_{}, high_{};
    int columns_ = 0, rows_ = 0;
    std::vector<std::vector<std::pair<uint32_t, uint32_t>>> buckets_, rowSegments_;
};

// Direction of the longest straight run of the boundary.
glm::dvec2 mainDirection(const PlanarDomain& domain) {
    glm::dvec2 best{1, 0};
    double longest = 0;
    for (size_t l = 0; l < loopCount(domain); ++l) {
        glm::dvec2 run{0};
        for (uint32_t k = 0, n = domain.loopStart[l + 1] - domain.loopStart[l]; k < 2 * n; ++k) {
            const uint32_t i = domain.loopStart[l] + k % n;
            const glm::dvec2 d = domain.boundary[nextOnLoop(domain, l, i)] - domain.boundary[i];
            const bool onward =
                glm::dot(run, d) > 0 && std::abs(cross(run, d)) < 1e-6 * glm::length(run) * glm::length(d);
            run = onward && k < n + n / 2 ? run + d : d;
            if (glm::length(run) > longest * (1 + 1e-9)) {
                longest = glm::length(run);
                best = run / longest;
            }
        }
    }
    return best;
}

PlanarNet triangulate(const PlanarDomain& domain, const std::vector<glm::dvec2>& seeds) {
    PlanarNet net;
    net.points = domain.boundary;
    net.boundaryCount = static_cast<uint32_t>(domain.boundary.size());
    net.points.insert(net.points.end(), seeds.begin(), seeds.end());
    std::vector<std::pair<uint32_t, uint32_t>> edges;
    for (size_t l = 0; l < loopCount(domain); ++l)
        for (uint32_t i = domain.loopStart[l]; i < domain.loopStart[l + 1]; ++i)
            edges.emplace_back(i, nextOnLoop(domain, l, i));
    auto inside = constrainedDelaunay(net.points, edges);
    if (!inside)
        throw std::runtime_error("the outline of a face crosses or touches itself and cannot be meshed");
    static_cast<TriangleNet&>(net) = std::move(*inside);
    return net;
}

// Adds circumcentres of triangles that are larger than the size wanted there. The boundary is not divided:
// where it keeps a circumcentre out, the triangle stays.
class Refiner {
public:
    Refiner(PlanarNet& net, const PlanarDomain& domain) : net_(net), domain_(domain) {}

    void refine() {
        for (int round = 0; round < 40; ++round) {
            bool any = false;
            for (uint32_t t = 0; t < net_.corner.size(); ++t) any |= divide(t);
            if (!any) return;
        }
    }

private:
    bool divide(uint32_t t) {
        const glm::dvec2 a = net_.points[net_.corner[t][0]], u = net_.points[net_.corner[t][1]] - a,
                         v = net_.points[net_.corner[t][2]] - a;
        const double twice = 2 * cross(u, v);
        if (twice <= 0) return false;
        const glm::dvec2 offset = glm::dvec2(v.y * glm::dot(u, u) - u.y * glm::dot(v, v),
                                             u.x * glm::dot(v, v) - v.x * glm::dot(u, u)) /
                                  twice;
        // An equilateral triangle of the size wanted has a circumradius of 0.577 of it.
        const double radius = glm::length(offset), size = domain_.sizeAt(a + offset);
        if (radius < kLargest * size) return false;
        const uint32_t target = net_.locate(t, a + offset);
        if (target == kNoTriangle || nearFixedEdge(target, a + offset, kApart * size)) return false;
        net_.insert(target, a + offset);
        return true;
    }

    bool nearFixedEdge(uint32_t t, glm::dvec2 p, double distance) const {
        for (size_t k = 0; k < 3; ++k) {
            const glm::dvec2 a = net_.points[net_.corner[t][(k + 1) % 3]],
                             d = net_.points[net_.corner[t][(k + 2) % 3]] - a;
            const double height = cross(d, p - a) / glm::length(d);
            if (height < (net_.fixed[t][k] ? distance : 0.1 * distance)) return true;
        }
        return false;
    }

    static constexpr double kLargest = 0.95, kApart = 0.45;
    PlanarNet& net_;
    const PlanarDomain& domain_;
};

// Moves each inner point to the mean of its triangles' centroids, weighted by their area in terms of the size
// wanted, unless that turns one over.
void smooth(PlanarNet& net, const PlanarDomain& domain) {
    const size_t inner = net.points.size() - net.boundaryCount;
    std::vector<glm::dvec2> sum(inner, glm::dvec2(0));
    std::vector<double> weight(inner, 0);
    for (const auto& c : net.corner) {
        const glm::dvec2 middle = (net.points[c[0]] + net.points[c[1]] + net.points[c[2]]) / 3.0;
        double area = net.twiceArea(c[0], c[1], c[2]);
        if (!domain.sources.empty()) {
            const double size = domain.sizeAt(middle);
            area /= size * size;
        }
        for (const uint32_t v : c)
            if (net.inner(v)) {
                sum[v - net.boundaryCount] += area * middle;
                weight[v - net.boundaryCount] += area;
            }
    }
    std::vector<glm::dvec2> old(net.points.begin() + net.boundaryCount, net.points.end());
    for (size_t i = 0; i < inner; ++i)
        if (weight[i] > 0) net.points[net.boundaryCount + i] = sum[i] / weight[i];
    for (bool again = true; again;) {
        again = false;
        for (const auto& c : net.corner) {
            if (net.twiceArea(c[0], c[1], c[2]) > 0) continue;
            for (const uint32_t v : c)
                if (net.inner(v) && net.points[v] != old[v - net.boundaryCount]) {
                    net.points[v] = old[v - net.boundaryCount];
                    again = true;
                }
        }
    }
}

// Moves single points so that the smallest angle round them grows, and adds points where moving is not
// enough.
class Optimiser {
public:
    Optimiser(PlanarNet& net, double edge) : net_(net), edge_(edge) {}

    // Returns how many points it added, at most `mostAdded`.
    size_t optimise(size_t mostAdded) {
        movePoints(net_, kOptimisations);
        return addPoints(mostAdded);
    }

private:
    // Only those of triangles with small angles, and again only where something near has moved.
    static void movePoints(PlanarNet& net, int rounds) {
        std::vector<bool> stirred(net.points.size(), true);
        for (int round = 0; round < rounds; ++round) {
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
                if (!move(net, v, stars)) continue;
                moved = true;
                for (uint32_t i = stars.first[v]; i < stars.first[v + 1]; ++i)
                    for (const uint32_t w : net.corner[stars.triangles[i]]) stirred[w] = true;
            }
            if (!moved) return;
            net.flipAll();
        }
    }

    // One point in or beside each triangle that is still bad, where it helps. Tried on the surroundings
    // alone.
    size_t addPoints(size_t mostAdded) {
        // Where many are bad the parts are small beside the edges, and points would only crowd them.
        const size_t most = kFewAdditions + net_.corner.size() / kTrianglesAnAddition;
        size_t tries = 0, added = 0;
        std::optional<Stars> stars;
        for (uint32_t t = 0; t < net_.corner.size() && tries < most && added < mostAdded; ++t) {
            if (net_.worstCosine(t) < kBadCosine || inStrip(t)) continue;
            ++tries;
            if (!stars) stars.emplace(net_);
            NetPart part(net_, *stars, t, kRings);
            const double before = badness(part.net);
            const auto [target, p] = placeFor(part.net, 0);
            part.net.insert(target, p);
            movePoints(part.net, kTrials);
            if (badness(part.net) >= before - kWorthAPoint) continue;
            part.putBack(net_);
            stars.reset();
            ++added;
        }
        return added;
    }

    // From border to border where those are near: no point has room there.
    bool inStrip(uint32_t t) const {
        double longest = 0;
        for (size_t k = 0; k < 3; ++k) {
            if (net_.inner(net_.corner[t][k])) return false;
            longest = std::max(longest, glm::length(net_.points[net_.corner[t][(k + 1) % 3]] -
                                                    net_.points[net_.corner[t][k]]));
        }
        return net_.twiceArea(t) < kStrip * edge_ * longest;
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

    // Squared shortfalls of angles below the good one.
    static double badness(const PlanarNet& net) {
        double sum = 0;
        for (uint32_t t = 0; t < net.corner.size(); ++t) {
            const double cosine = net.worstCosine(t);
            if (cosine > kGoodCosine) sum += (cosine - kGoodCosine) * (cosine - kGoodCosine);
        }
        return sum;
    }

    // Cosine of the smallest angle round v if it were at p; anything from `limit` on when it is that much.
    static double worst(const PlanarNet& net, uint32_t v, glm::dvec2 p, const Stars& stars, double limit) {
        double cosine = -1;
        for (uint32_t i = stars.first[v]; i < stars.first[v + 1] && cosine < limit; ++i) {
            const auto& c = net.corner[stars.triangles[i]];
            const auto at = [&](size_t k) { return c[k] == v ? p : net.points[c[k]]; };
            cosine = std::max(cosine, net.worstCosine(at(0), at(1), at(2)));
        }
        return cosine;
    }

    // A pattern search with shrinking steps.
    static bool move(PlanarNet& net, uint32_t v, const Stars& stars) {
        const glm::dvec2 start = net.points[v];
        glm::dvec2 best = start;
        double least = worst(net, v, best, stars, 1), shortest = 1e300;
        const double before = least;
        for (uint32_t i = stars.first[v]; i < stars.first[v + 1]; ++i)
            for (const uint32_t w : net.corner[stars.triangles[i]])
                if (w != v) shortest = std::min(shortest, glm::length(net.points[w] - start));
        for (double step = 0.25 * shortest; step > 0.01 * shortest;) {
            bool better = false;
            for (const glm::dvec2 d : kDirections) {
                const glm::dvec2 p = best + step * d;
                const double cosine = worst(net, v, p, stars, least - 1e-4);
                if (cosine >= least - 1e-4) continue;
                least = cosine;
                best = p;
                better = true;
                break;
            }
            if (!better) step *= 0.5;
        }
        net.points[v] = best;
        return least < before - 1e-3;
    }

    static constexpr size_t kFewAdditions = 5, kTrianglesAnAddition = 40;
    static constexpr int kRings = 3;
    static constexpr double kWorthAPoint = 1e-4, kStrip = 0.4; // of the edge length
    static constexpr double kHalf = 0.70710678;
    static constexpr std::array<glm::dvec2, 8> kDirections{{{1, 0},
                                                            {kHalf, kHalf},
                                                            {0, 1},
                                                            {-kHalf, kHalf},
                                                            {-1, 0},
                                                            {-kHalf, -kHalf},
                                                            {0, -1},
                                                            {kHalf, -kHalf}}};
    PlanarNet& net_;
    double edge_;
};

} // namespace

double PlanarDomain::sizeAt(glm::dvec2 p) const {
    double size = edge;
    for (const SizeSource& source : sources) { // most are too far away to matter
        const glm::dvec2 d = p - source.at;
        const double reach = (size - source.size) / growth, square = glm::dot(d, d);
        if (reach > 0 && square < reach * reach) size = source.size + growth * std::sqrt(square);
    }
    return size;
}

std::vector<glm::dvec2> hexagonalSeeds(const PlanarDomain& domain, double lattice) {
    const glm::dvec2 u = mainDirection(domain), v{-u.y, u.x};
    PlanarDomain turned = domain;
    for (glm::dvec2& p : turned.boundary) p = {glm::dot(p, u), glm::dot(p, v)};
    const Inside inside(turned, lattice);
    const glm::dvec2 extent = inside.high() - inside.low();
    // Whole rows and columns between the sides.
    const double row = extent.y / std::max(1.0, std::round(extent.y / (lattice * std::sqrt(3.0) / 2)));
    const double column = extent.x / std::max(1.0, std::round(extent.x / lattice));
    std::vector<glm::dvec2> seeds;
    for (int r = 1; r * row < extent.y - 0.25 * row; ++r)
        for (int c = 0; c * column < extent.x + column; ++c) {
            const glm::dvec2 p = inside.low() + glm::dvec2((c + (r % 2 ? 0.5 : 0.0)) * column, r * row);
            if (p.x >= inside.high().x || !inside.contains(p) ||
                inside.nearBoundary(p, kFromBoundary * lattice))
                continue;
            const glm::dvec2 seed = p.x * u + p.y * v;
            if (domain.sources.empty() || domain.sizeAt(seed) > kOnLattice * domain.edge)
                seeds.push_back(seed);
        }
    return seeds;
}

PlanarMesh meshPlanar(const PlanarDomain& domain, const std::vector<glm::dvec2>& seeds,
                      std::optional<size_t> mostAdded) {
    PlanarNet net = triangulate(domain, seeds);
    Refiner(net, domain).refine();
    size_t added = 0;
    if (mostAdded) {
        for (int k = 0; k < kSmoothings && net.points.size() > net.boundaryCount; ++k) {
            smooth(net, domain);
            net.flipAll();
        }
        added = Optimiser(net, domain.edge).optimise(*mostAdded);
    }
    return {std::move(net.points), std::move(net.corner), added};
}

} // namespace heliodon::geometry
