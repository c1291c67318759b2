#include "compute/hemicube_refined.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "compute/hemicube.h"
#include "compute/link_maker.h"
#include "compute/parallel.h"

namespace heliodon::compute {

namespace {

constexpr size_t kBlock = 64;
constexpr size_t kStripes = 16; // of rows of blocks: their sums are added in one order on any number of cores
constexpr double kOfSpread = 4.5; // area of a triangle of half a square over its spread
constexpr double kCaution = 1.2; // of the claim, over both ends' disagreement and what links claim (measured)
constexpr double kWorthPoints = 0.015; // of a row's sum, in error, from which it gets more points
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
    explicit Patches(const geometry::PatchMesh& mesh) {
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            area.push_back(geometry::patchArea(mesh, i));
            centre.push_back(geometry::patchCentroid(mesh, i));
            extent.push_back(std::max(area[i], kOfSpread * spreadOf(mesh, i, centre[i])));
            perArea.push_back(area[i] > 0 ? 1 / area[i] : 0);
            normal.push_back(geometry::patchNormal(mesh, i));
        }
        share = area;
    }
    size_t count() const { return area.size(); }

    std::vector<double> area, perArea; // its inverse, 0 of none
    std::vector<glm::dvec3> centre, normal;
    std::vector<double> share;  // of the area, that one point stands for
    std::vector<double> extent; // the area, or more where a patch is long
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
    // What both disagree by, as a variance of the mean in rows i and j: as if both erred alike, until one is
    // so much better that eight times its part in both is less.
    double variance() const {
        const double d = std::min(0.5, 8 * geometric) * std::abs(ofI - ofJ),
                     inI = std::min(d * inverseI, 1.0), inJ = std::min(d * inverseJ, 1.0);
        return inI * inI + inJ * inJ;
    }

    double inverseI, inverseJ; // areas
    double ofI, ofJ;
    double weight; // of i's measurement: the error of one point falls with the square of what it stands for
    double geometric; // mean of both weights
};

