#include "compute/sun_bounce.h"

#include <algorithm>
#include <array>
#include <vector>

#include <glm/geometric.hpp>

#include "compute/lighting.h"
#include "compute/parallel.h"
#include "compute/point_view.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

constexpr double kMostNearer = 3;
constexpr double kMostCorrected = 4; // more, or by nothing: what little is seen of the patch says little
constexpr uint32_t kPoints = 4;      // on a near patch

struct Sent {
    dvec3 middle{0}, mean{0}; // of the light, and its mean over the patch
};

Sent sentBy(const SunlitParts& lit, double area) {
    Sent sent;
    double weights = 0;
    for (const SunlitParts::Part& part : lit.parts)
        for (size_t k = 1; k + 1 < part.polygon.size(); ++k) {
            const dvec3 a = part.polygon[0], b = part.polygon[k], c = part.polygon[k + 1];
            const double piece = 0.5 * glm::length(glm::cross(b - a, c - a)),
                         weight = piece * photometric(part.light);
            sent.mean += piece / area * dvec3(part.light);
            sent.middle += weight / 3 * (a + b + c);
            weights += weight;
        }
    if (weights > 0) sent.middle /= weights;
    return sent;
}

bool isLittle(dvec3 times) {
    return times.x < kMostCorrected && times.y < kMostCorrected && times.z < kMostCorrected;
}

// To which a point's form factor from a small patch is proportional.
inline double nearness(const PointScene::Patch& to, const PointScene::Patch& from, dvec3 point) {
    const dvec3 d = to.centre - point;
    const double square = glm::dot(d, d);
    return std::max(0.0, -glm::dot(d, to.normal)) * std::max(0.0, glm::dot(d, from.normal)) /
           (square * square);
}

} // namespace

SunBounce::SunBounce(const PointScene& scene, const NearPairs& pairs, std::span<const float> rowSums)
    : scene_(&scene), pairs_(&pairs), rowSums_(rowSums), views_(patchViewpoints(scene.mesh(), kPoints)) {
    const geometry::PatchMesh& mesh = scene.mesh();
    first_.push_back(0);
    for (size_t i = 0; i < mesh.patchCount(); ++i) first_.push_back(first_[i] + pairs.of(i).size());
    whole_.resize(first_.back());
    inParallel(mesh.patchCount(), [&](size_t i) {
        const std::vector<dvec3> corners = geometry::patchCorners(mesh, i);
        const std::span<const NearPairs::Pair> all = pairs.of(i);
        const PointScene::Patch& from = scene.patches()[i];
        for (size_t k = 0; k < all.size(); ++k) {
            double whole = 0;
            if (k < pairs.nearest(i).size())
                for (uint32_t p = 0; p < views_.pointsPerPatch; ++p) {
                    const Viewpoint& at = views_.viewpoints[size_t{all[k].to} * views_.pointsPerPatch + p];
                    whole += PointView(scene.blockers(), at.position, at.normal).factor(corners);
                }
            else
                whole = nearness(scene.patches()[all[k].to], from, from.centre);
            whole_[first_[i] + k] = static_cast<float>(whole);
        }
    });
}

// Light of the lit parts from a near patch, summed over its points.
dvec3 SunBounce::seenNearby(uint32_t to, const SunlitParts& lit) const {
    dvec3 sum(0);
    for (uint32_t p = 0; p < views_.pointsPerPatch; ++p) {
        const Viewpoint& at = views_.viewpoints[size_t{to} * views_.pointsPerPatch + p];
        const PointView view(scene_->blockers(), at.position, at.normal);
        for (const SunlitParts::Part& part : lit.parts) sum += view.factor(part.polygon) * dvec3(part.light);
    }
    return sum;
}

// Share of what the lit parts send that nearby patches get, by points of these parts.
double SunBounce::shareNearby(const SunlitParts& lit) const {
    std::vector<std::vector<dvec3>> nearby;
    for (const NearPairs::Pair& pair : pairs_->nearest(lit.patch))
        nearby.push_back(geometry::patchCorners(scene_->mesh(), pair.to));
    double share = 0, weights = 0;
    for (const SunlitParts::Part& part : lit.parts)
        for (size_t k = 1; k + 1 < part.polygon.size(); ++k) {
            const std::array<dvec3, 3> t{part.polygon[0], part.polygon[k], part.polygon[k + 1]};
            const double weight = glm::length(glm::cross(t[1] - t[0], t[2] - t[0])) * photometric(part.light);
            for (const dvec3& corner : t) { // exact for what bends no more than a parabola
                const PointView view(scene_->blockers(), (t[0] + t[1] + t[2] + 3.0 * corner) / 6.0,
                                     scene_->patches()[lit.patch].normal);
                for (const auto& corners : nearby) share += weight * view.factor(corners);
            }
            weights += 3 * weight;
        }
    return weights > 0 ? share / weights : 0;
}

