#include "compute/hemicube_refined.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "compute/chi_squared.h"
#include "compute/hemicube.h"
#include "compute/link_claims.h"
#include "compute/link_maker.h"
#include "compute/parallel.h"

namespace heliodon::compute {

namespace {

constexpr size_t kBlock = 64;
constexpr size_t kStripes = 16; // of rows of blocks: their sums are added in one order on any number of cores
constexpr double kOfSpread = 4.5; // area of a triangle of half a square over its spread
// Of the claim, over what samples say and over what links do: rays find too little that a light slot is there
// at all (measured; in rooms of many patches near pairs count for little).
constexpr double kCaution = 1.2, kNearCaution = 2.2;
constexpr double kPercentile = 2.326;     // standard deviations up to the 99th
constexpr double kSample = 1000;          // far pairs, about, that links measure again
constexpr double kSampleTolerance = 0.05; // of what the largest of those alike exchange in the open
constexpr double kLeastSize = 1e-6;       // of form factors that are told apart there
constexpr double kUnseen = 0.25;          // of its square, that what lies open counts with among what is seen
constexpr double kWorthPoints = 0.015;    // of a row's sum, in error, from which it gets more points
constexpr uint32_t kMorePoints = 4;
constexpr double kMostAdded = 0.15; // viewpoints, over those of all patches

// Mean square of the distance from the centroid, which the error of one point grows with where the kernel is
// smooth.
double spreadOf(const geometry::PatchMesh& mesh, size_t patch, glm::dvec3 centre) {
    const auto corners = mesh.patch(patch);
    const auto from = [&](size_t k) { return mesh.vertices[corners[k]] - centre; };
    const glm::dvec3 normal = geometry::patchNormal(mesh, patch);
    double area = 0, moment = 0;
    for (size_t k = 0; k < corners.size(); ++k) {
        // Triangles with the centroid as apex; signed, for polygons that are not convex.
        const glm::dvec3 a = from(k), b = from((k + 1) % corners.size());
        const double twice = glm::dot(glm::cross(a, b), normal);
        area += twice;
        moment += twice * (glm::dot(a, a) + glm::dot(b, b) + glm::dot(a, b)) / 6;
    }
    return area > 0 ? moment / area : 0;
}

struct Patches {
    Patches(const geometry::PatchMesh& mesh, double near) : room(mesh.room) {
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            area.push_back(geometry::patchArea(mesh, i));
            centre.push_back(geometry::patchCentroid(mesh, i));
            reach.push_back(std::sqrt(std::max(area[i], kOfSpread * spreadOf(mesh, i, centre[i]))) / near);
            perArea.push_back(area[i] > 0 ? 1 / area[i] : 0);
            normal.push_back(geometry::patchNormal(mesh, i));
        }
        share = area;
    }
    size_t count() const { return area.size(); }
    bool isNear(size_t i, size_t j, double distanceSquared) const {
        return distanceSquared < (reach[i] + reach[j]) * (reach[i] + reach[j]);
    }
    // An exchange's square as form factors in rows i and j, which are at most one.
    double squareInRows(size_t i, size_t j, double exchange) const {
        const double inI = std::min(std::abs(exchange) * perArea[i], 1.0),
                     inJ = std::min(std::abs(exchange) * perArea[j], 1.0);
        return inI * inI + inJ * inJ;
    }

    std::vector<double> area, perArea; // its inverse, 0 of none
    std::vector<glm::dvec3> centre, normal;
    std::vector<double> share; // of the area, that one point stands for
    std::vector<double> reach; // as far as which it is near to a point; farther where it is long
    std::vector<uint32_t> room;
};

// What both ends of a pair measured of one exchange.
struct BothEnds {
    BothEnds(const Patches& patches, size_t i, size_t j, float ij, float ji)
        : inverseI(patches.perArea[i]), inverseJ(patches.perArea[j]), ofI(patches.area[i] * double{ij}),
          ofJ(patches.area[j] * double{ji}) {
        const double a = patches.share[i] * patches.share[i], b = patches.share[j] * patches.share[j],
                     inverse = 1 / (a + b + 1e-300); // patches may have no area
        weight = b * inverse;
        geometric = patches.share[i] * patches.share[j] * inverse;
    }

