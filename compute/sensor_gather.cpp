#include "compute/sensor_gather.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>

#include "compute/lighting.h"
#include "compute/parallel.h"
#include "compute/patch_points.h"
#include "compute/sun_edges.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSensorSkyAngle = 0.1, kPatchSkyAngle = 0.2; // radians, of one sample of sky
// Of how far a patch's points lie apart, what four of them may be off; change of a patch's light, over it and
// the usual one, from which it is told by more points; of the last change, what may be left.
constexpr double kCurved = 0.1, kSkyChange = 0.02, kChangeLeft = 0.5;

// What edges of sunlight on patches give less their patches' evenly spread sun, by way of the cells of near
// walls.
dvec3 sunEdgesOnCells(const PointScene& scene, const NearLight& near, uint32_t room,
                      std::span<const SunlitParts> partly, double strength,
                      std::span<const glm::vec3> firstBounce) {
    const geometry::PatchMesh& mesh = scene.mesh();
    dvec3 sum(0);
    for (const NearLight::Cell& cell : near.cells) {
        const PointView view(scene.blockers(), cell.middle, cell.normal, room);
        for (const SunlitParts& lit : partly) {
            if (mesh.room[lit.patch] != room) continue;
            const double whole = scene.factor(view, lit.patch);
            if (whole * photometric(cell.answer) < kEdgeOnCells) continue;
            dvec3 more = -whole * dvec3(firstBounce[lit.patch]);
            const dvec3 rho(mesh.materials[mesh.material[lit.patch]].reflectance);
            for (const SunlitParts::Part& part : lit.parts)
                more += strength * view.factor(part.polygon) * rho * dvec3(part.light);
            sum += dvec3(cell.answer) * more;
        }
    }
    return sum;
}

// Of a patch's points under an even sky and ground: their mean light, and how far apart the least and the
// most lit are.
struct Seen {
    double mean, range;
};
// Adds to `row`, channels x elements, and sets `walls`. What stands outside counts as no light: it is darker
// than the sky, and its edges are the sky's.
Seen skyFromPoints(const PointScene& scene, const Blockers& blockers, const daylight::SkyPatches& sky,
                   const PatchViewpoints& views, std::span<float> row, std::vector<OutsideShare>& walls) {
    const uint32_t points = views.pointsPerPatch;
    const auto scale = static_cast<float>(1 / (kPi * points));
    const size_t elements = sky.elementCount(), channels = row.size() / elements;
    double sum = 0, least = 1e300, most = 0;
    std::vector<SkySample> seen;
    walls.clear();
    for (const Viewpoint& v : views.viewpoints) {
        seen.clear();
        scene.seeSky(PointView(blockers, v.position, v.normal, v.room), v.room, kPatchSkyAngle, seen, &walls);
        double here = 0;
        for (const SkySample& sample : seen) {
            const size_t element = sky.elementOf(dvec3(sample.direction));
            for (size_t c = 0; c < channels; ++c)
                row[c * elements + element] += scale * sample.weight[static_cast<int>(c)];
            here += photometric(sample.weight);
        }
        sum += here, least = std::min(least, here), most = std::max(most, here);
    }
    mergeShares(walls);
    for (OutsideShare& share : walls) share.weight /= static_cast<float>(points);
    return {sum / points, most - least};
}

} // namespace

PatchSky patchSkyCoefficients(const PointScene& scene, const daylight::SkyPatches& sky, uint32_t channels) {
    const geometry::PatchMesh& mesh = scene.mesh();
    const size_t n = mesh.patchCount(), elements = sky.elementCount();
    PatchSky result{
        std::vector<float>(n * channels * elements), std::vector<float>(n, 0), std::vector<float>(n, 0), {}};
    std::vector<std::vector<OutsideShare>> walls(n);
    std::vector<double> mean(n), range(n);
    const auto row = [&](size_t i) {
        return std::span(result.coefficients).subspan(i * channels * elements, channels * elements);
    };
    const auto look = [&](size_t i, uint32_t points) {
        const auto patch = static_cast<uint32_t>(i);
        return skyFromPoints(scene, scene.blockersOfSky(patch), sky, patchViewpoints(mesh, points, patch, 1),
                             row(i), walls[i]);
    };
    inParallel(n, [&](size_t i) {
        const Seen seen = look(i, 4);
        mean[i] = seen.mean, range[i] = seen.range;
    });
    double light = 0, area = 0;
    for (size_t i = 0; i < n; ++i)
        light += geometry::patchArea(mesh, i) * mean[i], area += geometry::patchArea(mesh, i);
    const double usual = light / std::max(area, 1e-300);
    inParallel(n, [&](size_t i) {
        double change = kCurved * range[i];
        for (uint32_t points = 16; points <= 64 && change > kSkyChange * (mean[i] + usual); points *= 4) {
            std::ranges::fill(row(i), 0.0f);
            const double before = std::exchange(mean[i], look(i, points).mean);
            change = std::abs(mean[i] - before);
        }
        if (!(mean[i] > 0)) return;
        result.error[i] = static_cast<float>(std::min(1.0, kChangeLeft * change / mean[i]));
        result.range[i] = static_cast<float>(range[i] / mean[i]);
    });
    if (!scene.outside().cells().empty()) result.walls = std::move(walls);
    return result;
}

