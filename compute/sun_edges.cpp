#include "compute/sun_edges.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "compute/lighting.h"

namespace heliodon::compute {

namespace {

// Form factors of patches at a sensor: below kFar edges of sunlight average out, from kNear they are seen
// exactly. By way of a near wall's cells, which are many, they do below kFarOfCells.
constexpr float kFar = 1e-6F, kNear = 0.02F, kMostNearer = 3;
constexpr double kFarOfCells = 2e-4;
// So much nearer or farther than its patch light is seen exactly: its middle says little.
constexpr float kMuch = 0.5F;
// Less than this share of a patch's height below the horizon, or hidden, does not count.
constexpr double kSliver = 0.05;

struct Middles {
    const float *x, *y, *z;
    size_t count;
};
// A point, and what its nearness to a patch is measured in.
struct Place {
    glm::vec3 position, up; // up: the point's normal over the height of the patch's middle above its plane
    float square;           // of the distance of that middle
};

// How many times nearer and squarer middles of light stand than that of their patch, less one. The point's
// height over the patch's plane is the same for all.
[[gnu::always_inline]] inline void howMuchNearer(const Middles& middles, const Place& from,
                                                 float* __restrict nearer) {
    for (size_t k = 0; k < middles.count; ++k) {
        const float x = middles.x[k] - from.position.x, y = middles.y[k] - from.position.y,
                    z = middles.z[k] - from.position.z;
        const float above = x * from.up.x + y * from.up.y + z * from.up.z,
                    closer = from.square / (x * x + y * y + z * z + 1e-30F);
        const float times = (above > 0 ? above : 0) * closer * closer;
        nearer[k] = (times < kMostNearer ? times : kMostNearer) - 1;
    }
}

using HowMuchNearer = void (*)(const Middles&, const Place&, float*);

void narrow(const Middles& middles, const Place& from, float* nearer) {
    howMuchNearer(middles, from, nearer);
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] void wide(const Middles& middles, const Place& from, float* nearer) {
    howMuchNearer(middles, from, nearer);
}
#endif

HowMuchNearer ofThisProcessor() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) return wide;
#endif
    return narrow;
}

// Form factor of a patch with nothing before it.
double openFactorOf(const geometry::PatchMesh& mesh, const PointView& view, uint32_t patch) {
    std::vector<glm::dvec3> above;
    return view.openFactor(geometry::patchCorners(mesh, patch), above);
}

} // namespace

