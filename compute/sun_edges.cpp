#include "compute/sun_edges.h"

#include <glm/geometric.hpp>

#include "compute/lighting.h"

namespace heliodon::compute {

namespace {

// Form factors of patches at a sensor: below kFar edges of sunlight average out, from kNear they are seen
// exactly.
constexpr float kFar = 2e-4F, kNear = 0.02F, kMostNearer = 3;

} // namespace

std::vector<SunEdges::Edge> SunEdges::edgesOf(const geometry::PatchMesh& mesh,
                                              const std::vector<SunlitParts>& partly, double strength) {
    std::vector<Edge> edges;
    for (const SunlitParts& lit : partly) {
        const glm::vec3 rho = mesh.materials[mesh.material[lit.patch]].reflectance;
        Edge edge{lit.patch, {}, {}, {}};
        glm::dvec3 middle(0), leaving(0);
        double flux = 0;
        for (const SunlitParts::Part& part : lit.parts) {
            const glm::vec3 exitance = static_cast<float>(strength) * rho * part.light;
            for (size_t k = 1; k + 1 < part.polygon.size(); ++k) {
                const glm::dvec3 a = part.polygon[0], b = part.polygon[k], c = part.polygon[k + 1];
                const double area = 0.5 * glm::length(glm::cross(b - a, c - a)),
                             share = area * photometric(exitance);
                flux += share;
                leaving += area * glm::dvec3(exitance);
                middle += share / 3 * (a + b + c);
            }
            edge.parts.push_back({part.polygon, exitance});
        }
        if (!(flux > 0)) continue;
        edge.exitance = glm::vec3(leaving / geometry::patchArea(mesh, lit.patch));
        edge.middle = glm::vec3(middle / flux);
        edges.push_back(std::move(edge));
    }
    return edges;
}

SunEdges::SunEdges(const geometry::PatchMesh& mesh, std::vector<std::vector<Edge>> ofHours) {
    std::vector<size_t> next(mesh.patchCount() + 1, 0);
    for (const auto& edges : ofHours)
        for (const Edge& edge : edges) ++next[edge.patch + 1];
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        if (next[i + 1] > 0)
            patches_.push_back({static_cast<uint32_t>(i), next[i],
                                glm::vec3(geometry::patchCentroid(mesh, i)),
                                glm::vec3(geometry::patchNormal(mesh, i))});
        next[i + 1] += next[i];
    }
    const size_t count = next.back();
    hour_.resize(count), exitance_.resize(count), colour_.resize(count), parts_.resize(count);
    x_.resize(count), y_.resize(count), z_.resize(count);
    for (size_t h = 0; h < ofHours.size(); ++h)
        for (Edge& edge : ofHours[h]) {
            const size_t at = next[edge.patch]++;
            hour_[at] = static_cast<uint32_t>(h);
            colour_[at] = edge.exitance;
            exitance_[at] = static_cast<float>(photometric(edge.exitance));
            x_[at] = edge.middle.x, y_[at] = edge.middle.y, z_[at] = edge.middle.z;
            parts_[at] = std::move(edge.parts);
        }
}

void SunEdges::addTo(std::span<float> lux, const PointScene& scene, const PointView& view, uint32_t room,
                     const float* even) const {
    const glm::vec3 at(view.position()), up(view.normal());
    std::vector<float> more;
    for (size_t p = 0; p < patches_.size(); ++p) {
        const Patch& patch = patches_[p];
        const float share = even[patch.patch];
        if (share < kFar || scene.mesh().room[patch.patch] != room) continue; // through glass: from afar
        const size_t first = patch.first, last = edgesEnd(p);
        if (share >= kNear) {
            // Not what of the share is seen through windows.
            addExactly(lux, view, p, scene.factor(view, patch.patch), glm::vec3(1));
            continue;
        }
        const glm::vec3 normal = patch.normal;
        const auto nearness = [at, up, normal](float x, float y, float z) {
            const float dx = x - at.x, dy = y - at.y, dz = z - at.z;
            const float square = dx * dx + dy * dy + dz * dz;
            const float above = dx * up.x + dy * up.y + dz * up.z,
                        before = -(dx * normal.x + dy * normal.y + dz * normal.z);
            return (above > 0 ? above : 0) * (before > 0 ? before : 0) / (square * square + 1e-30F);
        };
        const float whole = nearness(patch.middle.x, patch.middle.y, patch.middle.z);
        if (!(whole > 0)) continue;
        const float scale = 1 / whole;
        more.resize(last - first);
        for (size_t e = first; e < last; ++e) {
            const float times = nearness(x_[e], y_[e], z_[e]) * scale;
            more[e - first] = share * exitance_[e] * ((times < kMostNearer ? times : kMostNearer) - 1);
        }
        for (size_t e = first; e < last; ++e) lux[hour_[e]] += more[e - first];
    }
}

void SunEdges::addExactly(std::span<float> lux, const PointView& view, size_t patch, double straight,
                          glm::vec3 answer) const {
    for (size_t e = patches_[patch].first; e < edgesEnd(patch); ++e) {
        glm::dvec3 more = -straight * glm::dvec3(colour_[e]);
        for (const Edge::Part& part : parts_[e])
            more += view.factor(part.polygon) * glm::dvec3(part.exitance);
        lux[hour_[e]] += static_cast<float>(photometric(answer * glm::vec3(more)));
    }
}

void SunEdges::addTo(std::span<float> lux, const PointScene& scene, const NearLight& near,
                     uint32_t room) const {
    for (const NearLight::Cell& cell : near.cells) {
        const PointView view(scene.blockers(), cell.middle, cell.normal, room);
        const double answer = photometric(cell.answer);
        for (size_t p = 0; p < patches_.size(); ++p) {
            const uint32_t patch = patches_[p].patch;
            if (scene.mesh().room[patch] != room) continue;
            const double straight = scene.factor(view, patch);
            if (straight * answer >= double{kFar}) addExactly(lux, view, p, straight, cell.answer);
        }
    }
}

size_t SunEdges::bytesOf(std::span<const Edge> edges) {
    size_t sum = edges.size() * sizeof(Edge);
    for (const Edge& edge : edges)
        for (const Edge::Part& part : edge.parts)
            sum += sizeof part + part.polygon.size() * sizeof(glm::dvec3);
    return sum;
}

} // namespace heliodon::compute
