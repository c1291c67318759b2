#include "compute/hemicube_refined.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "compute/hemicube.h"
#include "compute/link_maker.h"

namespace heliodon::compute {

namespace {

constexpr size_t kBlock = 64;
constexpr double kPairTolerance = 2e-3; // of one form factor: well below what pixels leave over a row

struct Patches {
    explicit Patches(const geometry::PatchMesh& mesh) {
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            area.push_back(geometry::patchArea(mesh, i));
            centre.push_back(geometry::patchCentroid(mesh, i));
        }
    }
    std::vector<double> area;
    std::vector<glm::dvec3> centre;
};

// Pairs i < j of one room, near to one another.
std::vector<glm::uvec2> nearPairs(const geometry::PatchMesh& mesh, const Patches& patches, double near) {
    std::vector<glm::uvec2> pairs;
    const auto n = static_cast<uint32_t>(mesh.patchCount());
    std::vector<double> size(n);
    for (uint32_t i = 0; i < n; ++i) size[i] = std::sqrt(patches.area[i]) / near;
    for (uint32_t i = 0; i < n; ++i)
        for (uint32_t j = i + 1; j < n; ++j) {
            const glm::dvec3 d = patches.centre[j] - patches.centre[i];
            const double reach = size[i] + size[j];
            if (glm::dot(d, d) < reach * reach && mesh.room[i] == mesh.room[j] && size[i] > 0 && size[j] > 0)
                pairs.push_back({i, j});
        }
    return pairs;
}

// What both ends' measurements of a pair disagree by, as a variance of the mean in rows i and j.
double disagreement(const float* F, const Patches& patches, size_t i, size_t j) {
    const size_t n = patches.area.size();
    const double a = patches.area[i], b = patches.area[j];
    if (!(a > 0 && b > 0)) return 0;
    const double d = 0.5 * (a * double{F[i * n + j]} - b * double{F[j * n + i]});
    return d * d * (1 / (a * a) + 1 / (b * b));
}

// A_i F_ij becomes the mean of both ends' measurements, the more of the end whose patch is small beside the
// distance: the error of one point falls with the square of its patch's size. Returns the sum of the
// variances of all entries.
double averageEnds(float* F, const Patches& patches) {
    const size_t n = patches.area.size();
    double variance = 0;
    for (size_t i0 = 0; i0 < n; i0 += kBlock)
        for (size_t j0 = i0; j0 < n; j0 += kBlock)
            for (size_t i = i0; i < std::min(n, i0 + kBlock); ++i)
                for (size_t j = std::max(j0, i + 1); j < std::min(n, j0 + kBlock); ++j) {
                    const double a = patches.area[i], b = patches.area[j];
                    if (!(a > 0 && b > 0)) continue;
                    variance += disagreement(F, patches, i, j);
                    float &ij = F[i * n + j], &ji = F[j * n + i];
                    const double w = b * b / (a * a + b * b);
                    const double exchange = w * a * double{ij} + (1 - w) * b * double{ji};
                    ij = static_cast<float>(exchange / a);
                    ji = static_cast<float>(exchange / b);
                }
    return variance;
}

void setNearPairs(gpu::Device& device, const geometry::PatchMesh& mesh, std::span<const glm::uvec2> pairs,
                  const Patches& patches, float* F) {
    const ClusterScene scene(device, mesh);
    const size_t n = mesh.patchCount();
    std::vector<std::vector<uint32_t>> leavesOf(n);
    for (const PatchTree::Leaf& leaf : scene.tree.leaves) leavesOf[leaf.patch].push_back(leaf.node);
    LinkMaker maker(device, scene, {kPairTolerance, kPairTolerance});
    for (const glm::uvec2& pair : pairs) {
        F[pair.x * n + pair.y] = F[pair.y * n + pair.x] = 0;
        for (uint32_t a : leavesOf[pair.x])
            for (uint32_t b : leavesOf[pair.y]) maker.add(std::min(a, b), std::max(a, b));
    }
    // Sorted: patches of several triangles sum several links in one order, whatever the device's.
    for (const io::HierarchicalLink& link : maker.finish()) {
        const PatchTree::Leaf &a = scene.tree.leaves[scene.tree.nodes[link.first].firstLeaf],
                              &b = scene.tree.leaves[scene.tree.nodes[link.second].firstLeaf];
        const double exchange = double{link.density} * a.area * b.area;
        F[a.patch * n + b.patch] += static_cast<float>(exchange / patches.area[a.patch]);
        F[b.patch * n + a.patch] += static_cast<float>(exchange / patches.area[b.patch]);
    }
}

} // namespace

FormFactors refinedHemicubeFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                                       const RefinedHemicubeOptions& options) {
    FormFactors result;
    const size_t n = mesh.patchCount();
    result.patchCount = static_cast<uint32_t>(n);
    const PatchViewpoints views = patchViewpoints(mesh, options.points);
    result.values =
        Hemicube(device, mesh, {options.resolution, 0}).run(views.viewpoints, views.pointsPerPatch).factors;
    result.report.kernel = "hemicube";
    result.report.resolution = options.resolution;
    result.report.points = views.pointsPerPatch;
    const Patches patches(mesh);
    const std::vector<glm::uvec2> pairs = nearPairs(mesh, patches, options.near);
    std::vector<float> copy;
    float* F = result.values.mapped<float>();
    if (!F) {
        copy = result.values.download<float>(n * n);
        F = copy.data();
    }
    double near = 0;
    for (const glm::uvec2& pair : pairs) near += disagreement(F, patches, pair.x, pair.y);
    const double variance = averageEnds(F, patches) - near;
    result.report.claimedRowError =
        std::sqrt(std::max(0.0, variance) / static_cast<double>(std::max<size_t>(n, 1)));
    setNearPairs(device, mesh, pairs, patches, F);
    if (!copy.empty()) result.values.upload(copy);
    result.report.why = fmt::format("{} near pairs in closed form, the others from both ends", pairs.size());
    return result;
}

} // namespace heliodon::compute
