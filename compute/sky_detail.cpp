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
constexpr double kAngle = 0.3, kRoughAngle = 0.5; // radians, of one sample; to find where light bends
constexpr double kInward = 0.005; // of the way to a patch's middle; light jumps where surfaces touch
constexpr double kBent = 0.05;    // of the light there and the usual one, off linear: worth a grid

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
    const std::vector<Row> pairs = seenFromCorners();
    bent_ = bentPatches(pairs);
    for (const std::vector<Row>& rows : {pairs, seenFromGrids()})
        for (const Row& row : rows) {
            shares_.insert(shares_.end(), row.begin(), row.end());
            first_.push_back(shares_.size());
        }
}

std::vector<SkyDetail::Row> SkyDetail::seenFrom(uint32_t patch, std::span<const dvec3> points,
                                                double angle) const {
    const uint32_t room = scene_->mesh().room[patch];
    const PointScene::Patch& on = scene_->patches()[patch];
    const Blockers blockers = scene_->blockersOfSky(patch);
    std::vector<Row> rows;
    std::vector<SkySample> samples;
    for (const dvec3& point : points) {
        samples.clear();
        scene_->seeSky(PointView(blockers, glm::mix(point, on.centre, kInward), on.normal, room), room, angle,
                       samples);
        NodeWeights sums{};
        for (const SkySample& sample : samples) addTo(sums, sample);
        Row& row = rows.emplace_back();
        for (uint32_t node = 0; node < kNodes; ++node)
            if (sums[node] != glm::vec3(0)) row.push_back({node, sums[node]});
    }
    return rows;
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
        rows[k] = std::move(seenFrom(places[k].first, {&places[k].second, 1}, kAngle)[0]);
    });
    return rows;
}

std::vector<uint32_t> SkyDetail::bentPatches(std::span<const Row> pairs) const {
    const geometry::PatchMesh& mesh = scene_->mesh();
    const size_t n = mesh.patchCount();
    const auto underEvenSky = [](const Row& row) {
        double sum = 0;
        for (const Share& share : row) sum += photometric(share.weight);
        return sum;
    };
    std::vector<double> atPair;
    for (const Row& row : pairs) atPair.push_back(underEvenSky(row));
    double light = 0, area = 0;
    for (size_t p = 0; p < n; ++p) {
        const double here = geometry::patchArea(mesh, p), corners = static_cast<double>(mesh.patch(p).size());
        for (uint32_t c = mesh.firstCorner[p]; c < mesh.firstCorner[p + 1]; ++c)
            light += here / corners * atPair[pairOf_[c]];
        area += here;
    }
    const double usual = light / std::max(area, 1e-300);
    std::vector<char> bends(n, 0);
    inParallel(n, [&](size_t p) {
        if (mesh.patch(p).size() != 3 || mesh.materials[mesh.material[p]].isOpening()) return;
        const std::vector<dvec3> at = geometry::patchCorners(mesh, p);
        const uint32_t* pair = &pairOf_[mesh.firstCorner[p]];
        const dvec3 corner(atPair[pair[0]], atPair[pair[1]], atPair[pair[2]]);
        const dvec3 inside[]{{0.5, 0.5, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}, dvec3(1.0 / 3)};
        std::vector<dvec3> points;
        for (const dvec3& w : inside) points.push_back(w.x * at[0] + w.y * at[1] + w.z * at[2]);
        const std::vector<Row> seen = seenFrom(static_cast<uint32_t>(p), points, kRoughAngle);
        for (size_t k = 0; k < points.size(); ++k) {
            const double there = underEvenSky(seen[k]);
            bends[p] |= std::abs(there - glm::dot(inside[k], corner)) > kBent * (there + usual);
        }
    });
    std::vector<uint32_t> found;
    for (uint32_t p = 0; p < n; ++p)
        if (bends[p]) found.push_back(p);
    return found;
}

std::vector<SkyDetail::Row> SkyDetail::seenFromGrids() const {
    std::vector<Row> rows(bent_.size() * io::kGlowPlaces);
    inParallel(bent_.size(), [&](size_t b) {
        const std::vector<dvec3> corner = geometry::patchCorners(scene_->mesh(), bent_[b]);
        std::vector<dvec3> points;
        for (int j = 0; j <= PatchGlow::kCells; ++j)
            for (int i = 0; i + j <= PatchGlow::kCells; ++i)
                points.push_back(PatchGlow::place(corner[0], corner[1], corner[2], i, j));
        std::ranges::move(seenFrom(bent_[b], points, kAngle),
                          rows.begin() + static_cast<std::ptrdiff_t>(b * io::kGlowPlaces));
    });
    return rows;
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
        size_t place = 0;
        for (int j = 0; j <= PatchGlow::kCells; ++j)
            for (int i = 0; i + j <= PatchGlow::kCells; ++i)
                grid.lux[place++] = lux[point++] - PatchGlow::place(corner[0], corner[1], corner[2], i, j);
        detail.mean[p] += grid.mean();
    }
    return detail;
}

} // namespace heliodon::compute
