#include "compute/sky_detail.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "compute/parallel.h"
#include "compute/point_view.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kAngle = 0.6;    // radians, of one sample
constexpr double kInward = 0.005; // of the way to a patch's middle; light jumps where surfaces touch
constexpr double kBent = 0.01;    // of the light there and the usual one, off linear: worth a grid

// Directions between which luminance is linear: rings from the horizon to the zenith, and the ground.
constexpr uint32_t kRing = 24, kRings = 7, kGround = kRing * kRings, kNodes = kGround + 1;

dvec3 direction(uint32_t node) {
    const double azimuth = 2 * kPi * (node % kRing) / kRing,
                 height = 0.5 * kPi * (node / kRing) / (kRings - 1);
    return {std::cos(height) * std::cos(azimuth), std::max(std::sin(height), 1e-6),
            std::cos(height) * std::sin(azimuth)};
}

using NodeWeights = std::array<glm::vec3, kNodes>;

void addTo(NodeWeights& sums, const SkySample& sample) {
    const glm::vec3 d = sample.direction;
    if (d.y <= 0) {
        sums[kGround] += sample.weight;
        return;
    }
    const auto turn = static_cast<float>(kRing / (2 * kPi)),
               rise = static_cast<float>((kRings - 1) / (0.5 * kPi));
    const float along = turn * std::atan2(d.z, d.x) + float(kRing),
                up = rise * std::asin(std::min(d.y, 1.0F));
    const auto column = static_cast<uint32_t>(along), ring = std::min(static_cast<uint32_t>(up), kRings - 2);
    const float right = along - float(column), above = up - float(ring);
    for (uint32_t k = 0; k < 4; ++k)
        sums[(ring + k / 2) * kRing + (column + k % 2) % kRing] +=
            (k / 2 ? above : 1 - above) * (k % 2 ? right : 1 - right) * sample.weight;
}

// The corners' values spread linearly over the triangles that drawMesh() fans a patch out into.
glm::vec3 linearMean(const geometry::PatchMesh& mesh, size_t patch, const glm::vec3* corners) {
    const std::vector<dvec3> at = geometry::patchCorners(mesh, patch);
    dvec3 sum(0);
    double whole = 1e-300;
    for (size_t c = 1; c + 1 < at.size(); ++c) {
        const double area = glm::length(glm::cross(at[c] - at[0], at[c + 1] - at[0]));
        sum += area / 3 * dvec3(corners[0] + corners[c] + corners[c + 1]);
        whole += area;
    }
    return glm::vec3(sum / whole);
}

} // namespace

SkyDetail::SkyDetail(const PointScene& scene) : scene_(&scene), pairOf_(scene.mesh().corners.size()) {
    const auto keep = [this](std::span<const Row> rows) {
        for (const Row& row : rows) {
            shares_.insert(shares_.end(), row.begin(), row.end());
            first_.push_back(shares_.size());
        }
    };
    const std::vector<Row> pairs = seenFromCorners();
    keep(pairs);
    const std::vector<std::vector<Row>> grids = seenFromGrids(pairs);
    for (uint32_t p = 0; p < grids.size(); ++p) {
        if (grids[p].empty()) continue;
        bent_.push_back(p);
        keep(grids[p]);
    }
}

std::vector<SkyDetail::Row> SkyDetail::seenFrom(uint32_t patch, const Blockers& blockers,
                                                std::span<const dvec3> points) const {
    const uint32_t room = scene_->mesh().room[patch];
    const PointScene::Patch& on = scene_->patches()[patch];
    std::vector<Row> rows;
    std::vector<SkySample> samples;
    for (const dvec3& point : points) {
        samples.clear();
        scene_->seeSky(PointView(blockers, glm::mix(point, on.centre, kInward), on.normal, room), room,
                       kAngle, samples);
        NodeWeights sums{};
        for (const SkySample& sample : samples) addTo(sums, sample);
        Row& row = rows.emplace_back();
        for (uint32_t node = 0; node < kNodes; ++node)
            if (sums[node] != glm::vec3(0)) row.push_back({node, sums[node]});
    }
    return rows;
}

double SkyDetail::underEvenSky(const Row& row) {
    double sum = 0;
    for (const Share& share : row) sum += photometric(share.weight);
    return sum;
}