// Both measurements of the pairs i < j of two blocks of patches, in one order; 0 where there is no such pair.
struct Block {
    Block(const float* F, size_t n, size_t i0, size_t j0)
        : firstI(i0), firstJ(j0), rows(std::min(kBlock, n - i0)), columns(std::min(kBlock, n - j0)) {
        for (size_t i = 0; i < rows; ++i) std::copy_n(F + (i0 + i) * n + j0, columns, ij[i]);
        for (size_t j = 0; j < columns; ++j)
            for (size_t i = 0; i < rows; ++i) ji[i][j] = F[(j0 + j) * n + i0 + i];
        if (i0 == j0)
            for (size_t i = 0; i < rows; ++i)
                std::fill_n(ij[i], i + 1, 0.0f), std::fill_n(ji[i], i + 1, 0.0f);
    }
    void store(float* F, size_t n) const {
        const bool diagonal = firstI == firstJ;
        for (size_t i = 0; i < rows; ++i) {
            const size_t first = diagonal ? i + 1 : 0;
            std::copy(ij[i] + first, ij[i] + columns, F + (firstI + i) * n + firstJ + first);
        }
        for (size_t j = 0; j < columns; ++j)
            for (size_t i = 0; i < (diagonal ? j : rows); ++i) F[(firstJ + j) * n + firstI + i] = ji[i][j];
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
std::vector<glm::uvec2> nearPairs(const geometry::PatchMesh& mesh, const Patches& patches, double near) {
    std::vector<glm::uvec2> pairs;
    const auto n = static_cast<uint32_t>(mesh.patchCount());
    std::vector<double> size(n);
    for (uint32_t i = 0; i < n; ++i) size[i] = std::sqrt(patches.extent[i]) / near;
    for (uint32_t i = 0; i < n; ++i)
        for (uint32_t j = i + 1; j < n; ++j) {
            const glm::dvec3 d = patches.centre[j] - patches.centre[i];
            const double reach = size[i] + size[j];
            if (glm::dot(d, d) < reach * reach && mesh.room[i] == mesh.room[j] && size[i] > 0 && size[j] > 0)
                pairs.push_back({i, j});
        }
    return pairs;
}

// Per row, sums over pairs of what its own measurement of an exchange has above the other end's: whole, and
// by the weight of its own.
struct RowSums {
    explicit RowSums(size_t n) : whole(n, 0.0), weighted(n, 0.0) {}
    void add(const Block& block, const Patches& patches) {
        for (size_t i = 0; i < block.rows; ++i) {
            double above[kBlock], own[kBlock];
            for (size_t j = 0; j < block.columns; ++j) {
                const BothEnds ends(patches, block.firstI + i, block.firstJ + j, block.ij[i][j],
                                    block.ji[i][j]);
                above[j] = ends.ofI - ends.ofJ;
                own[j] = ends.weight * above[j];
            }
            add(block.firstI + i, block.firstJ, {above, block.columns}, {own, block.columns});
        }
    }
    // Of the pairs of i and j0, j0 + 1, ...
    void add(size_t i, size_t j0, std::span<const double> above, std::span<const double> own) {
        for (size_t j = 0; j < above.size(); ++j) {
            whole[j0 + j] -= above[j];
            weighted[j0 + j] += own[j] - above[j];
        }
        whole[i] += sumOf(above);
        weighted[i] += sumOf(own);
    }
    std::vector<double> whole, weighted;
};

// Per row, what its sum may be off by once both ends are averaged: the difference between what its own few
// points and what those of the others, which are many and see all of the patch, make of their exchange, times
// the weight of the worse end. Far pairs only.
std::vector<double> sumErrors(const float* F, const Patches& patches, std::span<const glm::uvec2> nearPairs) {
    const size_t n = patches.count();
    std::vector<RowSums> stripes(kStripes, RowSums(n));
    forBlocks(F, n, [&](size_t stripe, const Block& block) { stripes[stripe].add(block, patches); });
    RowSums near(n);
    for (const glm::uvec2& pair : nearPairs) {
        const BothEnds ends(patches, pair.x, pair.y, F[pair.x * n + pair.y], F[pair.y * n + pair.x]);
        const double above = ends.ofI - ends.ofJ, own = ends.weight * above;
        near.add(pair.x, pair.y, {&above, 1}, {&own, 1});
    }
    std::vector<double> errors(n);
    for (size_t i = 0; i < n; ++i) {
        double whole = -near.whole[i], weighted = -near.weighted[i];
        for (const RowSums& sums : stripes) whole += sums.whole[i], weighted += sums.weighted[i];
        errors[i] =
            std::min(std::max(std::abs(weighted), std::abs(whole - weighted)) * patches.perArea[i], 1.0);
    }
    return errors;
}

// A_i F_ij becomes the mean of both ends' measurements. Returns the sum of the variances of all entries.
double averageEnds(float* F, const Patches& patches) {
    const size_t n = patches.count();
    std::vector<double> variances(kStripes, 0.0);
    forBlocks(F, n, [&](size_t stripe, Block& block) {
        for (size_t i = 0; i < block.rows; ++i) {
            double variance[kBlock];
            for (size_t j = 0; j < block.columns; ++j) {
                const BothEnds ends(patches, block.firstI + i, block.firstJ + j, block.ij[i][j],
                                    block.ji[i][j]);
                variance[j] = ends.variance();
                const double exchange = ends.exchange();
                const bool both = ends.inverseI > 0 && ends.inverseJ > 0; // have an area
                block.ij[i][j] = both ? static_cast<float>(exchange * ends.inverseI) : block.ij[i][j];
                block.ji[i][j] = both ? static_cast<float>(exchange * ends.inverseJ) : block.ji[i][j];
            }
            variances[stripe] += sumOf({variance, block.columns});
        }
        block.store(F, n);
    });
    return sumOf(variances);
}

// What a pair that neither end has in a pixel would exchange if nothing stood between them; 0 where they do
// not face.
double unseenExchange(const Patches& patches, size_t i, size_t j) {
    const glm::dvec3 d = patches.centre[j] - patches.centre[i];
    const double ci = glm::dot(d, patches.normal[i]), cj = -glm::dot(d, patches.normal[j]),
                 d2 = glm::dot(d, d);
    return ci > 0 && cj > 0 ? ci * cj / (std::numbers::pi * d2 * d2) * patches.area[i] * patches.area[j] : 0;
}

// Variance of what may have fallen between the pixels of both ends. Of many such pairs some are hit, and what
// those ends disagree by tells of all; few may be missed altogether, by one pixel's worth.
double missed(const float* F, const geometry::PatchMesh& mesh, const Patches& patches, double pixel) {
    const size_t n = patches.area.size();
    double variance = 0;
    for (size_t i = 0; i < n && variance <= pixel * pixel; ++i)
        for (size_t j = i + 1; j < n; ++j) {
            // Both ends are averaged: neither has what the other has not.
            if (F[i * n + j] > 0 || mesh.room[i] != mesh.room[j]) continue;
            const double a = patches.area[i], b = patches.area[j];
            if (!(a > 0 && b > 0)) continue;
            const double exchange = unseenExchange(patches, i, j);
            if (exchange > pixel * std::min(a, b))
                continue; // one of its ends would have it in a pixel: hidden
            variance += exchange * exchange * (1 / (a * a) + 1 / (b * b));
        }
    return std::min(variance, pixel * pixel);
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

// Returns the sum of the variances of their entries, by what the links claim.
double setNearPairs(gpu::Device& device, const geometry::PatchMesh& mesh, std::span<const glm::uvec2> pairs,
                    double tolerance, const Patches& patches, float* F) {
    const ClusterScene scene(device, mesh);
    const size_t n = mesh.patchCount();
    std::vector<std::vector<uint32_t>> leavesOf(n);
    for (const PatchTree::Leaf& leaf : scene.tree.leaves) leavesOf[leaf.patch].push_back(leaf.node);
    LinkMaker maker(device, scene, {tolerance, tolerance});
    for (const glm::uvec2& pair : pairs) {
        F[pair.x * n + pair.y] = F[pair.y * n + pair.x] = 0;
        for (uint32_t a : leavesOf[pair.x])
            for (uint32_t b : leavesOf[pair.y]) maker.add(std::min(a, b), std::max(a, b));
    }
    double variance = 0;
    // Sorted: patches of several triangles sum several links in one order, whatever the device's.
    for (const io::HierarchicalLink& link : maker.finish()) {
        const PatchTree::Leaf &a = scene.tree.leaves[scene.tree.nodes[link.first].firstLeaf],
                              &b = scene.tree.leaves[scene.tree.nodes[link.second].firstLeaf];
        const double exchange = double{link.density} * a.area * b.area,
                     error = double{link.error} * a.area * b.area, areaA = patches.area[a.patch],
                     areaB = patches.area[b.patch];
        F[a.patch * n + b.patch] += static_cast<float>(exchange / areaA);
        F[b.patch * n + a.patch] += static_cast<float>(exchange / areaB);
        // No form factor is off by more than one, whatever an estimate makes of tiny patches before large
        // ones.
        const double inA = std::min(error / areaA, 1.0), inB = std::min(error / areaB, 1.0);
        variance += inA * inA + inB * inB;
    }
    return variance;
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
    Patches patches(mesh);
    const std::vector<glm::uvec2> pairs = nearPairs(mesh, patches, options.near);
    std::vector<float> copy;
    float* F = result.values.mapped<float>();
    if (!F) {
        copy = result.values.download<float>(n * n);
        F = copy.data();
    }
    std::vector<double> errors = sumErrors(F, patches, pairs);
    const size_t rows = addPoints(hemicube, mesh, errors, views.pointsPerPatch, patches, F);
    if (rows > 0) errors = sumErrors(F, patches, pairs);
    if (n > 0) result.report.claimedRowSumError = *std::max_element(errors.begin(), errors.end());
    double near = 0;
    for (const glm::uvec2& pair : pairs)
        near += BothEnds(patches, pair.x, pair.y, F[pair.x * n + pair.y], F[pair.y * n + pair.x]).variance();
    double far = std::max(0.0, averageEnds(F, patches) - near);
    const double side = 2.0 / hemicube.resolution(); // of a pixel of the top face, seen from one away
    far += missed(F, mesh, patches, side * side / std::numbers::pi);
    near = setNearPairs(device, mesh, pairs, options.pairTolerance, patches, F);
    const auto claim = [n](double variance) {
        return kCaution * std::sqrt(variance / static_cast<double>(std::max<size_t>(n, 1)));
    };
    refined.nearError = claim(near), refined.farError = claim(far);
    result.report.claimedRowError = claim(near + far);
    if (!copy.empty()) result.values.upload(copy);
    result.report.why = fmt::format(
        "{} near pairs in closed form, the others from both ends, {} rows from {} times the points",
        pairs.size(), rows, kMorePoints);
    return refined;
}

} // namespace heliodon::compute
