#include "compute/sun_bounce.h"

#include <algorithm>
#include <vector>

#include <glm/geometric.hpp>

#include "compute/lighting.h"
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
    : scene_(&scene), pairs_(&pairs), views_(patchViewpoints(scene.mesh(), kPoints)) {}

// Light of the lit parts at a near patch over that of the whole patch, were its exitance one.
std::optional<dvec3> SunBounce::seenNearby(uint32_t to, const SunlitParts& lit,
                                           std::span<const dvec3> corners) const {
    double whole = 0;
    dvec3 sum(0);
    for (uint32_t p = 0; p < views_.pointsPerPatch; ++p) {
        const Viewpoint& at = views_.viewpoints[size_t{to} * views_.pointsPerPatch + p];
        const PointView view(scene_->blockers(), at.position, at.normal);
        whole += view.factor(corners);
        for (const SunlitParts::Part& part : lit.parts) sum += view.factor(part.polygon) * dvec3(part.light);
    }
    if (!(whole > 0)) return std::nullopt;
    return sum / whole;
}

void SunBounce::addTo(std::span<glm::vec3> onPatches, std::span<const SunlitParts> partly,
                      double strength) const {
    const geometry::PatchMesh& mesh = scene_->mesh();
    std::vector<dvec3> corners, light;
    for (const SunlitParts& lit : partly) {
        const auto [middle, mean] = sentBy(lit, geometry::patchArea(mesh, lit.patch));
        const PointScene::Patch& from = scene_->patches()[lit.patch];
        const std::span<const NearPairs::Pair> pairs = pairs_->of(lit.patch);
        corners.clear();
        for (uint32_t v : mesh.patch(lit.patch)) corners.push_back(mesh.vertices[v]);
        light.clear();
        dvec3 sent(0), arrived(0);
        for (const NearPairs::Pair& pair : pairs) {
            const PointScene::Patch& to = scene_->patches()[pair.to];
            std::optional<dvec3> seen;
            if (pair.factor >= NearPairs::kNear) seen = seenNearby(pair.to, lit, corners);
            if (!seen) {
                const double whole = nearness(to, from, from.centre);
                seen = mean * (whole > 0 ? std::min(kMostNearer, nearness(to, from, middle) / whole) : 1.0);
            }
            const double flux = to.size * to.size * double{pair.factor};
            sent += flux * mean;
            arrived += flux * *seen;
            light.push_back(*seen);
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
