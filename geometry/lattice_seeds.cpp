#include "geometry/lattice_seeds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"

namespace heliodon::geometry {

namespace {

// Of the edge length: how far seeds are from the boundary. A point of the boundary owns what is nearer than
// the first; with the second angles are better there.
constexpr double kFromBoundary = 0.43, kFarFromBoundary = 0.62;
constexpr double kOnLattice = 0.75; // of the edge length: where sizes are smaller there are no seeds
constexpr int kFewRows = 5;        // of a lattice

// The boundary of a domain by cells of a grid and by rows of a lattice.
class Inside {
public:
    // `points`: the domain's boundary, in axes of its own.
    Inside(const PlanarDomain& domain, const std::vector<glm::dvec2>& points, glm::dvec2 low, glm::dvec2 high,
           double cell)
        : points_(points), cell_(cell), low_(low), columns_(static_cast<int>((high.x - low.x) / cell) + 3),
          rows_(static_cast<int>((high.y - low.y) / cell) + 3) {
        for (size_t l = 0; l < domain.loopCount(); ++l)
            for (uint32_t i = domain.loopStart[l]; i < domain.loopStart[l + 1]; ++i)
                segments_.push_back({i, domain.next(l, i)});
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

    // Where the line y = level is inside: pairs of x.
    std::vector<double> row(double level) const {
        std::vector<double> out;
        for (const auto& [i, j] : segments_) {
            const glm::dvec2 a = points_[i], b = points_[j];
            if ((a.y > level) != (b.y > level))
                out.push_back((b.x - a.x) * (level - a.y) / (b.y - a.y) + a.x);
        }
        std::ranges::sort(out);
        return out;
    }

    // The square of the distance to the boundary as far as `reach`, at most a cell; once it is under `enough`
    // it may be less than what is returned.
    double squareToBoundary(glm::dvec2 p, double reach, double enough) const {
        double nearest = reach * reach;
        const int c = columnOf(p.x), r = rowOf(p.y);
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
    int columnOf(double x) const {
        return std::clamp(static_cast<int>((x - low_.x) / cell_), 0, columns_ - 1);
    }
    int rowOf(double y) const { return std::clamp(static_cast<int>((y - low_.y) / cell_), 0, rows_ - 1); }
    size_t at(int column, int row) const { return static_cast<size_t>(row * columns_ + column); }

    void fillCells() {
        std::vector<std::pair<uint32_t, uint32_t>> found; // cell, segment
        for (uint32_t s = 0; s < segments_.size(); ++s) {
            const glm::dvec2 a = points_[segments_[s].first], b = points_[segments_[s].second];
            const int steps = static_cast<int>(glm::length(b - a) / (0.5 * cell_)) + 1;
            auto last = static_cast<uint32_t>(-1);
            for (int k = 0; k <= steps; ++k) {
                const glm::dvec2 p = a + (b - a) * (static_cast<double>(k) / steps);
                const auto cell = static_cast<uint32_t>(at(columnOf(p.x), rowOf(p.y)));
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
    for (size_t l = 0; l < domain.loopCount(); ++l)
        for (uint32_t i = domain.loopStart[l]; i < domain.loopStart[l + 1]; ++i)
            twice += cross(domain.boundary[i], domain.boundary[domain.next(l, i)]);
    return twice;
}

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
        const double count = 2 * static_cast<double>(seeds.size() + domain.loopCount()) +
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

// Facets as wide as that, of the edge length, have good triangles between points at equal heights, and
// between staggered ones; narrower ones want them staggered by about half a step.
constexpr double kAligned = 0.7;
constexpr double kDivided = 1.22, kRow = 0.866; // of the edge length: wider facets have rows of points within

// Upright rows of points on the folds of an unrolled wall and within its wide facets.
class FoldedLattice {
public:
    FoldedLattice(const PlanarDomain& domain, double edge) : domain_(domain), edge_(edge) {
        for (const glm::dvec2 p : domain.boundary) turned_.emplace_back(p.y, p.x);
        high_ = low_ = turned_[0];
        for (const glm::dvec2 p : turned_) {
            low_ = glm::min(low_, p);
            high_ = glm::max(high_, p);
        }
        places_ = domain.folds;
        places_.insert(places_.begin(), low_.y);
        places_.push_back(high_.y);
        findFineSteps();
        chooseShifts();
    }

    LatticeSeeds seeds() {
        for (size_t fold = 1; fold + 1 < places_.size(); ++fold) addFold(fold);
        seeds_.onFolds = static_cast<uint32_t>(seeds_.points.size());
        const Inside inside(domain_, turned_, low_, high_, edge_);
        for (size_t facet = 0; facet + 1 < places_.size(); ++facet)
            for (double row = 1; row < rows(facet); ++row) addRow(facet, row, inside);
        return std::move(seeds_);
    }

private:
    // Into so many a facet is divided.
    double rows(size_t facet) const {
        const double width = (places_[facet + 1] - places_[facet]) / edge_;
        return width < kDivided ? 1 : std::max(2.0, std::round(width / kRow));
    }
    double width(size_t facet) const { return (places_[facet + 1] - places_[facet]) / rows(facet); }

    // Beside short steps of the boundary, as those of narrow strips are, folds have short ones too.
    void findFineSteps() {
        if (!domain_.graded) return;
        std::vector<SizeSource> sources;
        for (size_t l = 0; l < domain_.loopCount(); ++l)
            for (uint32_t i = domain_.loopStart[l]; i < domain_.loopStart[l + 1]; ++i) {
                const glm::dvec2 a = domain_.boundary[i], d = domain_.boundary[domain_.next(l, i)] - a,
                                 middle = a + 0.5 * d;
                const auto after = std::ranges::upper_bound(places_, middle.x);
                const double facet = after == places_.begin() || after == places_.end()
                                         ? edge_
                                         : *after - *(after - 1),
                             length = glm::length(d);
                if (length < kFineStep * edge_ && std::abs(d.x) < kWholeFacet * facet)
                    sources.push_back({middle, length});
            }
        fine_ = SizeField(std::move(sources), edge_, kGrowth);
    }

    // By what part of a step the points of each fold are moved up; those of the two ends stay.
    void chooseShifts() {
        const size_t facets = places_.size() - 1;
        std::vector<double> turns;
        double sum = 0, wide = 0;
        for (size_t f = 0; f < facets; ++f) {
            const bool narrow = ColumnSteps(width(f), edge_, domain_.graded).staggered;
            turns.push_back(narrow && std::fmod(rows(f), 2) == 1 ? 0.5 : 0.0);
            sum += turns.back();
            wide += narrow ? 0 : 1;
        }
        const double off = std::round(sum) - sum;
        shifts_.assign(places_.size(), 0);
        for (size_t f = 0; f < facets; ++f) {
            const bool narrow = ColumnSteps(width(f), edge_, domain_.graded).staggered;
            const double own = wide > 0 ? (narrow ? 0 : off / wide) : off / static_cast<double>(facets);
            shifts_[f + 1] = shifts_[f] + turns[f] + own;
        }
    }

    // Heights from one end of a row to the other, both left out.
    std::vector<double> heights(double x, double from, double to, double width, double shift) const {
        const ColumnSteps steps(width, edge_, domain_.graded);
        std::vector<std::pair<double, double>> counted{{from, 0.0}}; // steps up to there
        if (domain_.size.uniform() && fine_.uniform()) {
            counted.emplace_back(to, (to - from) / steps.step);
        } else {
            double y = from, count = 0;
            while (y < to) {
                const double size = sizeAt({x, y}, steps.step),
                             next = to - y < 0.35 * size ? to : y + 0.25 * size;
                count += (next - y) / size;
                counted.emplace_back(y = next, count);
            }
        }
        const double all = counted.back().second, n = steps.count(to - from, all);
        shift -= std::floor(shift);
        if (shift < kLeastStep) ++shift;
        std::vector<double> out;
        size_t i = 0;
        for (double k = shift; k < n - kLeastStep; ++k) {
            const double wanted = all * k / n;
            while (counted[i + 1].second < wanted) ++i;
            const auto [low, before] = counted[i];
            const auto [high, after] = counted[i + 1];
            out.push_back(low + (high - low) * (wanted - before) / (after - before));
        }
        return out;
    }

    double sizeAt(glm::dvec2 p, double step) const {
        if (!domain_.size.uniform()) step *= domain_.size.at(p) / domain_.size.edge();
        return fine_.uniform() ? step : std::min(step, fine_.at(p));
    }

    void addFold(size_t fold) {
        const double x = places_[fold], same = kSamePlace * (high_.x - low_.x + high_.y - low_.y);
        std::vector<uint32_t> on;
        for (uint32_t i = 0; i < domain_.boundary.size(); ++i)
            if (std::abs(domain_.boundary[i].x - x) <= same) on.push_back(i);
        std::ranges::sort(on, {}, [&](uint32_t i) { return domain_.boundary[i].y; });
        const double own = std::min(width(fold - 1), width(fold));
        for (size_t k = 0; k + 1 < on.size(); ++k) {
            const double from = domain_.boundary[on[k]].y, to = domain_.boundary[on[k + 1]].y;
            if (!crossesInside(x, 0.5 * (from + to), same)) continue;
            uint32_t last = on[k];
            const auto join = [&](uint32_t v) { seeds_.foldEdges.emplace_back(std::exchange(last, v), v); };
            for (const double y : heights(x, from, to, own, shifts_[fold])) {
                const double room = 0.5 * kBeside * edge_;
                if (besideBorder(x, y - room, y + room)) continue;
                join(static_cast<uint32_t>(domain_.boundary.size() + seeds_.points.size()));
                seeds_.points.emplace_back(x, y);
            }
            join(on[k + 1]);
        }
    }

    // Whether an upright side of the boundary runs too near for a point of the fold: triangles are slim there,
    // for if they lay across the fold they could cross what stands beside the wall.
    bool besideBorder(double x, double from, double to) const {
        const double least = kBeside * edge_;
        for (size_t l = 0; l < domain_.loopCount(); ++l)
            for (uint32_t i = domain_.loopStart[l]; i < domain_.loopStart[l + 1]; ++i) {
                const glm::dvec2 a = domain_.boundary[i], b = domain_.boundary[domain_.next(l, i)];
                const double off = std::max(std::abs(a.x - x), std::abs(b.x - x));
                const bool isEnd = std::min(a.x, b.x) - low_.y < least * kSamePlace ||
                                   high_.y - std::max(a.x, b.x) < least * kSamePlace;
                if (!isEnd && off < least && std::abs(b.y - a.y) > std::abs(b.x - a.x) &&
                    std::min(a.y, b.y) < to && std::max(a.y, b.y) > from)
                    return true;
            }
        return false;
    }

    // Whether the domain lies on both sides of a place between two of the boundary's points on a fold.
    bool crossesInside(double x, double y, double same) const {
        bool in = false;
        for (size_t l = 0; l < domain_.loopCount(); ++l)
            for (uint32_t i = domain_.loopStart[l]; i < domain_.loopStart[l + 1]; ++i) {
                const glm::dvec2 a = domain_.boundary[i], b = domain_.boundary[domain_.next(l, i)];
                if (std::abs(a.x - x) <= same && std::abs(b.x - x) <= same && (a.y > y) != (b.y > y))
                    return false;
                if ((a.x > x) != (b.x > x) && a.y + (x - a.x) / (b.x - a.x) * (b.y - a.y) > y) in = !in;
            }
        return in;
    }

    void addRow(size_t facet, double row, const Inside& inside) {
        const double x = places_[facet] + row * width(facet), shift = shifts_[facet] + 0.5 * row,
                     least = kFromBoundary * edge_;
        const std::vector<double> ends = inside.row(x);
        for (size_t k = 0; k + 1 < ends.size(); k += 2)
            for (const double y : heights(x, ends[k], ends[k + 1], width(facet), shift))
                if (inside.squareToBoundary({y, x}, edge_, least) >= least * least &&
                    !domain_.size.atMost({x, y}, kOnLattice * domain_.size.edge()))
                    seeds_.points.emplace_back(x, y);
    }

    static constexpr double kBeside = 0.12; // of the edge length
    static constexpr double kSamePlace =
        1e-5; // of the extent: walls upright as scenes in single precision are
    static constexpr double kLeastStep = 0.3; // at the end of a row, of the others
    // Of the edge length: shorter steps of the boundary ask for short ones on folds; metres by metre.
    static constexpr double kFineStep = 0.7, kGrowth = 0.8;
    static constexpr double kWholeFacet = 0.9; // of its width: its floor and ceiling ask for nothing

    const PlanarDomain& domain_;
    double edge_;
    std::vector<glm::dvec2> turned_; // the boundary, x and y exchanged
    glm::dvec2 low_, high_;
    std::vector<double> places_; // of the folds and both ends
    std::vector<double> shifts_; // likewise
    SizeField fine_;             // beside short steps of the boundary
    LatticeSeeds seeds_;
};

} // namespace

ColumnSteps::ColumnSteps(double width, double edge, bool graded) {
    constexpr double kShortest = 0.8, kMost = 1.2; // of the edge length
    constexpr double kHalved = 0.727;   // width over step: halves of rectangles with angles of 36 degrees
    constexpr double kStaggered = 0.42; // the same of triangles by turns, with a little to spare
    constexpr double kFinest = 0.45;    // of the edge length: shorter steps take too many triangles
    const double share = width / edge;
    staggered = share < kAligned;
    step = edge * (staggered ? std::clamp(0.866 / share, 1.0, kMost) : std::clamp(1 / share, kShortest, 1.0));
    longest = width / (staggered ? kStaggered : kHalved);
    if (!graded || longest < kFinest * edge) longest = std::numeric_limits<double>::infinity();
}

double ColumnSteps::count(double length, double steps) const {
    return std::max({1.0, std::round(steps), std::ceil(length / longest - 0.05)});
}

LatticeSeeds latticeSeeds(const PlanarDomain& domain, double edge) {
    if (domain.folds.empty()) return {hexagonalSeeds(domain, edge), 0, {}};
    return FoldedLattice(domain, edge).seeds();
}

} // namespace heliodon::geometry