    double exchange() const { return weight * ofI + (1 - weight) * ofJ; }

    double inverseI, inverseJ; // areas
    double ofI, ofJ;
    double weight; // of i's measurement: the error of one point falls with the square of what it stands for
    double geometric; // mean of both weights
};

// Both measurements of the pairs i < j of two blocks of patches, in one order.
struct Block {
    Block(const float* F, size_t n, size_t i0, size_t j0)
        : firstI(i0), firstJ(j0), rows(std::min(kBlock, n - i0)), columns(std::min(kBlock, n - j0)) {
        for (size_t i = 0; i < rows; ++i) std::copy_n(F + (i0 + i) * n + j0, columns, ij[i]);
        for (size_t j = 0; j < columns; ++j)
            for (size_t i = 0; i < rows; ++i) ji[i][j] = F[(j0 + j) * n + i0 + i];
    }
    size_t first(size_t i) const { return firstI == firstJ ? i + 1 : 0; } // its first j > i
    void store(float* F, size_t n) const {
        for (size_t i = 0; i < rows && first(i) < columns; ++i)
            std::copy(ij[i] + first(i), ij[i] + columns, F + (firstI + i) * n + firstJ + first(i));
        for (size_t j = 0; j < columns; ++j)
            for (size_t i = 0; i < rows && first(i) <= j; ++i) F[(firstJ + j) * n + firstI + i] = ji[i][j];
    }
    size_t firstI, firstJ, rows, columns;
    float ij[kBlock][kBlock], ji[kBlock][kBlock]; // [i][j]
};

// In four sums, since each addition waits for the last.
double sumOf(std::span<const double> values) {
    double part[4]{};
    size_t k = 0;
    for (; k + 4 <= values.size(); k += 4)
        for (size_t l = 0; l < 4; ++l) part[l] += values[k + l];
    for (; k < values.size(); ++k) part[0] += values[k];
    return part[0] + part[1] + part[2] + part[3];
}

// Calls take(stripe, block) for blocks that hold all pairs, stripes on all cores.
template<class Take> void forBlocks(const float* F, size_t n, const Take& take) {
    inParallel(kStripes, [&](size_t stripe) {
        for (size_t i0 = stripe * kBlock; i0 < n; i0 += kStripes * kBlock)
            for (size_t j0 = i0; j0 < n; j0 += kBlock) {
                Block block(F, n, i0, j0);
                take(stripe, block);
            }
    });
}

// Pairs i < j of one room, near to one another.
std::vector<glm::uvec2> nearPairs(const Patches& patches) {
    std::vector<glm::uvec2> pairs;
    const auto n = static_cast<uint32_t>(patches.count());
    for (uint32_t i = 0; i < n; ++i)
        for (uint32_t j = i + 1; j < n; ++j) {
            const glm::dvec3 d = patches.centre[j] - patches.centre[i];
            if (patches.isNear(i, j, glm::dot(d, d)) && patches.room[i] == patches.room[j] &&
                patches.reach[i] > 0 && patches.reach[j] > 0)
                pairs.push_back({i, j});
        }
    return pairs;
}

// What a far pair would exchange, about, if nothing stood between; 0 where its middles do not face.
double openExchange(const Patches& patches, size_t i, size_t j) {
    const glm::dvec3 d = patches.centre[j] - patches.centre[i];
    const double ci = glm::dot(d, patches.normal[i]), cj = -glm::dot(d, patches.normal[j]),
                 d2 = glm::dot(d, d);
    return ci > 0 && cj > 0 && patches.room[i] == patches.room[j] && !patches.isNear(i, j, d2)
               ? ci * cj / (std::numbers::pi * d2 * d2) * patches.area[i] * patches.area[j]
               : 0;
}

// By what a pair may err, as squares in its two rows: what both ends disagree by, and what it exchanges.
struct Weight {
    double disagreement = 0, exchange = 0;
};
Weight weightOf(const Patches& patches, const BothEnds& ends, size_t i, size_t j) {
    return {patches.squareInRows(i, j, ends.geometric * (ends.ofI - ends.ofJ)),
            patches.squareInRows(i, j, ends.exchange())};
}

// Per row, sums over pairs of what its own measurement of an exchange has above the other end's: whole, and
// by the weight of its own. Over all pairs, weights.
struct RowSums {
    explicit RowSums(size_t n) : whole(n, 0.0), weighted(n, 0.0) {}
    template<bool weigh> void add(const Block& block, const Patches& patches) {
        for (size_t i = 0; i < block.rows; ++i) {
            double above[kBlock]{}, own[kBlock]{}, disagreement[kBlock]{}, exchange[kBlock]{};
            for (size_t j = block.first(i); j < block.columns; ++j) {
                const BothEnds ends(patches, block.firstI + i, block.firstJ + j, block.ij[i][j],
                                    block.ji[i][j]);
                above[j] = ends.ofI - ends.ofJ;
                own[j] = ends.weight * above[j];
                if constexpr (weigh) {
                    const Weight weight = weightOf(patches, ends, block.firstI + i, block.firstJ + j);
                    disagreement[j] = weight.disagreement, exchange[j] = weight.exchange;
                }
            }
            for (size_t j = 0; j < block.columns; ++j) {
                whole[block.firstJ + j] -= above[j];
                weighted[block.firstJ + j] += own[j] - above[j];
            }
            whole[block.firstI + i] += sumOf({above, block.columns});
            weighted[block.firstI + i] += sumOf({own, block.columns});
            if constexpr (weigh) {
                weights.disagreement += sumOf({disagreement, block.columns});
                weights.exchange += sumOf({exchange, block.columns});
            }
        }
    }
    std::vector<double> whole, weighted;
    Weight weights;
};

struct FarPairs {
    // Per row, what its sum may be off by once both ends are averaged: the difference between what its own
    // few points and what those of the others, which are many and see all of the patch, make of their
    // exchange, times the weight of the worse end.
    std::vector<double> errors;
    Weight weights; // sums
};

template<bool weigh> FarPairs compareEnds(const float* F, const Patches& patches) {
    const size_t n = patches.count();
    std::vector<RowSums> stripes(kStripes, RowSums(n));
    forBlocks(F, n, [&](size_t stripe, const Block& block) { stripes[stripe].add<weigh>(block, patches); });
    FarPairs result;
    for (const RowSums& sums : stripes) {
        result.weights.disagreement += sums.weights.disagreement;
        result.weights.exchange += sums.weights.exchange;
    }
    for (size_t i = 0; i < n; ++i) {
        double whole = 0, weighted = 0;
        for (const RowSums& sums : stripes) whole += sums.whole[i], weighted += sums.weighted[i];
        result.errors.push_back(
            std::min(std::max(std::abs(weighted), std::abs(whole - weighted)) * patches.perArea[i], 1.0));
    }
    return result;
}

// A far pair that is measured once more, and how likely that was.
struct Sample {
    uint32_t i, j;
    double probability;
    double size; // form factor from the lesser to the larger
    double exchange = 0, measured = 0;
};

// Between 0 and 1, evenly.
double chanceOf(size_t i, size_t j) {
    auto x = static_cast<uint32_t>(i * 0x9e3779b1u) ^ static_cast<uint32_t>(j * 0x85ebca77u);
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return (x ^ (x >> 16)) * 0x1p-32;
}

// A_i F_ij becomes the mean of both ends' measurements. Returns a sample of the pairs: each by its weights,
// or all where they are few. What both ends do not see counts by what it would exchange in the open, as far
// as no more of it is taken than of the others.
std::vector<Sample> averageEnds(float* F, const Patches& patches, const Weight& weights) {
    const size_t n = patches.count();
    const double ofDisagreement = 0.5 * kSample / std::max(weights.disagreement, 1e-300),
                 ofExchange = 0.5 * kSample / std::max(weights.exchange, 1e-300),
                 mostUnseen = std::min(2 * kSample / (static_cast<double>(n) * static_cast<double>(n)), 1.0);
    std::vector<std::vector<Sample>> samples(kStripes);
    forBlocks(F, n, [&](size_t stripe, Block& block) {
        for (size_t i = 0; i < block.rows; ++i) {
            double above[kBlock], probability[kBlock];
            for (size_t j = block.first(i); j < block.columns; ++j) {
                const size_t row = block.firstI + i, column = block.firstJ + j;
                const BothEnds ends(patches, row, column, block.ij[i][j], block.ji[i][j]);
                const Weight weight = weightOf(patches, ends, row, column);
                probability[j] = ofDisagreement * weight.disagreement + ofExchange * weight.exchange;
                above[j] = probability[j] + mostUnseen - chanceOf(row, column);
                const double exchange = ends.exchange();
                const bool both = ends.inverseI > 0 && ends.inverseJ > 0; // have an area
                block.ij[i][j] = both ? static_cast<float>(exchange * ends.inverseI) : block.ij[i][j];
                block.ji[i][j] = both ? static_cast<float>(exchange * ends.inverseJ) : block.ji[i][j];
            }
            for (size_t j = block.first(i); j < block.columns; ++j) {
                if (above[j] <= 0) continue;
                const auto row = static_cast<uint32_t>(block.firstI + i),
                           column = static_cast<uint32_t>(block.firstJ + j);
                const double exchange = patches.area[row] * double{block.ij[i][j]},
                             open = openExchange(patches, row, column),
                             unseen = kUnseen * ofExchange * patches.squareInRows(row, column, open);
                if (above[j] - mostUnseen + std::min(unseen, mostUnseen) <= 0) continue;
                samples[stripe].push_back(
                    {row, column, std::min(probability[j] + std::min(unseen, mostUnseen), 1.0),
                     std::max(exchange, open) * std::max(patches.perArea[row], patches.perArea[column]),
                     exchange});
            }
        }
        block.store(F, n);
    });
    std::vector<Sample> all;
    for (const std::vector<Sample>& some : samples) all.insert(all.end(), some.begin(), some.end());
    return all;
}

// Rows whose points see what the others do not see of them, beside the edges of blockers: again from more
// points. Returns how many.
size_t addPoints(Hemicube& hemicube, const geometry::PatchMesh& mesh, std::span<const double> errors,
                 uint32_t points, Patches& patches, float* F) {
    const size_t n = patches.area.size();
    std::vector<uint32_t> rows;
    for (uint32_t i = 0; i < n; ++i)
        // Polygons of more corners have no even pattern of so few points.
        if (errors[i] > kWorthPoints && mesh.patch(i).size() <= 4) rows.push_back(i);
    const auto most = static_cast<size_t>(std::ceil(kMostAdded * static_cast<double>(n) / kMorePoints));
    std::stable_sort(rows.begin(), rows.end(), [&](uint32_t a, uint32_t b) { return errors[a] > errors[b]; });
    rows.resize(std::min(rows.size(), most));
    if (rows.empty()) return 0;
    std::vector<Viewpoint> viewpoints;
    uint32_t each = 1;
    for (uint32_t i : rows) {
        const PatchViewpoints views = patchViewpoints(mesh, kMorePoints * points, i, 1);
        each = views.pointsPerPatch;
        viewpoints.insert(viewpoints.end(), views.viewpoints.begin(), views.viewpoints.end());
    }
    const std::vector<float> seen = hemicube.run(viewpoints, each).factors.download<float>(rows.size() * n);
    for (size_t k = 0; k < rows.size(); ++k) {
        std::copy_n(seen.begin() + static_cast<std::ptrdiff_t>(k * n), n, F + rows[k] * n);
        patches.share[rows[k]] = patches.area[rows[k]] * points / each;
    }
    return rows.size();
}

// Of a pair of patches, in either order.
uint64_t keyOf(uint32_t i, uint32_t j) {
    return uint64_t{std::min(i, j)} << 32 | std::max(i, j);
}

// Pairs of patches by links between their triangles.
class PairLinks {
public:
    PairLinks(gpu::Device& device, const geometry::PatchMesh& mesh)
        : scene_(device, mesh), maker_(device, scene_, {}), leavesOf_(mesh.patchCount()) {
        for (const PatchTree::Leaf& leaf : scene_.tree.leaves) leavesOf_[leaf.patch].push_back(leaf.node);
    }
    void setTolerance(double tolerance) { maker_.setTolerance({tolerance, tolerance}); } // from now on
    void add(uint32_t i, uint32_t j) {
        for (uint32_t a : leavesOf_[i])
            for (uint32_t b : leavesOf_[j]) maker_.add(std::min(a, b), std::max(a, b));
    }
    // Calls take(i, j, exchange, its standard error, what was taken off) for what was added, once a pair of
    // triangles, in one order. What rays that agreed have missed is taken off, of all by one factor.
    template<class Take> void finish(const Patches& patches, const Take& take) {
        std::vector<io::HierarchicalLink> links = maker_.finish(), all = links;
        LinkClaims(scene_.tree, patches.area, all).takeUnseen(links);
        for (size_t k = 0; k < links.size(); ++k) {
            const io::HierarchicalLink& link = links[k];
            const PatchTree::Leaf &a = scene_.tree.leaves[scene_.tree.nodes[link.first].firstLeaf],
                                  &b = scene_.tree.leaves[scene_.tree.nodes[link.second].firstLeaf];
            const double taken = double{all[k].density} - double{link.density};
            take(a.patch, b.patch, double{link.density} * a.area * b.area,
                 double{link.error} * a.area * b.area, taken * a.area * b.area);
        }
    }

private:
    ClusterScene scene_;
    LinkMaker maker_;
    std::vector<std::vector<uint32_t>> leavesOf_; // per patch
};

// By what an exchange may err: its triangles' parts each by itself, but all alike by what was taken off.
struct ExchangeError {
    uint32_t i, j;
    double square = 0, taken = 0;
};

// Returns the 99th percentile of the sum of the squares of their entries' errors, by what the links claim.
double setNearPairs(PairLinks& links, std::span<const glm::uvec2> pairs, double tolerance,
                    const Patches& patches, float* F) {
    const size_t n = patches.count();
    links.setTolerance(tolerance);
    for (const glm::uvec2& pair : pairs) links.add(pair.x, pair.y);
    std::vector<ExchangeError> errors;
    std::unordered_map<uint64_t, size_t> at; // of these, by pair of patches
    links.finish(patches, [&](uint32_t i, uint32_t j, double exchange, double error, double taken) {
        F[i * n + j] += static_cast<float>(exchange * patches.perArea[i]);
        F[j * n + i] += static_cast<float>(exchange * patches.perArea[j]);
        const auto [found, isNew] = at.try_emplace(keyOf(i, j), errors.size());
        if (isNew) errors.push_back({i, j});
        errors[found->second].square += error * error;
        errors[found->second].taken += taken;
    });
    double sum = 0, squares = 0;
    for (const ExchangeError& e : errors) {
        // No form factor is off by more than one, whatever an estimate makes of tiny patches before large
        // ones.
        const double variance = patches.squareInRows(e.i, e.j, std::sqrt(e.square) + e.taken);
        sum += variance;
        squares += variance * variance;
    }
    return sum > 0 ? sum * chiSquaredOverMean(chiSquaredSpread(sum, squares), kPercentile) : 0;
}

// Returns the 99th percentile of the sum over all far pairs of their entries' squared errors, by those of the
// sample (D. Horvitz, D. Thompson, 1952). What both ends disagree by would not tell it: of what stands
// half-way between two patches, both their points see as much, and both wrong alike.
double sampledError(PairLinks& links, std::span<Sample> samples, const Patches& patches) {
    std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
        return a.size != b.size ? a.size > b.size : std::pair(a.i, a.j) < std::pair(b.i, b.j);
    });
    // The noise of few does not average out: as many rays for all of them, however many.
    const double tolerance =
        kSampleTolerance * std::sqrt(std::min(1.0, static_cast<double>(samples.size()) / kSample));
    for (size_t first = 0; first < samples.size();) {
        // Alike in size, to have one tolerance.
        size_t end = first;
        std::unordered_map<uint64_t, Sample*> at;
        const double least = std::max(samples[first].size / 2, kLeastSize);
        links.setTolerance(tolerance * 2 * least);
        for (; end < samples.size() && (samples[end].size >= least || least == kLeastSize); ++end) {
            Sample& s = samples[end];
            at[keyOf(s.i, s.j)] = &s;
            links.add(s.i, s.j);
        }
        links.finish(patches, [&](uint32_t i, uint32_t j, double exchange, double, double) {
            at.at(keyOf(i, j))->measured += exchange;
        });
        first = end;
    }
    double sum = 0, variance = 0;
    for (const Sample& s : samples) {
        const double square = patches.squareInRows(s.i, s.j, s.measured - s.exchange) / s.probability;
        sum += square;
        variance += square * square * (1 - s.probability);
    }
    return sum + kPercentile * std::sqrt(variance);
}

} // namespace

