#include "compute/sun_glow.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include <glm/geometric.hpp>

#include "compute/parallel.h"
#include "compute/point_view.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

constexpr uint32_t kPoints = 4;                   // on a patch
constexpr double kInward = 0.3;                   // of the way to the middle of the patches around a corner
constexpr double kWholeWithin = 1, kNoneFrom = 3; // sizes of a patch: how far a sender counts

double smooth(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return x * x * (3 - 2 * x);
}

} // namespace

SunGlow::SunGlow(const PointScene& scene, const NearPairs& pairs)
    : scene_(&scene), pairs_(&pairs), views_(patchViewpoints(scene.mesh(), kPoints)) {
    const size_t n = scene.mesh().patchCount();
    double area = 0;
    for (const PointScene::Patch& patch : scene.patches()) area += patch.size * patch.size;
    size_ = std::sqrt(area / static_cast<double>(std::max<size_t>(n, 1)));
    findPlaces();
    senders_.resize(n);
    inParallel(n, [&](size_t j) { findNear(j); });
}

void SunGlow::findPlaces() {
    const geometry::PatchMesh& mesh = scene_->mesh();
    std::unordered_map<uint64_t, uint32_t> known; // vertex and surface
    struct Sum {
        dvec3 middle{0}, normal{0};
        double area = 0;
        uint32_t vertex = 0;
    };
    std::vector<Sum> sums;
    for (uint32_t p = 0; p < mesh.patchCount(); ++p) {
        const PointScene::Patch& patch = scene_->patches()[p];
        const double area = patch.size * patch.size;
        for (const uint32_t v : mesh.patch(p)) {
            const auto [entry, fresh] =
                known.try_emplace(uint64_t{v} << 32 | mesh.surface[p], static_cast<uint32_t>(sums.size()));
            if (fresh) sums.push_back({.vertex = v});
            Sum& sum = sums[entry->second];
            sum.middle += area * patch.centre, sum.normal += area * patch.normal, sum.area += area;
            placeOf_.push_back(entry->second);
        }
    }
    for (const Sum& sum : sums)
        places_.push_back({glm::mix(mesh.vertices[sum.vertex], sum.middle / sum.area, kInward),
                           glm::normalize(sum.normal)});
}

// 1 near the sender, 0 from a distance on: light from there is smooth enough.
double SunGlow::weight(dvec3 point, size_t sender) const {
    const PointScene::Patch& from = scene_->patches()[sender];
    const double sizes = glm::length(point - from.centre) / std::max(size_, from.size);
    return 1 - smooth((sizes - kWholeWithin) / (kNoneFrom - kWholeWithin));
}

std::span<const Viewpoint> SunGlow::pointsOf(uint32_t patch) const {
    return std::span(views_.viewpoints).subspan(size_t{patch} * views_.pointsPerPatch, views_.pointsPerPatch);
}

dvec3 SunGlow::atPlace(uint32_t place, std::span<const SunlitParts::Part> parts) const {
    const PointView view(scene_->blockers(), places_[place].position, places_[place].normal);
    dvec3 sum(0);
    for (const SunlitParts::Part& part : parts) sum += view.factor(part.polygon) * dvec3(part.light);
    return sum;
}

dvec3 SunGlow::onPatch(uint32_t patch, size_t sender, std::span<const SunlitParts::Part> parts) const {
    dvec3 sum(0);
    for (const Viewpoint& at : pointsOf(patch)) {
        const double counts = weight(at.position, sender);
        if (!(counts > 0)) continue;
        const PointView view(scene_->blockers(), at.position, at.normal);
        for (const SunlitParts::Part& part : parts)
            sum += counts * view.factor(part.polygon) * dvec3(part.light);
    }
    return sum;
}

void SunGlow::findNear(size_t sender) {
    const geometry::PatchMesh& mesh = scene_->mesh();
    const std::vector<SunlitParts::Part> all{{geometry::patchCorners(mesh, sender), glm::vec3(1)}};
    struct Share {
        double factor = 0, open = 0; // form factors from the patches around, and as if nothing stood between
    };
    std::map<uint32_t, Share> around; // by place
    Sender& near = senders_[sender];
    for (const NearPairs::Pair& pair : pairs_->of(sender)) {
        if (!(weight(scene_->patches()[pair.to].centre, sender) > 0)) continue;
        double open = 0;
        for (const Viewpoint& at : pointsOf(pair.to))
            open += PointView(scene_->blockers(), at.position, at.normal).factor(all[0].polygon);
        if (!(open > 0)) continue;
        const double scale = double{pair.factor} / open;
        near.patches.push_back({pair.to, static_cast<float>(scale),
                                static_cast<float>(scale * onPatch(pair.to, sender, all).x)});
        for (uint32_t c = mesh.firstCorner[pair.to]; c < mesh.firstCorner[pair.to + 1]; ++c) {
            Share& share = around[placeOf_[c]];
            share.factor += pair.factor;
            share.open += open / views_.pointsPerPatch;
        }
    }
    for (const auto& [place, share] : around) {
        const double scale =
            std::min(1.0, share.factor / share.open) * weight(places_[place].position, sender);
        if (scale > 0)
            near.places.push_back(
                {place, static_cast<float>(scale), static_cast<float>(scale * atPlace(place, all).x)});
    }
}

void SunGlow::addTo(Lighting& light, std::span<const SunlitParts> partly, double strength) const {
    const geometry::PatchMesh& mesh = scene_->mesh();
    std::vector<const SunlitParts*> partsOf(mesh.patchCount());
    for (const SunlitParts& lit : partly) partsOf[lit.patch] = &lit;
    std::vector<dvec3> onPatches(mesh.patchCount(), dvec3(0)), atPlaces(places_.size(), dvec3(0));
    bool any = false;
    for (size_t j = 0; j < mesh.patchCount(); ++j) {
        const glm::vec3 reflectance = mesh.materials[mesh.material[j]].reflectance;
        if (light.sunIlluminance[j] * reflectance == glm::vec3(0)) continue;
        const dvec3 whole(reflectance * light.sunIlluminance[j]), part = strength * dvec3(reflectance);
        for (const Near& near : senders_[j].patches)
            onPatches[near.to] += partsOf[j]
                                      ? double{near.scale} * part * onPatch(near.to, j, partsOf[j]->parts)
                                      : double{near.whole} * whole;
        for (const Near& near : senders_[j].places)
            atPlaces[near.to] += partsOf[j] ? double{near.scale} * part * atPlace(near.to, partsOf[j]->parts)
                                            : double{near.whole} * whole;
        any = any || !senders_[j].patches.empty();
    }
    if (!any) return;
    light.sunGlow.assign(onPatches.begin(), onPatches.end());
    for (const uint32_t place : placeOf_) light.cornerGlow.emplace_back(atPlaces[place]);
}

} // namespace heliodon::compute