// Factors by which what is sent stays what it was: what patches nearby get more, all others get less in
// proportion. Where these get next to nothing, rounding would tell their part; pairs alone share it out then.
SunBounce::Shares SunBounce::sharesOf(const SunlitParts& lit, const Fluxes& flux) const {
    constexpr double kLeastOthers = 0.02;
    const double whole = double{rowSums_[lit.patch]} * flux.area;
    Shares shares;
    if (!(whole - flux.even > kLeastOthers * whole)) {
        for (int c = 0; c < 3; ++c)
            if (flux.mean[c] > 0)
                shares.near[c] = shares.far[c] =
                    (flux.even + flux.evenFarther) * flux.mean[c] / (flux.nearby[c] + flux.farther[c]);
        return shares;
    }
    const double near = std::min(shareNearby(lit) * flux.area, whole);
    for (int c = 0; c < 3; ++c) {
        if (!(flux.mean[c] > 0)) continue;
        if (near > 0) shares.near[c] = near * flux.mean[c] / flux.nearby[c];
        const double others = (whole - flux.even - flux.evenFarther) * flux.mean[c] + flux.farther[c];
        shares.far[c] = shares.others[c] =
            others > 0 ? (whole - near) * flux.mean[c] / others : kMostCorrected;
    }
    return shares;
}

void SunBounce::addTo(std::span<glm::vec3> onPatches, std::span<glm::vec3> sent,
                      std::span<const SunlitParts> partly, double strength) const {
    const geometry::PatchMesh& mesh = scene_->mesh();
    std::vector<dvec3> nearby;
    std::vector<double> nearer; // of the rest: how many times its mean light is
    for (const SunlitParts& lit : partly) {
        Fluxes flux;
        flux.area = geometry::patchArea(mesh, lit.patch);
        const auto [middle, mean] = sentBy(lit, flux.area);
        flux.mean = mean;
        const PointScene::Patch& from = scene_->patches()[lit.patch];
        const std::span<const NearPairs::Pair> pairs = pairs_->of(lit.patch);
        const size_t nearest = pairs_->nearest(lit.patch).size();
        const float* wholes = whole_.data() + first_[lit.patch];
        const auto evenTo = [&](const NearPairs::Pair& pair) {
            const double size = scene_->patches()[pair.to].size;
            return size * size * double{pair.factor};
        };
        nearby.clear();
        for (size_t k = 0; k < nearest; ++k) {
            nearby.push_back(wholes[k] > 0 ? seenNearby(pairs[k].to, lit) / double{wholes[k]} : mean);
            const double even = evenTo(pairs[k]);
            flux.even += even, flux.nearby += even * nearby[k];
        }
        nearer.resize(pairs.size());
        double farther = 0;
        for (size_t k = nearest; k < pairs.size(); ++k) {
            const double whole = wholes[k];
            nearer[k] = whole > 0 ? std::min(kMostNearer,
                                             nearness(scene_->patches()[pairs[k].to], from, middle) / whole)
                                  : 1;
            const double even = evenTo(pairs[k]);
            flux.evenFarther += even, farther += even * nearer[k];
        }
        flux.farther = farther * mean;
        const auto [near, far, others] = sharesOf(lit, flux);
        if (!isLittle(near) || !isLittle(far)) continue;
        const dvec3 times = strength * dvec3(mesh.materials[mesh.material[lit.patch]].reflectance),
                    extra = times * (others - dvec3(1)) * mean;
        sent[lit.patch] += glm::vec3(extra);
        for (size_t k = 0; k < nearest; ++k)
            onPatches[pairs[k].to] +=
                glm::vec3(double{pairs[k].factor} * (times * (near * nearby[k] - mean) - extra));
        const glm::vec3 where(times * far * mean), even(times * mean + extra);
        for (size_t k = nearest; k < pairs.size(); ++k)
            onPatches[pairs[k].to] += pairs[k].factor * (static_cast<float>(nearer[k]) * where - even);
    }
}

} // namespace heliodon::compute
