#include "compute/slat_lobes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "compute/parallel.h"
#include "compute/patch_points.h"
#include "compute/view_cells.h"

namespace heliodon::compute {

using daylight::BetweenNodes, daylight::kSlatLobes, daylight::kSlatNodes, glm::dvec3;

namespace {

// Distance over the larger patch's size from which one direction stands for all.
constexpr double kFarPair = 6;
constexpr double kSeenAngle = 0.05;  // radians, of one piece of a window that a point sees
constexpr uint32_t kPoints = 4;      // on each of two near patches
constexpr double kMostCorrected = 2; // times that a lobe's shares are put right

using LobeShares = std::array<double, kSlatLobes>;

// Light that leaves a window that way. `normal`: of the window.
void addWay(const daylight::Window& window, dvec3 way, dvec3 normal, double weight, LobeShares& shares) {
    const BetweenNodes at = daylight::betweenNodes(daylight::Window::slatElevation(way, normal));
    const double mirrored = window.mirrored(way, normal);
    for (const auto& [node, part] : {std::pair(at.lower, 1 - at.part), std::pair(at.lower + 1, at.part)}) {
        shares[node] += weight * part;
        shares[kSlatNodes + node] += weight * part * mirrored;
    }
}

// Shares of the exchange of two patches by the lobes of light that leaves a window.
class PairShares {
public:
    PairShares(const geometry::PatchMesh& mesh, std::span<const PointScene::Patch> patches)
        : patches_(patches), views_(patchViewpoints(mesh, kPoints)) {}

    LobeShares of(size_t patch, size_t window, const daylight::Window& state) const {
        LobeShares shares{};
        const PointScene::Patch &to = patches_[patch], &from = patches_[window];
        const dvec3 way = to.centre - from.centre;
        if (glm::length(way) > kFarPair * std::max(to.size, from.size)) {
            addWay(state, way, from.normal, 1, shares);
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
                addWay(state, d, from.normal, cosines / (square * square), shares);
            }
        if (all > 0)
            for (double& share : shares) share /= all;
        else // seen through panes, or by the edge
            addWay(state, way, from.normal, 1, shares);
        return shares;
    }

private:
    std::span<const PointScene::Patch> patches_;
    PatchViewpoints views_;
};

} // namespace

SlatLobes::SlatLobes(const PointScene& scene, const GlowingBlinds& blinds, const gpu::Buffer& factors)
    : scene_(&scene), groups_(blinds.groups()) {
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
            const LobeShares split = pairs.of(i, windows_[w].patch, groups_[windows_[w].group].window);
            for (size_t lobe = 0; lobe < kSlatLobes; ++lobe)
                if (split[lobe] > 0)
                    row.push_back({static_cast<uint32_t>(w * kSlatLobes + lobe),
                                   static_cast<float>(factor * split[lobe])});
        }
        shares_[i].assign(row.begin(), row.end()); // no room beyond what it takes
    });
    keepLight();
}

// Puts right what the form factors of each lobe add up to: by no more than kMostCorrected times, and what is
// still missing, straight up and down where few patches lie, goes where the next lobe's light goes that has
// enough.
void SlatLobes::keepLight() {
    const geometry::PatchMesh& mesh = scene_->mesh();
    std::vector<double> arriving(rows(), 0), all(windows_.size(), 0);
    for (size_t i = 0; i < shares_.size(); ++i) {
        const double area = geometry::patchArea(mesh, i);
        for (const Share& share : shares_[i]) {
            arriving[share.row] += area * double{share.factor};
            if (share.row % kSlatLobes < kSlatNodes)
                all[share.row / kSlatLobes] += area * double{share.factor};
        }
    }
    const auto wanted = [&](size_t row) {
        return daylight::lobeShare(row % kSlatLobes) * all[row / kSlatLobes];
    };
    const auto hasEnough = [&](size_t row) { return kMostCorrected * arriving[row] >= wanted(row); };
    std::vector<std::vector<Share>> passedOn(rows()); // with a lobe's own light, times
    for (size_t row = 0; row < rows(); ++row) {
        if (hasEnough(row)) continue;
        const size_t node = row % kSlatNodes, middle = kSlatNodes / 2;
        const size_t step = node < middle ? 1 : size_t(-1); // towards the horizontal
        for (size_t k = node, next = row; k != middle;) {
            k += step, next += step;
            if (!hasEnough(next)) continue;
            const double missing = wanted(row) - kMostCorrected * arriving[row];
            passedOn[next].push_back(
                {static_cast<uint32_t>(row), static_cast<float>(missing / arriving[next])});
            break;
        }
    }
    inParallel(shares_.size(), [&](size_t i) {
        std::vector<Share> row;
        for (const Share& share : shares_[i]) {
            const double times =
                hasEnough(share.row) ? wanted(share.row) / arriving[share.row] : kMostCorrected;
            row.push_back({share.row, static_cast<float>(times) * share.factor});
            for (const Share& more : passedOn[share.row])
                row.push_back({more.row, more.factor * share.factor});
        }
        shares_[i].assign(row.begin(), row.end());
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
            LobeShares shares{};
            double weights = 0;
            for (const PointView::Polygon& part : parts)
                forCells(part, seen.normal(), kSeenAngle, [&](dvec3 centre, double weight) {
                    addWay(groups_[windows_[w].group].window, -centre, at.normal, weight, shares);
                    weights += weight;
                });
            if (weights <= 0) continue;
            glm::vec3 through = times;
            if (!beyond.panes.empty())
                through *= glm::vec3(beyond.transmittance(at.centre - seen.position()));
            for (size_t lobe = 0; lobe < kSlatLobes; ++lobe)
                for (size_t c = 0; c < channels.size(); ++c)
                    channels[c][w * kSlatLobes + lobe] +=
                        static_cast<float>(factor * shares[lobe] / weights) * through[static_cast<int>(c)];
        }
    });
}

} // namespace heliodon::compute
