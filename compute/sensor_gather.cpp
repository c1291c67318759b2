#include "compute/sensor_gather.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include <glm/geometric.hpp>

#include "compute/hemicube.h"
#include "compute/lighting.h"
#include "compute/parallel.h"
#include "geometry/bounds.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSensorSkyAngle = 0.1, kPatchSkyAngle = 0.2; // radians, of one sample of sky
constexpr double kSlopeAngle = 0.3;                           // of one cell of a patch with a slope
constexpr double kFarSlope = 0.05;  // size over distance below which a slope across a patch averages out
constexpr float kEdgeShare = 2e-4F; // form factor below which an edge of sunlight averages out

// Cuts a convex polygon (relative to the point) into triangles that span less than `angle`, seen from the
// point; work(centre, weight) with weights in proportion to the cells' form factors.
template<class Work>
void forCells(std::span<const dvec3> polygon, dvec3 normal, double angle, const Work& work) {
    struct Triangle {
        dvec3 a, b, c;
        int depth;
    };
    // Halvings. The number of cells follows from the solid angle; those at the feet of a point that almost
    // touches the polygon are small.
    constexpr int kDeepest = 64;
    Triangle stack[kDeepest + 2];
    for (size_t k = 1; k + 1 < polygon.size(); ++k) {
        size_t top = 0;
        stack[top++] = {polygon[0], polygon[k], polygon[k + 1], 0};
        while (top > 0) {
            const Triangle t = stack[--top];
            const dvec3 centre = (t.a + t.b + t.c) / 3.0;
            const double distance2 = glm::dot(centre, centre);
            const double ab = glm::dot(t.b - t.a, t.b - t.a), bc = glm::dot(t.c - t.b, t.c - t.b),
                         ca = glm::dot(t.a - t.c, t.a - t.c), longest = std::max({ab, bc, ca});
            if (longest <= angle * angle * distance2 || t.depth >= kDeepest) {
                const dvec3 area = glm::cross(t.b - t.a, t.c - t.a);
                const double weight = std::abs(glm::dot(area, centre)) * glm::dot(centre, normal);
                if (weight > 0) work(centre, weight / (distance2 * distance2));
            } else if (longest == ab) {
                const dvec3 m = 0.5 * (t.a + t.b);
                stack[top++] = {t.a, m, t.c, t.depth + 1}, stack[top++] = {m, t.b, t.c, t.depth + 1};
            } else if (longest == bc) {
                const dvec3 m = 0.5 * (t.b + t.c);
                stack[top++] = {t.a, t.b, m, t.depth + 1}, stack[top++] = {t.a, m, t.c, t.depth + 1};
            } else {
                const dvec3 m = 0.5 * (t.c + t.a);
                stack[top++] = {t.a, t.b, m, t.depth + 1}, stack[top++] = {m, t.b, t.c, t.depth + 1};
            }
        }
    }
}

// The parts of a polygon above and below the horizontal plane through the point.
void splitAtHorizon(const PointView::Polygon& polygon, PointView::Polygon& sky, PointView::Polygon& ground) {
    sky.clear(), ground.clear();
    for (size_t k = 0; k < polygon.size(); ++k) {
        const dvec3 &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
        if (p.y >= 0) sky.push_back(p);
        if (p.y <= 0) ground.push_back(p);
        if ((p.y > 0 && q.y < 0) || (p.y < 0 && q.y > 0)) {
            dvec3 on = p + (q - p) * (p.y / (p.y - q.y));
            on.y = 0;
            sky.push_back(on), ground.push_back(on);
        }
    }
}

dvec3 normalOf(const ConvexRegion& region) {
    dvec3 sum(0);
    for (size_t k = 1; k + 1 < region.corners.size(); ++k)
        sum += glm::cross(region.corners[k] - region.corners[0], region.corners[k + 1] - region.corners[0]);
    return glm::normalize(sum);
}

// What of a convex polygon lies more than `least` behind a plane.
void behind(std::span<const dvec3> polygon, dvec3 origin, dvec3 normal, double least,
            PointView::Polygon& result) {
    result.clear();
    const auto depth = [&](dvec3 p) { return glm::dot(origin - p, normal) - least; };
    for (size_t k = 0; k < polygon.size(); ++k) {
        const dvec3 &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
        const double dp = depth(p), dq = depth(q);
        if (dp >= 0) result.push_back(p);
        if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0)) result.push_back(p + (q - p) * (dp / (dp - dq)));
    }
}

void cornersOf(const geometry::PatchMesh& mesh, size_t patch, std::vector<dvec3>& corners) {
    corners.clear();
    for (uint32_t v : mesh.patch(patch)) corners.push_back(mesh.vertices[v]);
}

