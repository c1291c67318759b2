#include "compute/sun_bounce.h"

#include <algorithm>
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

SunBounce::SunBounce(const PointScene& scene, const NearPairs& pairs)
    : scene_(&scene), pairs_(&pairs), views_(patchViewpoints(scene.mesh(), kPoints)) {
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

void SunBounce::addTo(std::span<glm::vec3> onPatches, std::span<const SunlitParts> partly,
                      double strength) const {
    const geometry::PatchMesh& mesh = scene_->mesh();
    std::vector<dvec3> light;
    for (const SunlitParts& lit : partly) {
        const auto [middle, mean] = sentBy(lit, geometry::patchArea(mesh, lit.patch));
        const PointScene::Patch& from = scene_->patches()[lit.patch];
        const std::span<const NearPairs::Pair> pairs = pairs_->of(lit.patch);
        const size_t nearest = pairs_->nearest(lit.patch).size();
        const float* wholes = whole_.data() + first_[lit.patch];
        light.clear();
        dvec3 sent(0), arrived(0);
        for (size_t k = 0; k < pairs.size(); ++k) {
            const PointScene::Patch& to = scene_->patches()[pairs[k].to];
            const double whole = wholes[k];
            dvec3 seen = mean;
            if (k < nearest && whole > 0)
                seen = seenNearby(pairs[k].to, lit) / whole;
            else if (whole > 0)
                seen *= std::min(kMostNearer, nearness(to, from, middle) / whole);
            const double flux = to.size * to.size * double{pairs[k].factor};
            sent += flux * mean;
            arrived += flux * seen;
            light.push_back(seen);
        }
        dvec3 kept(1); // what is sent stays what it was
        for (int c = 0; c < 3; ++c)
            if (sent[c] > 0) kept[c] = sent[c] / arrived[c];
        if (!(glm::length(kept) < kMostCorrected)) continue;
        const dvec3 times = strength * dvec3(mesh.materials[mesh.material[lit.patch]].reflectance);
        for (size_t k = 0; k < pairs.size(); ++k)
            onPatches[pairs[k].to] += glm::vec3(double{pairs[k].factor} * times * (kept * light[k] - mean));
    }
}

} // namespace heliodon::compute
