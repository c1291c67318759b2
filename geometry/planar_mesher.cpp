// Seeds on a hexagonal lattice after L. Freitag and C. Ollivier-Gooch, "Tetrahedral mesh improvement using
// swapping and smoothing" (1997), in that many cheap smoothings are followed by few costly ones where angles
// are still small.
#include "geometry/planar_mesher.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include <glm/geometric.hpp>

#include "geometry/angle_optimiser.h"
#include "geometry/mesher.h"
#include "geometry/planar_net.h"

namespace heliodon::geometry {

namespace {

// Of the edge length: how far seeds are from the boundary. A point of the boundary owns what is nearer than
// the first; with the second angles are better there.
constexpr double kFromBoundary = 0.43, kFarFromBoundary = 0.62;
constexpr double kOnLattice = 0.9; // of the edge length: where sizes are smaller there are no seeds
constexpr int kFewRows = 5;        // of a lattice
const double kSharpCosine = std::cos(kSharpCorner * std::numbers::pi / 180);
constexpr int kSmoothings = 8;
constexpr double kSmoothingStep = 0.6; // of the way

size_t loopCount(const PlanarDomain& domain) {
    return domain.loopStart.size() - 1;
}

uint32_t nextOnLoop(const PlanarDomain& domain, size_t loop, uint32_t i) {
    return i + 1 < domain.loopStart[loop + 1] ? i + 1 : domain.loopStart[loop];
}

// The boundary of a domain by cells of a grid and by rows of a lattice.
class Inside {
public:
    // `points`: the domain's boundary, in axes of its own.
    Inside(const PlanarDomain& domain, const std::vector<glm::dvec2>& points, glm::dvec2 low, glm::dvec2 high,
           double cell)
        : points_(points), cell_(cell), low_(low), columns_(static_cast<int>((high.x - low.x) / cell) + 3),
          rows_(static_cast<int>((high.y - low.y) / cell) + 3) {
        for (size_t l = 0; l < loopCount(domain); ++l)
            for (uint32_t i = domain.loopStart[l]; i < domain.loopStart[l + 1]; ++i)
                segments_.push_back({i, nextOnLoop(domain, l, i)});
        fillCells();
    }

    // Where the line y = low + k step, for k from 1 on, is inside: pairs of x.
    std::vector<std::vector<double>> rows(double step, int count) const {
        std::vector<std::vector<double>> out(static_cast<size_t>(count));
        for (const auto& [i, j] : segments_) {
            const glm::dvec2 a = points_[i], b = points_[j];
            const auto [from, to] = std::minmax(a.y, b.y);
            // From the row before: ends often lie on a row, where only the comparisons below must decide.
            const int first = std::max(1, static_cast<int>((from - low_.y) / step));
            for (int k = first; k < count; ++k) {
                const double y = low_.y + k * step;
                if (y >= to) break;
                if ((a.y > y) == (b.y > y)) continue;
                out[static_cast<size_t>(k)].push_back((b.x - a.x) * (y - a.y) / (b.y - a.y) + a.x);
            }
        }
        for (auto& row : out) std::ranges::sort(row);
        return out;
    }

    // The square of the distance to the boundary as far as `reach`, at most a cell; once it is under `enough`
    // it may be less than what is returned.
    double squareToBoundary(glm::dvec2 p, double reach, double enough) const {
        double nearest = reach * reach;
        const int c = column(p.x), r = row(p.y);
        for (int row = std::max(0, r - 1); row <= std::min(rows_ - 1, r + 1); ++row)
            // Cells of a row follow one another.
            for (uint32_t k = first_[at(std::max(0, c - 1), row)],
                          end = first_[at(std::min(columns_ - 1, c + 1), row) + 1];
                 k < end; ++k) {
                const auto& [a, d, inverse] = inCell_[k];
                const double t = std::clamp(inverse * glm::dot(p - a, d), 0.0, 1.0);
                const glm::dvec2 off = p - a - t * d;
                nearest = std::min(nearest, glm::dot(off, off));
                if (nearest < enough * enough) return nearest;
            }
        return nearest;
    }

private:
    int column(double x) const { return std::clamp(static_cast<int>((x - low_.x) / cell_), 0, columns_ - 1); }
    int row(double y) const { return std::clamp(static_cast<int>((y - low_.y) / cell_), 0, rows_ - 1); }
    size_t at(int column, int row) const { return static_cast<size_t>(row * columns_ + column); }