// One sensor's two rows, as far as they are about patches of one room.
void makeRows(const PointScene& scene, const PatchSlopes& slopes, const PointView& view,
              const RoomBeyond& beyond, float* even, float* smooth) {
    const geometry::PatchMesh& mesh = scene.mesh();
    std::vector<dvec3> corners;
    std::vector<PointView::Polygon> parts;
    const double least = scene.blockers().tolerance();
    for (size_t j = 0; j < mesh.patchCount(); ++j) {
        const PointScene::Patch& patch = scene.patches()[j];
        if (mesh.room[j] != beyond.room) continue;
        if (mesh.twin[j] != geometry::kNoTwin && isClear(mesh.materials[mesh.material[j]])) continue;
        const dvec3 away = patch.centre - view.position();
        if (-glm::dot(away, patch.normal) <= least) continue; // seen from behind, or edge-on
        cornersOf(mesh, j, corners);
        const double distance = glm::length(away);
        if (!beyond.panes.empty()) { // seen through glass, from afar: no slope
            const double factor = view.factor(corners, parts);
            if (factor <= 0) continue;
            dvec3 middle(0);
            for (const PointView::Polygon& part : parts)
                for (const dvec3& corner : part) middle += glm::normalize(corner) / double(part.size());
            const auto share =
                static_cast<float>(factor * photometric(glm::vec3(beyond.transmittance(middle))));
            even[j] += share, smooth[j] += share;
            continue;
        }
        const auto terms = slopes.terms(j);
        if (terms.empty() || patch.size < kFarSlope * distance) {
            const auto factor = static_cast<float>(view.factor(corners));
            even[j] += factor, smooth[j] += factor;
            continue;
        }
        const double factor = view.factor(corners, parts);
        if (factor <= 0) continue;
        even[j] += static_cast<float>(factor);
        smooth[j] += static_cast<float>(factor);
        dvec3 moment(0);
        double weights = 0;
        for (const PointView::Polygon& part : parts)
            forCells(part, view.normal(), kSlopeAngle, [&](dvec3 centre, double weight) {
                moment += weight * (centre - away);
                weights += weight;
            });
        if (weights <= 0) continue;
        moment *= factor / weights;
        for (const PatchSlopes::Term& term : terms)
            smooth[term.patch] += static_cast<float>(glm::dot(moment, dvec3(term.weight)));
    }
}

} // namespace

dvec3 RoomBeyond::transmittance(dvec3 direction) const {
    dvec3 through(1);
    const dvec3 towards = glm::normalize(direction);
    for (const Pane& pane : panes) through *= pane.window->straight(towards, pane.normal);
    return through;
}

PointScene::PointScene(const geometry::PatchMesh& mesh) : mesh_(&mesh), blockers_(mesh) {
    const size_t n = mesh.patchCount();
    std::vector<uint32_t> opening(n, kNoGroup), pane(n, kNoGroup), wall(n, kNoGroup);
    std::map<std::array<uint32_t, 2>, uint32_t> links; // material, room beyond
    for (size_t i = 0; i < n; ++i) {
        patches_.push_back({geometry::patchCentroid(mesh, i), geometry::patchNormal(mesh, i),
                            std::sqrt(geometry::patchArea(mesh, i))});
        const geometry::Material& material = mesh.materials[mesh.material[i]];
        if (!material.isOpening())
            wall[i] = 0;
        else if (mesh.twin[i] == geometry::kNoTwin)
            opening[i] = mesh.material[i];
        else if (isClear(material))
            pane[i] = links
                          .try_emplace({mesh.material[i], mesh.room[static_cast<size_t>(mesh.twin[i])]},
                                       links.size())
                          .first->second;
    }
    for (const geometry::Material& material : mesh.materials) windows_.emplace_back(material);
    std::vector<std::array<uint32_t, 2>> linkOf(links.size());
    for (const auto& [link, id] : links) linkOf[id] = link;
    for (ConvexRegion& region : mergedRegions(mesh, pane, 16)) {
        const auto& [material, room] = linkOf[region.group];
        const dvec3 normal = normalOf(region);
        panes_.push_back({std::move(region), &windows_[material], normal, room});
    }
    const std::vector<ConvexRegion> walls = mergedRegions(mesh, wall, 16);
    const double samePlane = kSamePlane * geometry::boundsOf(mesh.vertices).diagonal();
    for (ConvexRegion& region : mergedRegions(mesh, opening, 16)) {
        Opening found{std::move(region), {}, {}};
        found.normal = normalOf(found.region);
        PointView::Polygon outside;
        for (const ConvexRegion& other : walls) {
            behind(other.corners, found.region.corners[0], found.normal, samePlane, outside);
            if (outside.size() >= 3) found.hiddenBy.push_back(outside);
        }
        openings_.push_back(std::move(found));
    }
}