SensorGather gatherSensors(const PointScene& scene, const PatchSlopes& slopes, const SlatLobes& slats,
                           const NearWalls& nearWalls, std::vector<Sensor> sensors, uint32_t channels) {
    const geometry::PatchMesh& mesh = scene.mesh();
    const size_t n = mesh.patchCount(), count = sensors.size();
    SensorGather gather;
    gather.nearWalls = nearWalls;
    gather.room.resize(count);
    gather.even.assign(count * n, 0);
    gather.smooth.assign(count * n, 0);
    gather.tinted.resize(count);
    gather.nearWall.assign(count, 0);
    gather.near.resize(count);
    gather.slats.resize(count);
    gather.walls.resize(count);
    for (auto& rows : gather.slats)
        for (uint32_t c = 0; c < channels; ++c) rows[c].assign(slats.rows(), 0);
    std::vector<std::vector<SkySample>> samples(count);
    inParallel(count, [&](size_t s) {
        sensors[s].normal = glm::normalize(sensors[s].normal);
        const uint32_t room = roomOfPoint(mesh, sensors[s].position, sensors[s].normal);
        gather.room[s] = room;
        if (room == geometry::kNoRoom) return;
        const PointView view(scene.blockers(), sensors[s].position, sensors[s].normal, room);
        scene.seePatches(view, room, slopes, &gather.even[s * n], &gather.smooth[s * n], gather.tinted[s]);
        scene.seeSky(view, room, kSensorSkyAngle, samples[s], &gather.walls[s]);
        mergeShares(gather.walls[s]);
        slats.see(view, room, glm::vec3(1), {gather.slats[s].data(), channels});
        gather.nearWall[s] = hasNearWall(scene, nearWalls, sensors[s].position, {&gather.even[s * n], n});
    });
    for (std::vector<SkySample>& of : samples) {
        gather.sky.samples.insert(gather.sky.samples.end(), of.begin(), of.end());
        gather.sky.first.push_back(gather.sky.samples.size());
    }
    gather.sensors = std::move(sensors);
    return gather;
}

void findNearLight(const PointScene& scene, const PatchSlopes& slopes, const SlatLobes& slats,
                   uint32_t channels, SensorGather& gather, const std::function<void(size_t)>& done) {
    inParallel(
        gather.sensors.size(),
        [&](size_t s) {
            const Sensor& sensor = gather.sensors[s];
            if (gather.nearWall[s])
                gather.near[s] = nearLight(scene, slopes, slats, gather.nearWalls,
                                           {sensor.position, sensor.normal, gather.room[s]}, channels);
        },
        done);
}

glm::vec3 sunEdges(const PointScene& scene, const SensorGather& gather, size_t sensor,
                   std::span<const SunlitParts> partly, double strength,
                   std::span<const glm::vec3> firstBounce) {
    dvec3 sum(0);
    if (gather.room[sensor] == geometry::kNoRoom) return glm::vec3(0);
    const geometry::PatchMesh& mesh = scene.mesh();
    const Sensor& at = gather.sensors[sensor];
    const float* even = &gather.even[sensor * mesh.patchCount()];
    std::vector<const SunlitParts*> seen; // most sensors see most edges from afar
    for (const SunlitParts& lit : partly)
        if (even[lit.patch] >= kEdgeShare) {
            seen.push_back(&lit);
            sum -= double{even[lit.patch]} * dvec3(firstBounce[lit.patch]);
        }
    if (const std::vector<TintedShare>& tinted = gather.tinted[sensor]; !tinted.empty() && !seen.empty()) {
        std::vector<char> isSeen(mesh.patchCount(), 0);
        for (const SunlitParts* lit : seen) isSeen[lit->patch] = 1;
        for (const TintedShare& share : tinted)
            if (isSeen[share.patch]) sum -= dvec3(share.more) * dvec3(firstBounce[share.patch]);
    }
    if (const NearLight& near = gather.near[sensor]; !near.isEmpty())
        sum += sunEdgesOnCells(scene, near, gather.room[sensor], partly, strength, firstBounce);
    if (seen.empty()) return glm::vec3(sum);
    const PointView view(scene.blockers(), at.position, at.normal, gather.room[sensor]);
    scene.forRoomsSeen(view, gather.room[sensor], [&](const PointView& from, const RoomBeyond& beyond) {
        for (const SunlitParts* lit : seen) {
            if (mesh.room[lit->patch] != beyond.room) continue;
            const dvec3 rho(mesh.materials[mesh.material[lit->patch]].reflectance);
            for (const SunlitParts::Part& part : lit->parts) {
                dvec3 factor(from.factor(part.polygon));
                if (factor.x > 0 && !beyond.panes.empty())
                    factor *= beyond.transmittance(part.polygon[0] - at.position);
                sum += strength * factor * rho * dvec3(part.light);
            }
        }
    });
    return glm::vec3(sum);
}

} // namespace heliodon::compute
