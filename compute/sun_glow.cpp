#include "compute/sun_glow.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "compute/parallel.h"
#include "compute/point_view.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

constexpr double kWholeWithin = 1, kNoneFrom = 3; // sizes of a patch: how far a sender counts
constexpr double kInward = 0.02; // of the way to a triangle's middle; light jumps where surfaces touch

double smooth(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return x * x * (3 - 2 * x);
}

} // namespace

SunGlow::SunGlow(const PointScene& scene, const NearPairs& pairs)
    : scene_(&scene), senders_(scene.mesh().patchCount()) {
    const geometry::PatchMesh& mesh = scene.mesh();
    for (const PointScene::Patch& patch : scene.patches()) size_ += patch.size * patch.size;
    size_ = std::sqrt(size_ / static_cast<double>(std::max<size_t>(senders_.size(), 1)));
    for (uint32_t from = 0; from < senders_.size(); ++from)
        for (const NearPairs::Pair& pair : pairs.of(from))
            if (mesh.patch(pair.to).size() == 3 && !mesh.materials[mesh.material[pair.to]].isOpening() &&
                weight(scene.patches()[pair.to].centre, from) > 0)
                senders_[pair.to].push_back(from);
}

// 1 near the sender, 0 from a distance on: light from there is smooth enough.
double SunGlow::weight(dvec3 point, size_t sender) const {
    const PointScene::Patch& from = scene_->patches()[sender];
    const double sizes = glm::length(point - from.centre) / std::max(size_, from.size);
    return 1 - smooth((sizes - kWholeWithin) / (kNoneFrom - kWholeWithin));
}

std::vector<SunGlow::Lit> SunGlow::litPatches(const Lighting& light, std::span<const SunlitParts> partly,
                                              double strength) const {
    const geometry::PatchMesh& mesh = scene_->mesh();
    std::vector<const SunlitParts*> partsOf(mesh.patchCount());
    for (const SunlitParts& lit : partly) partsOf[lit.patch] = &lit;
    std::vector<Lit> all;
    for (uint32_t p = 0; p < mesh.patchCount(); ++p) {
        const glm::vec3 reflectance = mesh.materials[mesh.material[p]].reflectance;
        if (light.sunIlluminance[p] * reflectance == glm::vec3(0)) continue;
        Lit& lit = all.emplace_back(p);
        if (!partsOf[p]) {
            lit.parts.push_back({geometry::patchCorners(mesh, p), reflectance * light.sunIlluminance[p]});
            continue;
        }
        lit.parts = partsOf[p]->parts;
        for (SunlitParts::Part& part : lit.parts) part.light *= static_cast<float>(strength) * reflectance;
    }
    return all;
}

void SunGlow::fillGrid(uint32_t patch, std::span<const Lit* const> lit, std::span<glm::vec3> grid) const {
    const geometry::PatchMesh& mesh = scene_->mesh();
    const std::vector<dvec3> corner = geometry::patchCorners(mesh, patch);
    const dvec3 middle = (corner[0] + corner[1] + corner[2]) / 3.0, normal = scene_->patches()[patch].normal;
    std::vector<dvec3> ends = corner;
    for (const Lit* from : lit)
        for (const SunlitParts::Part& part : from->parts)
            ends.insert(ends.end(), part.polygon.begin(), part.polygon.end());
    const Blockers between = scene_->blockers().between(ends);
    size_t place = 0;
    for (const dvec3& at : PatchGlow::places(corner[0], corner[1], corner[2])) {
        const PointView view(between, glm::mix(at, middle, kInward), normal, mesh.room[patch]);
        dvec3 sum(0);
        for (const Lit* from : lit)
            if (const double counts = weight(at, from->patch); counts > 0)
                for (const SunlitParts::Part& part : from->parts)
                    sum += counts * view.factor(part.polygon) * dvec3(part.light);
        grid[place++] = sum;
    }
}

LightDetail SunGlow::of(const Lighting& light, std::span<const SunlitParts> partly, double strength) const {
    const std::vector<Lit> all = litPatches(light, partly, strength);
    std::vector<const Lit*> litOf(senders_.size());
    for (const Lit& lit : all) litOf[lit.patch] = &lit;
    LightDetail detail;
    std::vector<PatchGlow>& glow = detail.grids;
    for (uint32_t p = 0; p < senders_.size(); ++p)
        if (std::ranges::any_of(senders_[p], [&](uint32_t from) { return litOf[from]; }))
            glow.push_back({p, {}});
    if (glow.empty()) return detail;
    inParallel(glow.size(), [&](size_t g) {
        std::vector<const Lit*> lit;
        for (const uint32_t from : senders_[glow[g].patch])
            if (litOf[from]) lit.push_back(litOf[from]);
        fillGrid(glow[g].patch, lit, glow[g].lux);
    });
    detail.mean.assign(senders_.size(), glm::vec3(0));
    for (const PatchGlow& grid : glow) detail.mean[grid.patch] = grid.mean();
    return detail;
}

} // namespace heliodon::compute
