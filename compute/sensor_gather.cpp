#include "compute/sensor_gather.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <glm/geometric.hpp>

#include "compute/hemicube.h"
#include "compute/parallel.h"

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
    constexpr int kDeepest = 16; // halvings; a cell at the point's feet has no end otherwise
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

void cornersOf(const geometry::PatchMesh& mesh, size_t patch, std::vector<dvec3>& corners) {
    corners.clear();
    for (uint32_t v : mesh.patch(patch)) corners.push_back(mesh.vertices[v]);
}

// One sensor's two rows.
void makeRows(const PointScene& scene, const PatchSlopes& slopes, const PointView& view, uint32_t room,
              float* even, float* smooth) {
    const geometry::PatchMesh& mesh = scene.mesh();
    std::vector<dvec3> corners;
    std::vector<PointView::Polygon> parts;
    const double least = scene.blockers().tolerance();
    for (size_t j = 0; j < mesh.patchCount(); ++j) {
        const PointScene::Patch& patch = scene.patches()[j];
        if (mesh.room[j] != room) continue;
        const dvec3 away = patch.centre - view.position();
        if (-glm::dot(away, patch.normal) <= least) continue; // seen from behind, or edge-on
        cornersOf(mesh, j, corners);
        const double distance = glm::length(away);
        const auto terms = slopes.terms(j);
        if (terms.empty() || patch.size < kFarSlope * distance) {
            const double factor = view.factor(corners);
            even[j] = static_cast<float>(factor);
            smooth[j] += even[j];
            continue;
        }
        const double factor = view.factor(corners, parts);
        if (factor <= 0) continue;
        even[j] = static_cast<float>(factor);
        smooth[j] += even[j];
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

PointScene::PointScene(const geometry::PatchMesh& mesh) : mesh_(&mesh), blockers_(mesh) {
    std::vector<uint32_t> group(mesh.patchCount(), kNoGroup);
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        patches_.push_back({geometry::patchCentroid(mesh, i), geometry::patchNormal(mesh, i),
                            std::sqrt(geometry::patchArea(mesh, i))});
        if (mesh.twin[i] == geometry::kNoTwin && mesh.materials[mesh.material[i]].isOpening())
            group[i] = mesh.material[i];
    }
    openings_ = mergedRegions(mesh, group, 16);
    for (const geometry::Material& material : mesh.materials) windows_.emplace_back(material);
}

void PointScene::seeSky(const PointView& view, uint32_t room, double angle,
                        std::vector<SkySample>& samples) const {
    std::vector<PointView::Polygon> parts;
    PointView::Polygon halves[2];
    for (const ConvexRegion& opening : openings_) {
        if (opening.room != room || !windows_[opening.group].passesStraight()) continue;
        const dvec3 normal = glm::normalize(
            glm::cross(opening.corners[1] - opening.corners[0], opening.corners[2] - opening.corners[0]));
        if (glm::dot(view.position() - opening.corners[0], normal) <= blockers_.tolerance()) continue;
        if (view.factor(opening.corners, parts) <= 0) continue;
        const daylight::Window& window = windows_[opening.group];
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
                    const dvec3 through =
                        greyGlass ? dvec3(daylight::slabTransmittance(-glm::dot(direction, normal), t.x,
                                                                      glazing.refractiveIndex))
                                  : window.straight(direction, normal);
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
        makeRows(scene, slopes, view, room, &gather.even[s * n], &gather.smooth[s * n]);
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
        if (even[lit.patch] < kEdgeShare) continue;
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