template<class Work>
void PointScene::forRoomsSeen(const PointView& view, const RoomBeyond& here, const Work& work) const {
    constexpr size_t kMostPanes = 4;
    work(view, here);
    if (here.panes.size() >= kMostPanes) return;
    std::vector<PointView::Polygon> parts, far;
    for (const Pane& pane : panes_) {
        if (pane.region.room != here.room ||
            glm::dot(view.position() - pane.region.corners[0], pane.normal) <= blockers_.tolerance() ||
            view.factor(pane.region.corners, parts) <= 0)
            continue;
        RoomBeyond next{pane.roomBeyond, here.panes};
        next.panes.push_back({pane.window, pane.normal});
        for (const PointView::Polygon& part : parts) {
            // The glass in the wall's other face bounds what is seen too.
            const PointView framed = view.through(blockers_, part, pane.roomBeyond);
            for (const Pane& twin : panes_) {
                if (twin.region.room != pane.roomBeyond || twin.roomBeyond != here.room) continue;
                if (glm::dot(twin.normal, pane.normal) > -0.999) continue;
                if (framed.factor(twin.region.corners, far) <= 0) continue;
                for (const PointView::Polygon& frame : far)
                    forRoomsSeen(view.through(blockers_, frame, pane.roomBeyond), next, work);
            }
        }
    }
}

void PointScene::seeSky(const PointView& view, uint32_t room, double angle,
                        std::vector<SkySample>& samples) const {
    forRoomsSeen(view, {room, {}}, [&](const PointView& seen, const RoomBeyond& beyond) {
        skyOf(seen, beyond, angle, samples);
    });
}

void PointScene::seePatches(const PointView& view, uint32_t room, const PatchSlopes& slopes, float* even,
                            float* smooth) const {
    forRoomsSeen(view, {room, {}}, [&](const PointView& seen, const RoomBeyond& beyond) {
        makeRows(*this, slopes, seen, beyond, even, smooth);
    });
}

void PointScene::skyOf(const PointView& view, const RoomBeyond& beyond, double angle,
                       std::vector<SkySample>& samples) const {
    std::vector<PointView::Polygon> parts;
    PointView::Polygon halves[2];
    for (const Opening& opening : openings_) {
        const daylight::Window& window = windows_[opening.region.group];
        if (opening.region.room != beyond.room || !window.passesStraight()) continue;
        const dvec3 normal = opening.normal;
        if (glm::dot(view.position() - opening.region.corners[0], normal) <= blockers_.tolerance()) continue;
        if (view.factor(opening.region.corners, parts) <= 0) continue;
        for (const PointView::Polygon& wall : opening.hiddenBy) view.hideBeyond(wall, parts);
        const daylight::Glazing& glazing = window.glazing();
        const glm::dvec3 t = glazing.transmissivity;
        const bool greyGlass = t.x == t.y && t.y == t.z && !glazing.isHole() && !window.hasBlind();
        for (const PointView::Polygon& part : parts) {
            splitAtHorizon(part, halves[0], halves[1]);
            for (size_t half = 0; half < 2; ++half) {
                if (halves[half].size() < 3) continue;
                const double factor = view.unhinderedFactor(halves[half]);
                const size_t first = samples.size();
                double weights = 0;
                forCells(halves[half], view.normal(), angle, [&](dvec3 centre, double weight) {
                    const dvec3 direction = glm::normalize(centre);
                    dvec3 through = greyGlass
                                        ? dvec3(daylight::slabTransmittance(-glm::dot(direction, normal), t.x,
                                                                            glazing.refractiveIndex))
                                        : window.straight(direction, normal);
                    if (!beyond.panes.empty()) through *= beyond.transmittance(direction);
                    samples.push_back({glm::vec3(direction), glm::vec3(weight * through)});
                    weights += weight;
                });
                // The cells' shares come from cubature, their sum from Lambert's formula.
                const auto scale = static_cast<float>(weights > 0 ? kPi * factor / weights : 0);
                for (size_t k = first; k < samples.size(); ++k) {
                    samples[k].weight *= scale;
                    if (half == 1) samples[k].direction.y = std::min(samples[k].direction.y, 0.0f);
                }
            }
        }
    }
}