std::vector<SunEdges::Edge> SunEdges::edgesOf(const geometry::PatchMesh& mesh,
                                              const std::vector<SunlitParts>& partly, double strength) {
    std::vector<Edge> edges;
    for (const SunlitParts& lit : partly) {
        const glm::vec3 rho = mesh.materials[mesh.material[lit.patch]].reflectance;
        Edge edge{lit.patch, {}, {}, {}, {}};
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

SunEdges::Patch SunEdges::patchOf(const geometry::PatchMesh& mesh, uint32_t patch, size_t first) {
    const glm::dvec3 middle = geometry::patchCentroid(mesh, patch);
    double reach = 0;
    for (const uint32_t v : mesh.patch(patch))
        reach = std::max(reach, glm::length(mesh.vertices[v] - middle));
    return {patch,
            first,
            glm::vec3(middle),
            glm::vec3(geometry::patchNormal(mesh, patch)),
            static_cast<float>(geometry::patchArea(mesh, patch)),
            static_cast<float>(reach)};
}

// The largest factors under the integral of the form factor, with the whole area.
double SunEdges::mostOf(const Patch& patch, const PointView& view) {
    const glm::vec3 middle = patch.middle - glm::vec3(view.position());
    const float nearest = glm::length(middle) - patch.reach;
    if (nearest < patch.reach) return 1;
    const float above = glm::dot(middle, glm::vec3(view.normal())) + patch.reach,
                before = -glm::dot(middle, patch.normal);
    if (above <= 0) return 0;
    const float square = nearest * nearest, least = 1e-3F * nearest; // rounding
    return patch.area * above * std::max(before, least) / (std::numbers::pi_v<float> * square * square);
}

SunEdges::SunEdges(const geometry::PatchMesh& mesh, std::vector<std::vector<Edge>> ofHours) {
    std::vector<size_t> next(mesh.patchCount() + 1, 0);
    for (const auto& edges : ofHours)
        for (const Edge& edge : edges) ++next[edge.patch + 1];
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        if (next[i + 1] > 0) patches_.push_back(patchOf(mesh, static_cast<uint32_t>(i), next[i]));
        next[i + 1] += next[i];
    }
    const size_t count = next.back();
    std::vector<std::pair<uint32_t, const Edge*>> ordered(count); // with their hours
    for (size_t h = 0; h < ofHours.size(); ++h)
        for (const Edge& edge : ofHours[h]) ordered[next[edge.patch]++] = {static_cast<uint32_t>(h), &edge};
    for (const auto& [hour, edge] : ordered) {
        hour_.push_back(hour);
        colour_.push_back(edge->exitance);
        colourBeyond_.push_back(edge->beyond);
        exitance_.push_back(static_cast<float>(photometric(edge->exitance)));
        beyond_.push_back(static_cast<float>(photometric(edge->beyond)));
        x_.push_back(edge->middle.x), y_.push_back(edge->middle.y), z_.push_back(edge->middle.z);
        firstPart_.push_back(parts_.size());
        for (const Edge::Part& part : edge->parts) {
            parts_.push_back({corners_.size(), part.exitance});
            corners_.insert(corners_.end(), part.polygon.begin(), part.polygon.end());
        }
    }
    firstPart_.push_back(parts_.size());
    parts_.push_back({corners_.size(), {}});
}

bool SunEdges::findNearer(const PointView& view, size_t patch, std::vector<float>& nearer) const {
    const Patch& of = patches_[patch];
    const glm::vec3 middle = of.middle - glm::vec3(view.position());
    const float above = glm::dot(middle, glm::vec3(view.normal()));
    if (!(above > 0 && glm::dot(middle, of.normal) < 0)) return false;
    const size_t first = of.first, count = edgesEnd(patch) - first;
    nearer.resize(count);
    const Middles middles{&x_[first], &y_[first], &z_[first], count};
    const Place from{glm::vec3(view.position()), glm::vec3(view.normal()) / above, glm::dot(middle, middle)};
    ofThisProcessor()(middles, from, nearer.data());
    return true;
}

void SunEdges::addTo(std::span<float> lux, const PointScene& scene, const PointView& view, uint32_t room,
                     const float* even) const {
    std::vector<float> nearer;
    for (size_t p = 0; p < patches_.size(); ++p) {
        const Patch& patch = patches_[p];
        const float share = even[patch.patch];
        if (share < kFar || scene.mesh().room[patch.patch] != room) continue; // through glass: from afar
        const size_t end = edgesEnd(p);
        // Not what of the share is seen through windows.
        const double straight = scene.factor(view, patch.patch);
        if (share >= kNear || isPartlyHidden(scene.mesh(), view, patch.patch, straight)) {
            addExactly(lux, view, patch.first, end, straight, glm::vec3(1));
        } else if (isCut(scene.mesh(), patch.patch, view)) {
            addAboveHorizon(lux, scene.mesh(), view, p, share);
        } else if (findNearer(view, p, nearer)) {
            for (size_t e = patch.first; e < end; ++e)
                if (const float more = nearer[e - patch.first]; std::abs(more) > kMuch)
                    addExactly(lux, view, e, e + 1, double{share}, glm::vec3(1));
                else
                    lux[hour_[e]] += share * (exitance_[e] * more - beyond_[e]);
        }
    }
}

bool SunEdges::isCut(const geometry::PatchMesh& mesh, uint32_t patch, const PointView& view) {
    double lowest = 0, highest = 0;
    for (const uint32_t v : mesh.patch(patch)) {
        const double height = glm::dot(mesh.vertices[v] - view.position(), view.normal());
        lowest = std::min(lowest, height), highest = std::max(highest, height);
    }
    return std::min(-lowest, highest) > kSliver * (highest - lowest);
}

bool SunEdges::isPartlyHidden(const geometry::PatchMesh& mesh, const PointView& view, uint32_t patch,
                              double straight) {
    return straight < (1 - kSliver) * openFactorOf(mesh, view, patch);
}

void SunEdges::addAboveHorizon(std::span<float> lux, const geometry::PatchMesh& mesh, const PointView& view,
                               size_t patch, float share) const {
    const double whole = openFactorOf(mesh, view, patches_[patch].patch);
    if (!(whole > 0)) return;
    std::vector<glm::dvec3> above;
    for (size_t e = patches_[patch].first; e < edgesEnd(patch); ++e) {
        double light = 0;
        for (const Part& part : partsOf(e))
            light += view.openFactor(cornersOf(part), above) * photometric(part.exitance);
        lux[hour_[e]] += share * (static_cast<float>(light / whole) - exitance_[e] - beyond_[e]);
    }
}

void SunEdges::addExactly(std::span<float> lux, const PointView& view, size_t first, size_t end,
                          double straight, glm::vec3 answer) const {
    for (size_t e = first; e < end; ++e) {
        glm::dvec3 more = -straight * glm::dvec3(colour_[e] + colourBeyond_[e]);
        for (const Part& part : partsOf(e)) more += view.factor(cornersOf(part)) * glm::dvec3(part.exitance);
        lux[hour_[e]] += static_cast<float>(photometric(answer * glm::vec3(more)));
    }
}

void SunEdges::addTo(std::span<float> lux, const PointScene& scene, const NearLight& near,
                     uint32_t room) const {
    std::vector<float> nearer;
    for (const NearLight::Cell& cell : near.cells) {
        const PointView view(scene.blockers(), cell.middle, cell.normal, room);
        const double answer = photometric(cell.answer);
        for (size_t p = 0; p < patches_.size(); ++p) {
            const Patch& patch = patches_[p];
            if (scene.mesh().room[patch.patch] != room || mostOf(patch, view) * answer < kFarOfCells)
                continue;
            const double straight = scene.factor(view, patch.patch);
            if (straight * answer < kFarOfCells) continue;
            if (straight >= double{kNear})
                addExactly(lux, view, patch.first, edgesEnd(p), straight, cell.answer);
            else if (findNearer(view, p, nearer))
                for (size_t k = 0; k < nearer.size(); ++k) {
                    const size_t e = patch.first + k;
                    const glm::vec3 more = nearer[k] * colour_[e] - colourBeyond_[e];
                    lux[hour_[e]] += static_cast<float>(straight * photometric(cell.answer * more));
                }
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