RefinedHemicube refinedHemicubeFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                                           const RefinedHemicubeOptions& options) {
    RefinedHemicube refined;
    FormFactors& result = refined.factors;
    const size_t n = mesh.patchCount();
    result.patchCount = static_cast<uint32_t>(n);
    const PatchViewpoints views = patchViewpoints(mesh, options.points);
    Hemicube hemicube(device, mesh, {options.resolution});
    result.values = hemicube.run(views.viewpoints, views.pointsPerPatch).factors;
    result.report.resolution = hemicube.resolution();
    result.report.points = views.pointsPerPatch;
    Patches patches(mesh, options.near);
    const std::vector<glm::uvec2> pairs = nearPairs(patches);
    std::vector<float> copy;
    float* F = result.values.mapped<float>();
    if (!F) {
        copy = result.values.download<float>(n * n);
        F = copy.data();
    }
    const auto leaveOutNear = [&] {
        for (const glm::uvec2& pair : pairs) F[pair.x * n + pair.y] = F[pair.y * n + pair.x] = 0;
    };
    leaveOutNear();
    FarPairs far = compareEnds<true>(F, patches);
    const size_t rows = addPoints(hemicube, mesh, far.errors, views.pointsPerPatch, patches, F);
    if (rows > 0) {
        leaveOutNear();
        far.errors = compareEnds<false>(F, patches).errors; // few rows change little of the weights
    }
    double near = 0, rest = 0;
    if (n > 0) {
        result.report.claimedRowSumError = *std::max_element(far.errors.begin(), far.errors.end());
        std::vector<Sample> samples = averageEnds(F, patches, far.weights);
        PairLinks links(device, mesh);
        near = setNearPairs(links, pairs, options.pairTolerance, patches, F);
        rest = sampledError(links, samples, patches);
    }
    const auto claim = [n](double caution, double variance) {
        return caution * std::sqrt(variance / static_cast<double>(std::max<size_t>(n, 1)));
    };
    refined.nearError = claim(kNearCaution, near), refined.farError = claim(kCaution, rest);
    result.report.claimedRowError = std::hypot(refined.nearError, refined.farError);
    if (!copy.empty()) result.values.upload(copy);
    result.report.why = fmt::format(
        "{} near pairs in closed form, the others from both ends, {} rows from {} times the points",
        pairs.size(), rows, kMorePoints);
    return refined;
}

} // namespace heliodon::compute