std::vector<float> skyCoefficients(const SkyView& view, const daylight::SkyPatches& sky, uint32_t channels,
                                   std::span<const uint32_t> pointsOfRow) {
    const size_t elements = sky.elementCount();
    std::vector<float> rows(pointsOfRow.size() * channels * elements);
    std::vector<size_t> firstPoint(pointsOfRow.size() + 1);
    for (size_t r = 0; r < pointsOfRow.size(); ++r) firstPoint[r + 1] = firstPoint[r] + pointsOfRow[r];
    inParallel(pointsOfRow.size(), [&](size_t r) {
        for (size_t p = firstPoint[r]; p < firstPoint[r + 1]; ++p)
            for (const SkySample& sample : view.of(p)) {
                const size_t element =
                    sample.direction.y > 0 ? sky.elementOf(dvec3(sample.direction)) : sky.groundElement();
                for (uint32_t c = 0; c < channels; ++c)
                    rows[(r * channels + c) * elements + element] +=
                        sample.weight[static_cast<int>(c)] / static_cast<float>(kPi * pointsOfRow[r]);
            }
    });
    return rows;
}

std::vector<float> patchSkyCoefficients(const PointScene& scene, const daylight::SkyPatches& sky,
                                        uint32_t channels) {
    const geometry::PatchMesh& mesh = scene.mesh();
    const size_t n = mesh.patchCount(), elements = sky.elementCount();
    const PatchViewpoints views = patchViewpoints(mesh, 4);
    const uint32_t points = views.pointsPerPatch;
    std::vector<float> rows(n * channels * elements);
    inParallel(n, [&](size_t i) {
        SkyView seen;
        seen.first.assign(1, 0);
        seen.samples.clear();
        for (uint32_t p = 0; p < points; ++p) {
            const Viewpoint& v = views.viewpoints[i * points + p];
            scene.seeSky(PointView(scene.blockers(), v.position, v.normal, v.room), v.room, kPatchSkyAngle,
                         seen.samples);
            seen.first.push_back(seen.samples.size());
        }
        const std::vector<float> row = skyCoefficients(seen, sky, channels, {&points, 1});
        std::copy(row.begin(), row.end(), rows.begin() + static_cast<std::ptrdiff_t>(i * row.size()));
    });
    return rows;
}

SensorGather gatherSensors(const PointScene& scene, const PatchSlopes& slopes, std::vector<Sensor> sensors,
                           const daylight::SkyPatches& sky, uint32_t channels) {
    const geometry::PatchMesh& mesh = scene.mesh();
    const size_t n = mesh.patchCount(), count = sensors.size();
    SensorGather gather;
    gather.room.resize(count);
    gather.even.assign(count * n, 0);
    gather.smooth.assign(count * n, 0);
    std::vector<std::vector<SkySample>> samples(count);
    inParallel(count, [&](size_t s) {
        sensors[s].normal = glm::normalize(sensors[s].normal);
        const uint32_t room = roomOfPoint(mesh, sensors[s].position, sensors[s].normal);
        gather.room[s] = room;
        if (room == kNoRoom) return;
        const PointView view(scene.blockers(), sensors[s].position, sensors[s].normal, room);
        scene.seePatches(view, room, slopes, &gather.even[s * n], &gather.smooth[s * n]);
        scene.seeSky(view, room, kSensorSkyAngle, samples[s]);
    });
    for (std::vector<SkySample>& of : samples) {
        gather.sky.samples.insert(gather.sky.samples.end(), of.begin(), of.end());
        gather.sky.first.push_back(gather.sky.samples.size());
    }
    gather.skyCoefficients = skyCoefficients(gather.sky, sky, channels, std::vector<uint32_t>(count, 1));
    gather.sensors = std::move(sensors);
    return gather;
}

glm::vec3 sunEdges(const PointScene& scene, const SensorGather& gather, size_t sensor,
                   std::span<const SunlitParts> partly, double strength,
                   std::span<const glm::vec3> firstBounce) {
    dvec3 sum(0);
    if (gather.room[sensor] == kNoRoom) return glm::vec3(0);
    const size_t n = scene.mesh().patchCount();
    const Sensor& at = gather.sensors[sensor];
    const float* even = &gather.even[sensor * n];
    std::optional<PointView> view; // most sensors see most edges from afar
    for (const SunlitParts& lit : partly) {
        if (even[lit.patch] < kEdgeShare || scene.mesh().room[lit.patch] != gather.room[sensor]) continue;
        if (!view) view.emplace(scene.blockers(), at.position, at.normal, gather.room[sensor]);
        const geometry::Material& material = scene.mesh().materials[scene.mesh().material[lit.patch]];
        dvec3 light(0);
        for (const SunlitParts::Part& part : lit.parts)
            light += view->factor(part.polygon) * dvec3(part.light);
        sum += strength * dvec3(material.reflectance) * light -
               double{even[lit.patch]} * dvec3(firstBounce[lit.patch]);
    }
    return glm::vec3(sum);
}

} // namespace heliodon::compute
