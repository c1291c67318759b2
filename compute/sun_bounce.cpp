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

// To which a point's form factor from a small patch is proportional.
double nearness(const PointScene::Patch& to, const PointScene::Patch& from, dvec3 point) {
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
    const geometry::PatchMesh& mesh = scene_->mesh();
    double share = 0, weights = 0;
    for (const SunlitParts::Part& part : lit.parts)
        for (size_t k = 1; k + 1 < part.polygon.size(); ++k) {
            const std::array<dvec3, 3> t{part.polygon[0], part.polygon[k], part.polygon[k + 1]};
            const double weight = glm::length(glm::cross(t[1] - t[0], t[2] - t[0])) * photometric(part.light);
            for (const dvec3& corner : t) { // exact for what bends no more than a parabola
                const PointView view(scene_->blockers(), (t[0] + t[1] + t[2] + 3.0 * corner) / 6.0,
                                     scene_->patches()[lit.patch].normal);
                for (const NearPairs::Pair& pair : pairs_->nearest(lit.patch))
                    share += weight * view.factor(geometry::patchCorners(mesh, pair.to));
            }
            weights += 3 * weight;
        }
    return weights > 0 ? share / weights : 0;
}

void SunBounce::addTo(std::span<glm::vec3> onPatches, std::span<glm::vec3> sent,
                      std::span<const SunlitParts> partly, double strength) const {
    const geometry::PatchMesh& mesh = scene_->mesh();
    std::vector<dvec3> light;
    for (const SunlitParts& lit : partly) {
        const double area = geometry::patchArea(mesh, lit.patch);
        const auto [middle, mean] = sentBy(lit, area);
        const PointScene::Patch& from = scene_->patches()[lit.patch];
        const std::span<const NearPairs::Pair> pairs = pairs_->of(lit.patch);
        const size_t nearest = pairs_->nearest(lit.patch).size();
        const float* wholes = whole_.data() + first_[lit.patch];
        light.clear();
        double even = 0;             // share of what is sent that patches nearby get were it even
        dvec3 nearby(0), further(0); // flux; of those farther off, beyond what their form factors say
        for (size_t k = 0; k < pairs.size(); ++k) {
            const PointScene::Patch& to = scene_->patches()[pairs[k].to];
            const double whole = wholes[k];
            dvec3 seen = mean;
            if (k < nearest && whole > 0)
                seen = seenNearby(pairs[k].to, lit) / whole;
            else if (whole > 0)
                seen *= std::min(kMostNearer, nearness(to, from, middle) / whole);
            const double flux = to.size * to.size * double{pairs[k].factor};
            if (k < nearest)
                nearby += flux * seen, even += flux / area;
            else
                further += flux * (seen - mean);
            light.push_back(seen);
        }
        // What is sent stays what it was: what patches nearby get more, all others get less in proportion.
        const double whole = double{rowSums_[lit.patch]}, share = std::min(shareNearby(lit), whole);
        dvec3 near(0), far(0);
        for (int c = 0; c < 3; ++c) {
            if (nearby[c] > 0) near[c] = share * area * mean[c] / nearby[c];
            const double others = (whole - even) * area * mean[c] + further[c];
            if (others > 0) far[c] = (whole - share) * area * mean[c] / others;
        }
        if (!(std::max(glm::length(near), glm::length(far)) < kMostCorrected)) continue;
        const dvec3 times = strength * dvec3(mesh.materials[mesh.material[lit.patch]].reflectance);
        const dvec3 extra = times * (far - dvec3(1)) * mean;
        sent[lit.patch] += glm::vec3(extra);
        for (size_t k = 0; k < pairs.size(); ++k)
            onPatches[pairs[k].to] += glm::vec3(
                double{pairs[k].factor} * (times * ((k < nearest ? near : far) * light[k] - mean) - extra));
    }
}

} // namespace heliodon::compute
