#include "compute/slat_lobes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

#include "compute/parallel.h"
#include "compute/patch_points.h"
#include "compute/view_cells.h"

namespace heliodon::compute {

using daylight::BetweenNodes, daylight::kSlatNodes, glm::dvec3;

namespace {

// Distance over the larger patch's size from which one direction stands for all.
constexpr double kFarPair = 6;
constexpr double kSeenAngle = 0.1;   // radians, of one piece of a window that a point sees
constexpr uint32_t kPoints = 4;      // on each of two near patches
constexpr double kMostCorrected = 2; // times, or to one over it, that a node's shares are put right

// Shares of the exchange of two patches by the nodes of light that leaves a window.
class PairShares {
public:
    PairShares(const geometry::PatchMesh& mesh, std::span<const PointScene::Patch> patches)
        : patches_(patches), views_(patchViewpoints(mesh, kPoints)) {}

    std::array<double, kSlatNodes> of(size_t patch, size_t window) const {
        std::array<double, kSlatNodes> shares{};
        const PointScene::Patch &to = patches_[patch], &from = patches_[window];
        const dvec3 way = to.centre - from.centre;
        if (glm::length(way) > kFarPair * std::max(to.size, from.size)) {
            add(way, from.normal, 1, shares);
            return shares;
        }
        double all = 0;
        for (size_t a = 0; a < views_.pointsPerPatch; ++a)
            for (size_t b = 0; b < views_.pointsPerPatch; ++b) {
                const dvec3 d = views_.viewpoints[patch * views_.pointsPerPatch + a].position -
                                views_.viewpoints[window * views_.pointsPerPatch + b].position;
                const double square = glm::dot(d, d);
                const double cosines = -glm::dot(d, to.normal) * glm::dot(d, from.normal);
                if (glm::dot(d, from.normal) <= 0 || cosines <= 0) continue;
                all += cosines / (square * square);
                add(d, from.normal, cosines / (square * square), shares);
            }
        if (all > 0)
            for (double& share : shares) share /= all;
        else // seen through panes, or by the edge
            add(way, from.normal, 1, shares);
        return shares;
    }

private:
    static void add(dvec3 way, dvec3 normal, double weight, std::array<double, kSlatNodes>& shares) {
        const BetweenNodes at = daylight::betweenNodes(daylight::Window::slatElevation(way, normal));
        shares[at.lower] += weight * (1 - at.part);
        shares[at.lower + 1] += weight * at.part;
    }

    std::span<const PointScene::Patch> patches_;
    PatchViewpoints views_;
};

} // namespace

SlatLobes::SlatLobes(const PointScene& scene, const GlowingBlinds& blinds, const gpu::Buffer& factors)
    : scene_(&scene) {
    for (size_t g = 0; g < blinds.groups().size(); ++g)
        if (blinds.groups()[g].window.hasSlats())
            for (const uint32_t patch : blinds.groups()[g].patches) windows_.push_back({patch, g});
    if (empty()) return;
    const geometry::PatchMesh& mesh = scene.mesh();
    const size_t n = mesh.patchCount();
    std::vector<float> copied;
    const float* matrix = factors.mapped<float>();
    if (!matrix) copied = factors.download<float>(n * n), matrix = copied.data();
    const PairShares pairs(mesh, scene.patches());
    shares_.resize(n);
    inParallel(n, [&](size_t i) {
        std::vector<Share> row;
        for (size_t w = 0; w < windows_.size(); ++w) {
            const double factor = double{matrix[i * n + windows_[w].patch]};
            if (factor <= 0) continue;
            const auto split = pairs.of(i, windows_[w].patch);
            for (size_t node = 0; node < kSlatNodes; ++node)
                if (split[node] > 0)
                    row.push_back({static_cast<uint32_t>(w * kSlatNodes + node),
                                   static_cast<float>(factor * split[node])});
        }
        shares_[i].assign(row.begin(), row.end()); // no room beyond what it takes
    });
    std::vector<double> arriving(rows(), 0), all(windows_.size(), 0);
    for (size_t i = 0; i < n; ++i) {
        const double area = geometry::patchArea(mesh, i);
        for (const Share& share : shares_[i]) {
            arriving[share.row] += area * double{share.factor};
            all[share.row / kSlatNodes] += area * double{share.factor};
        }
    }
    std::vector<float> corrected(rows());
    for (size_t row = 0; row < rows(); ++row) {
        const double wanted = daylight::nodeShare(row % kSlatNodes) * all[row / kSlatNodes];
        if (arriving[row] > 0)
            corrected[row] =
                static_cast<float>(std::clamp(wanted / arriving[row], 1 / kMostCorrected, kMostCorrected));
    }
    inParallel(n, [&](size_t i) {
        for (Share& share : shares_[i]) share.factor *= corrected[share.row];
    });
}

void SlatLobes::light(std::span<const glm::vec3> lobes, std::span<glm::vec3> onPatches) const {
    if (lobes.empty()) return;
    inParallel(onPatches.size(), [&](size_t i) {
        for (const Share& share : of(i)) onPatches[i] += share.factor * lobes[share.row];
    });
}

void SlatLobes::see(const PointView& view, uint32_t room, glm::vec3 times,
                    std::span<std::vector<float>> channels) const {
    if (empty()) return;
    const geometry::PatchMesh& mesh = scene_->mesh();
    std::vector<PointView::Polygon> parts;
    scene_->forRoomsSeen(view, room, [&](const PointView& seen, const RoomBeyond& beyond) {
        for (size_t w = 0; w < windows_.size(); ++w) {
            const uint32_t patch = windows_[w].patch;
            const PointScene::Patch& at = scene_->patches()[patch];
            if (mesh.room[patch] != beyond.room ||
                glm::dot(seen.position() - at.centre, at.normal) <= scene_->blockers().tolerance())
                continue;
            const double factor = seen.factor(geometry::patchCorners(mesh, patch), parts);
            if (factor <= 0) continue;
            std::array<double, kSlatNodes> nodes{};
            double weights = 0;
            for (const PointView::Polygon& part : parts)
                forCells(part, seen.normal(), kSeenAngle, [&](dvec3 centre, double weight) {
                    const BetweenNodes to =
                        daylight::betweenNodes(daylight::Window::slatElevation(-centre, at.normal));
                    nodes[to.lower] += weight * (1 - to.part);
                    nodes[to.lower + 1] += weight * to.part;
                    weights += weight;
                });
            if (weights <= 0) continue;
            glm::vec3 through = times;
            if (!beyond.panes.empty())
                through *= glm::vec3(beyond.transmittance(at.centre - seen.position()));
            for (size_t node = 0; node < kSlatNodes; ++node)
                for (size_t c = 0; c < channels.size(); ++c)
                    channels[c][w * kSlatNodes + node] +=
                        static_cast<float>(factor * nodes[node] / weights) * through[static_cast<int>(c)];
        }
    });
}

} // namespace heliodon::compute