    void fillCells() {
        std::vector<std::pair<uint32_t, uint32_t>> found; // cell, segment
        for (uint32_t s = 0; s < segments_.size(); ++s) {
            const glm::dvec2 a = points_[segments_[s].first], b = points_[segments_[s].second];
            const int steps = static_cast<int>(glm::length(b - a) / (0.5 * cell_)) + 1;
            auto last = static_cast<uint32_t>(-1);
            for (int k = 0; k <= steps; ++k) {
                const glm::dvec2 p = a + (b - a) * (static_cast<double>(k) / steps);
                const auto cell = static_cast<uint32_t>(at(column(p.x), row(p.y)));
                if (cell != last) found.emplace_back(cell, s);
                last = cell;
            }
        }
        first_.assign(static_cast<size_t>(columns_) * static_cast<size_t>(rows_) + 1, 0);
        for (const auto& [cell, s] : found) ++first_[cell + 1];
        for (size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
        inCell_.resize(found.size());
        std::vector<uint32_t> place(first_.begin(), first_.end() - 1);
        for (const auto& [cell, s] : found) {
            const glm::dvec2 a = points_[segments_[s].first], d = points_[segments_[s].second] - a;
            inCell_[place[cell]++] = {a, d, 1 / glm::dot(d, d)};
        }
    }

    const std::vector<glm::dvec2>& points_;
    double cell_;
    glm::dvec2 low_;
    int columns_, rows_;
    std::vector<std::pair<uint32_t, uint32_t>> segments_;
    struct Line {
        glm::dvec2 from, run;
        double inverse; // of the square of its length
    };
    std::vector<uint32_t> first_;
    std::vector<Line> inCell_; // segments by cell
};

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
    net.kinds.assign(net.boundaryCount, PlanarNet::Kind::border);
    for (size_t l = 0; l < loopCount(domain); ++l)
        for (uint32_t i = domain.loopStart[l]; i < domain.loopStart[l + 1]; ++i) {
            const uint32_t j = nextOnLoop(domain, l, i), k = nextOnLoop(domain, l, j);
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
        if (!slim && !domain_.size.atMost(a + offset, radius / kLargest)) return false;
        const double size = domain_.size.at(a + offset);
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

    static constexpr double kLargest = 0.95, kApart = 0.45, kSlim = 1.2;
    PlanarNet& net_;
    const PlanarDomain& domain_;
};

// Moves each inner point towards the mean of its triangles' centroids, weighted by their area in terms of the
// size wanted, unless that turns one over. By the area alone the mesh comes to rest long before areas are
// even; by its power of 2.5 large triangles shrink faster, and a step of less than the whole way keeps
// neighbours from overshooting in turns (powers of 2 and more do so with whole steps).
// `sizes`: of the points on the boundary where sizes are not uniform, kept from call to call.
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
        if (!domain.size.uniform()) {
            const double size = sizes[c[0]] + sizes[c[1]] + sizes[c[2]];
            area /= size * size;
        }
        area = std::max(area, 0.0);
        area *= area * std::sqrt(area);
        for (const uint32_t v : c)
            if (net.inner(v)) {
                sum[v - net.boundaryCount] += area * middle;
                weight[v - net.boundaryCount] += area;
            }
    }
    std::vector<glm::dvec2> old(net.points.begin() + net.boundaryCount, net.points.end());
    for (size_t i = 0; i < inner; ++i)
        if (weight[i] > 0)
            net.points[net.boundaryCount + i] = glm::mix(old[i], sum[i] / weight[i], kSmoothingStep);
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

// Whole rows and columns of a hexagonal lattice over a domain, in its own direction.
class HexagonalLattice {
public:
    HexagonalLattice(const PlanarDomain& domain, double edge) : domain_(domain), edge_(edge) {
        for (const glm::dvec2 p : domain.boundary)
            turned_.emplace_back(glm::dot(p, domain.direction), glm::dot(p, across()));
        high_ = low_ = turned_[0];
        for (const glm::dvec2 p : turned_) {
            low_ = glm::min(low_, p);
            high_ = glm::max(high_, p);
        }
        const glm::dvec2 extent = high_ - low_;
        row_ = extent.y / std::max(1.0, std::round(extent.y / (edge * std::sqrt(3.0) / 2)));
        column_ = extent.x / std::max(1.0, std::round(extent.x / edge));
        rowCount_ = static_cast<int>(std::ceil(extent.y / row_ - 0.25));
    }