std::vector<SkyDetail::Row> SkyDetail::seenFromCorners() {
    const geometry::PatchMesh& mesh = scene_->mesh();
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> numbers;
    std::vector<std::pair<uint32_t, dvec3>> places; // a patch of the pair, and the vertex
    for (uint32_t p = 0; p < mesh.patchCount(); ++p)
        for (uint32_t c = mesh.firstCorner[p]; c < mesh.firstCorner[p + 1]; ++c) {
            const auto [entry, fresh] =
                numbers.try_emplace({mesh.corners[c], mesh.surface[p]}, static_cast<uint32_t>(places.size()));
            if (fresh) places.emplace_back(p, mesh.vertices[mesh.corners[c]]);
            pairOf_[c] = entry->second;
        }
    std::vector<Row> rows(places.size());
    inParallel(places.size(), [&](size_t k) {
        const auto& [patch, vertex] = places[k];
        rows[k] = std::move(seenFrom(patch, scene_->blockersOfSky(patch), {&vertex, 1})[0]);
    });
    return rows;
}

double SkyDetail::meanOf(std::span<const double> atPairs) const {
    const geometry::PatchMesh& mesh = scene_->mesh();
    double light = 0, area = 0;
    for (size_t p = 0; p < mesh.patchCount(); ++p) {
        const double here = geometry::patchArea(mesh, p), corners = static_cast<double>(mesh.patch(p).size());
        for (uint32_t c = mesh.firstCorner[p]; c < mesh.firstCorner[p + 1]; ++c)
            light += here / corners * atPairs[pairOf_[c]];
        area += here;
    }
    return light / std::max(area, 1e-300);
}

bool SkyDetail::bends(uint32_t triangle, const Blockers& blockers, std::span<const double> atPairs,
                      double usual) const {
    const std::vector<dvec3> at = geometry::patchCorners(scene_->mesh(), triangle);
    const uint32_t* pair = &pairOf_[scene_->mesh().firstCorner[triangle]];
    const dvec3 corner(atPairs[pair[0]], atPairs[pair[1]], atPairs[pair[2]]);
    const dvec3 inside[]{{0.5, 0.5, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}, dvec3(1.0 / 3)};
    return std::ranges::any_of(inside, [&](const dvec3& w) {
        const dvec3 point = w.x * at[0] + w.y * at[1] + w.z * at[2];
        const double there = underEvenSky(seenFrom(triangle, blockers, {&point, 1})[0]);
        return std::abs(there - glm::dot(w, corner)) > kBent * (there + usual);
    });
}

std::vector<std::vector<SkyDetail::Row>> SkyDetail::seenFromGrids(std::span<const Row> pairs) const {
    const geometry::PatchMesh& mesh = scene_->mesh();
    std::vector<double> atPairs;
    for (const Row& row : pairs) atPairs.push_back(underEvenSky(row));
    const double usual = meanOf(atPairs);
    std::vector<std::vector<Row>> grids(mesh.patchCount());
    inParallel(grids.size(), [&](size_t i) {
        const auto p = static_cast<uint32_t>(i);
        if (mesh.patch(p).size() != 3 || mesh.materials[mesh.material[p]].isOpening()) return;
        const Blockers blockers = scene_->blockersOfSky(p);
        if (!bends(p, blockers, atPairs, usual)) return;
        const std::vector<dvec3> corner = geometry::patchCorners(mesh, p);
        grids[p] = seenFrom(p, blockers, PatchGlow::places(corner[0], corner[1], corner[2]));
    });
    return grids;
}

LightDetail SkyDetail::of(const daylight::Sky& sky) const {
    std::array<float, kNodes> luminance;
    for (uint32_t node = 0; node < kGround; ++node)
        luminance[node] = static_cast<float>(sky.luminance(direction(node)));
    luminance[kGround] = static_cast<float>(sky.ground.luminance);
    std::vector<glm::vec3> lux(first_.size() - 1);
    for (size_t k = 0; k < lux.size(); ++k)
        for (size_t s = first_[k]; s < first_[k + 1]; ++s)
            lux[k] += shares_[s].weight * luminance[shares_[s].node];
    const geometry::PatchMesh& mesh = scene_->mesh();
    LightDetail detail;
    for (const uint32_t pair : pairOf_) detail.corners.push_back(lux[pair]);
    for (size_t p = 0; p < mesh.patchCount(); ++p)
        detail.mean.push_back(linearMean(mesh, p, &detail.corners[mesh.firstCorner[p]]));
    size_t point = lux.size() - bent_.size() * io::kGlowPlaces;
    for (const uint32_t p : bent_) {
        PatchGlow& grid = detail.grids.emplace_back(p);
        const glm::vec3* corner = &detail.corners[mesh.firstCorner[p]];
        const auto linear = PatchGlow::places(corner[0], corner[1], corner[2]);
        for (size_t k = 0; k < linear.size(); ++k) grid.lux[k] = lux[point++] - linear[k];
        detail.mean[p] += grid.mean();
    }
    return detail;
}

} // namespace heliodon::compute
