// Seeds on a hexagonal lattice after L. Freitag and C. Ollivier-Gooch, "Tetrahedral mesh improvement using
// swapping and smoothing" (1997), in that many cheap smoothings are followed by few costly ones where angles
// are still small.
#include "geometry/planar_mesher.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <glm/geometric.hpp>

#include "geometry/angle_optimiser.h"
#include "geometry/even_areas.h"
#include "geometry/mesher.h"
#include "geometry/planar_net.h"

namespace heliodon::geometry {

namespace {

const double kSharpCosine = std::cos(kSharpCorner * std::numbers::pi / 180);
constexpr int kSmoothings = 8;
constexpr double kSmoothingStep = 0.6; // of the way

std::optional<PlanarNet> triangulate(const PlanarDomain& domain, const LatticeSeeds& seeds) {
    PlanarNet net;
    net.points = domain.boundary;
    net.boundaryCount = static_cast<uint32_t>(domain.boundary.size());
    net.points.insert(net.points.end(), seeds.points.begin(), seeds.points.end());
    net.slides.assign(net.points.size(), false);
    for (uint32_t k = 0; k < seeds.onFolds; ++k) net.slides[net.boundaryCount + k] = true;
    std::vector<std::pair<uint32_t, uint32_t>> edges;
    for (size_t l = 0; l < domain.loopCount(); ++l)
        for (uint32_t i = domain.loopStart[l]; i < domain.loopStart[l + 1]; ++i)
            edges.emplace_back(i, domain.next(l, i));
    auto inside = constrainedDelaunay(net.points, edges, seeds.foldEdges);
    if (!inside) // where triangles of a model lean across folds, these leave the outline
        inside = constrainedDelaunay(net.points, edges);
    if (!inside) return std::nullopt;
    static_cast<TriangleNet&>(net) = std::move(*inside);
    net.kinds.assign(net.boundaryCount, PlanarNet::Kind::border);
    for (size_t l = 0; l < domain.loopCount(); ++l)
        for (uint32_t i = domain.loopStart[l]; i < domain.loopStart[l + 1]; ++i) {
            const uint32_t j = domain.next(l, i), k = domain.next(l, j);
            const glm::dvec2 back = net.points[i] - net.points[j], on = net.points[k] - net.points[j];
            if (cross(on, back) > 0 &&
                glm::dot(on, back) > kSharpCosine * glm::length(on) * glm::length(back))
                net.kinds[j] = PlanarNet::Kind::sharp;
        }
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
        const double radius = glm::length(offset);
        const double shortest = std::sqrt(std::min({glm::dot(u, u), glm::dot(v, v), glm::dot(u - v, u - v)}));
        const bool slim = domain_.dividesSlim && !domain_.size.uniform() && radius > kSlim * shortest;
        const double largest = domain_.size.uniform() ? kLargest : kLargestGraded;
        if (!slim && !domain_.size.atMost(a + offset, radius / largest)) return false;
        const double size = domain_.size.at(a + offset);
        const uint32_t target = net_.locate(t, a + offset);
        if (target == kNoTriangle || nearFixedEdge(target, a + offset, domain_.apart * size)) return false;
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

    // Where all else is uniform the lattice has the count; beside small parts refinement evens areas out.
    static constexpr double kLargest = 0.95, kLargestGraded = 0.75, kSlim = 1.2;
    PlanarNet& net_;
    const PlanarDomain& domain_;
};

// Moves each inner point (those on folds, where most are, stand in even steps already) towards the mean of
// its triangles' centroids, weighted by their area over the size wanted, unless that turns one over. Over its
// square, small triangles would stay as small as that. By the area alone the mesh comes to rest long before
// areas are even; by its power of 2.5 large triangles shrink faster, and a step of less than the whole way
// keeps neighbours from overshooting in turns (powers of 2 and more do so with whole steps). `sizes`: of the
// points on the boundary where sizes are not uniform, kept from call to call.
void smooth(PlanarNet& net, const PlanarDomain& domain, std::vector<double>& sizes) {
    const size_t inner = net.points.size() - net.boundaryCount;
    if (!domain.size.uniform()) {
        const size_t known = sizes.empty() ? 0 : net.boundaryCount;
        sizes.resize(net.points.size());
        for (size_t v = known; v < sizes.size(); ++v) sizes[v] = domain.size.at(net.points[v]);
    }
    std::vector<glm::dvec2> sum(inner, glm::dvec2(0));
    std::vector<double> weight(inner, 0);
    for (const auto& c : net.corner) {
        const glm::dvec2 middle = (net.points[c[0]] + net.points[c[1]] + net.points[c[2]]) / 3.0;
        double area = net.twiceArea(c[0], c[1], c[2]);
        if (!domain.size.uniform()) area /= sizes[c[0]] + sizes[c[1]] + sizes[c[2]];
        area = std::max(area, 0.0);
        area *= area * std::sqrt(area);
        for (const uint32_t v : c)
            if (net.inner(v)) {
                sum[v - net.boundaryCount] += area * middle;
                weight[v - net.boundaryCount] += area;
            }
    }
    const bool sliding = 2 * std::ranges::count(net.slides, true) < static_cast<std::ptrdiff_t>(inner);
    std::vector<glm::dvec2> old(net.points.begin() + net.boundaryCount, net.points.end());
    for (size_t i = 0; i < inner; ++i)
        if (weight[i] > 0 && (sliding || !net.slides[net.boundaryCount + i])) {
            glm::dvec2& p = net.points[net.boundaryCount + i];
            p = glm::mix(old[i], sum[i] / weight[i], kSmoothingStep);
            if (net.slides[net.boundaryCount + i]) p.x = old[i].x;
        }
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

// Points of triangles with small angles leave the folds, across which these may then lean.
void leaveFolds(PlanarNet& net) {
    static const double kSmallCosine = std::cos(36 * std::numbers::pi / 180);
    std::vector<bool> free(net.points.size());
    for (uint32_t t = 0; t < net.corner.size(); ++t)
        if (net.worstCosine(t) > kSmallCosine && !net.atSharpCorner(t))
            for (const uint32_t v : net.corner[t]) free[v] = true;
    for (uint32_t t = 0; t < net.corner.size(); ++t)
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t a = net.corner[t][(k + 1) % 3], b = net.corner[t][(k + 2) % 3];
            if (!net.fixed[t][k] || net.neighbour[t][k] == kNoTriangle || !(free[a] || free[b])) continue;
            net.fixed[t][k] = false;
            net.slides[a] = net.slides[b] = false;
        }
    net.flipAll();
}

} // namespace

std::optional<PlanarNet> draftMesh(const PlanarDomain& domain, const LatticeSeeds& seeds) {
    std::optional<PlanarNet> net = triangulate(domain, seeds);
    if (net) Refiner(*net, domain).refine();
    return net;
}

PlanarMesh improvedMesh(PlanarNet net, const PlanarDomain& domain, size_t mostAdded) {
    std::vector<double> sizes;
    for (int k = 0; k < kSmoothings && net.points.size() > net.boundaryCount; ++k) {
        smooth(net, domain, sizes);
        net.flipAll();
    }
    if (domain.mayLean) leaveFolds(net);
    const size_t added = raiseAngles(net, domain.size.edge(), mostAdded);
    const SmallAngles small = smallAngles(net, domain.size.edge());
    evenAreas(net, domain.mayLean); // others might lean further
    return {std::move(net.points), std::move(net.corner), added, small};
}

} // namespace heliodon::geometry