    int rowCount() const { return rowCount_; }
    Inside inside() const { return {domain_, turned_, low_, high_, edge_}; }
    std::vector<std::vector<double>> rows(const Inside& inside) const { return inside.rows(row_, rowCount_); }

    struct Seeds {
        std::vector<glm::dvec2> far, all; // from the boundary
    };
    // Of rows of which every other, counted from `shifted`, is moved by half a column.
    Seeds seeds(const Inside& inside, const std::vector<std::vector<double>>& rows, size_t shifted) const {
        const double nearReach = kFromBoundary * edge_, farReach = kFarFromBoundary * edge_;
        Seeds found;
        for (size_t r = 1; r < rows.size(); ++r)
            for (size_t k = 0; k + 1 < rows[r].size(); k += 2) {
                const double shift = low_.x + (r % 2 == shifted ? 0.5 * column_ : 0.0),
                             y = low_.y + static_cast<double>(r) * row_;
                for (double c = std::max(0.0, std::floor((rows[r][k] - shift) / column_) + 1);
                     shift + c * column_ < rows[r][k + 1]; ++c) {
                    const glm::dvec2 p(shift + c * column_, y);
                    const double square = inside.squareToBoundary(p, farReach, nearReach);
                    if (square < nearReach * nearReach) continue;
                    const glm::dvec2 seed = p.x * domain_.direction + p.y * across();
                    if (domain_.size.atMost(seed, kOnLattice * domain_.size.edge())) continue;
                    found.all.push_back(seed);
                    if (square >= farReach * farReach) found.far.push_back(seed);
                }
            }
        return found;
    }

private:
    glm::dvec2 across() const { return {-domain_.direction.y, domain_.direction.x}; }

    const PlanarDomain& domain_;
    double edge_;
    std::vector<glm::dvec2> turned_; // the boundary along `direction` and across
    glm::dvec2 low_, high_;
    double row_, column_;
    int rowCount_;
};

double twiceAreaOf(const PlanarDomain& domain) {
    double twice = 0;
    for (size_t l = 0; l < loopCount(domain); ++l)
        for (uint32_t i = domain.loopStart[l]; i < domain.loopStart[l + 1]; ++i)
            twice += cross(domain.boundary[i], domain.boundary[nextOnLoop(domain, l, i)]);
    return twice;
}

} // namespace

std::vector<glm::dvec2> hexagonalSeeds(const PlanarDomain& domain, double edge) {
    const HexagonalLattice lattice(domain, edge);
    if (lattice.rowCount() < 2) return {};
    const Inside inside = lattice.inside();
    const std::vector<std::vector<double>> rows = lattice.rows(inside);
    const double twice = twiceAreaOf(domain);
    std::vector<glm::dvec2> best;
    double least = std::numeric_limits<double>::infinity();
    // Those that make as many triangles as the lattice has over the domain's area.
    const auto keepBest = [&](std::vector<glm::dvec2>&& seeds) {
        const double count = 2 * static_cast<double>(seeds.size() + loopCount(domain)) +
                             static_cast<double>(domain.boundary.size()) - 4;
        const double off = std::abs(std::log(count * std::sqrt(3.0) / 2 * edge * edge / twice));
        if (off >= least) return;
        least = off;
        best = std::move(seeds);
    };
    // Beginning with the second row or with the first: in small domains one of the two may leave next to
    // nothing.
    for (const size_t shifted : {size_t{1}, size_t{0}}) {
        if (shifted == 0 && lattice.rowCount() > kFewRows) break;
        HexagonalLattice::Seeds seeds = lattice.seeds(inside, rows, shifted);
        keepBest(std::move(seeds.far));
        keepBest(std::move(seeds.all));
    }
    return best;
}

PlanarNet draftMesh(const PlanarDomain& domain, const std::vector<glm::dvec2>& seeds) {
    PlanarNet net = triangulate(domain, seeds);
    Refiner(net, domain).refine();
    return net;
}

PlanarMesh improvedMesh(PlanarNet net, const PlanarDomain& domain, size_t mostAdded) {
    std::vector<double> sizes;
    for (int k = 0; k < kSmoothings && net.points.size() > net.boundaryCount; ++k) {
        smooth(net, domain, sizes);
        net.flipAll();
    }
    const size_t added = raiseAngles(net, domain.size.edge(), mostAdded);
    return {std::move(net.points), std::move(net.corner), added};
}

} // namespace heliodon::geometry
