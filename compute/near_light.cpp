// E. Nystroem, Ueber die praktische Aufloesung von Integralgleichungen, Acta Mathematica 54, 1930.
#include "compute/near_light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

#include "compute/parallel.h"
#include "compute/stopwatch.h"
#include "geometry/segment_distance.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

constexpr float kNear = 0.2f;     // share of the view that makes a patch near
constexpr double kReach = 0.7;    // patches nearer than this times their size are taken apart
constexpr double kAngle = 2.2;    // of a triangle, seen from the sensor
constexpr double kFinest = 0.01;  // of a patch's size: smallest distance that counts
constexpr double kSkyAngle = 0.4; // radians, of one sample of sky
constexpr int kRounds = 12;       // of light to and fro: what is left is reflectance to this power

struct Cell {
    uint32_t patch;
    std::array<dvec3, 3> corners; // world
    dvec3 middle{0};
};

double distanceTo(dvec3 p, const std::array<dvec3, 3>& t) {
    // To the nearest of some points of it: good enough for grading.
    double least = glm::length(p - (t[0] + t[1] + t[2]) / 3.0);
    for (size_t k = 0; k < 3; ++k) {
        least = std::min(least, geometry::distanceToSegment(p, t[k], t[(k + 1) % 3]));
    }
    const dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
    const double twice = glm::length(normal);
    if (!(twice > 0)) return least;
    bool inside = true;
    for (size_t k = 0; k < 3; ++k)
        inside &= glm::dot(glm::cross(t[(k + 1) % 3] - t[k], p - t[k]), normal) >= 0;
    return inside ? std::min(least, std::abs(glm::dot(p - t[0], normal)) / twice) : least;
}

void takeApart(dvec3 sensor, uint32_t patch, double finest, const std::array<dvec3, 3>& t, int depth,
               std::vector<Cell>& cells) {
    size_t longest = 0;
    double edge2 = 0;
    for (size_t k = 0; k < 3; ++k) {
        const dvec3 d = t[(k + 1) % 3] - t[k];
        if (glm::dot(d, d) > edge2) edge2 = glm::dot(d, d), longest = k;
    }
    const double allowed = kAngle * std::max(finest, distanceTo(sensor, t));
    if (edge2 <= allowed * allowed || depth == 0) {
        cells.push_back({patch, t, (t[0] + t[1] + t[2]) / 3.0});
        return;
    }
    const dvec3 a = t[longest], b = t[(longest + 1) % 3], c = t[(longest + 2) % 3], m = 0.5 * (a + b);
    takeApart(sensor, patch, finest, {a, m, c}, depth - 1, cells);
    takeApart(sensor, patch, finest, {m, b, c}, depth - 1, cells);
}

bool isInReach(const PointScene& scene, dvec3 sensor, uint32_t patch, const std::array<dvec3, 3>& triangle) {
    return distanceTo(sensor, triangle) < kReach * scene.patches()[patch].size;
}

// Fans of triangles.
template<class Take> void forTriangles(const geometry::PatchMesh& mesh, uint32_t patch, const Take& take) {
    const auto corners = mesh.patch(patch);
    for (size_t k = 1; k + 1 < corners.size(); ++k)
        take(std::array<dvec3, 3>{mesh.vertices[corners[0]], mesh.vertices[corners[k]],
                                  mesh.vertices[corners[k + 1]]});
}

class Corner {
public:
    Corner(const PointScene& scene, const PatchSlopes& slopes, const daylight::Sky& sky, const Moment& moment)
        : scene_(scene), slopes_(slopes), sky_(sky), moment_(moment), mesh_(scene.mesh()) {}

    // What the sensor's light lacks, lux.
    dvec3 correction(const Sensor& sensor, uint32_t room) {
        cells_.clear();
        for (uint32_t j = 0; j < mesh_.patchCount(); ++j)
            if (mesh_.room[j] == room && !mesh_.materials[mesh_.material[j]].isOpening()) addPatch(sensor, j);
        const size_t count = cells_.size();
        const PointView view(scene_.blockers(), sensor.position, sensor.normal, room);
        std::vector<double> seen(count);
        std::vector<PointView> views;
        for (size_t p = 0; p < count; ++p) {
            seen[p] = faces(cells_[p], sensor.position) ? view.factor(cells_[p].corners) : 0;
            views.emplace_back(scene_.blockers(), cells_[p].middle, scene_.patches()[cells_[p].patch].normal,
                               room);
        }
        std::vector<double> exchange(count * count);
        for (size_t p = 0; p < count; ++p)
            for (size_t q = 0; q < count; ++q)
                if (faces(cells_[q], cells_[p].middle))
                    exchange[p * count + q] = views[p].factor(cells_[q].corners);
        std::vector<dvec3> gathered(count), lack(count, dvec3(0)), next(count);
        for (size_t p = 0; p < count; ++p) gathered[p] = lackBefore(cells_[p], views[p], room);
        for (int round = 0; round < kRounds; ++round) {
            for (size_t p = 0; p < count; ++p) {
                dvec3 more(0);
                for (size_t q = 0; q < count; ++q) more += exchange[p * count + q] * lack[q];
                next[p] = gathered[p] + reflectance(cells_[p].patch) * more;
            }
            lack.swap(next);
        }
        dvec3 sum(0);
        for (size_t p = 0; p < count; ++p) sum += seen[p] * lack[p];
        return sum;
    }

private:
    dvec3 reflectance(uint32_t patch) const {
        return dvec3(mesh_.materials[mesh_.material[patch]].reflectance);
    }
    bool faces(const Cell& cell, dvec3 point) const {
        return glm::dot(scene_.patches()[cell.patch].normal, point - cell.middle) >
               scene_.blockers().tolerance();
    }
    // Exitance but for the sun's first bounce.
    dvec3 smooth(uint32_t patch) const {
        return dvec3(moment_.lighting.exitance[patch]) -
               reflectance(patch) * dvec3(moment_.patches[patch].sun);
    }

    void addPatch(const Sensor& sensor, uint32_t patch) {
        forTriangles(mesh_, patch, [&](const std::array<dvec3, 3>& t) {
            if (isInReach(scene_, sensor.position, patch, t))
                takeApart(sensor.position, patch, kFinest * scene_.patches()[patch].size, t, 24, cells_);
        });
    }

    // Exitance at the cell as gathered from the mesh, less what the mesh says that it is there.
    dvec3 lackBefore(const Cell& cell, const PointView& view, uint32_t room) {
        const size_t n = mesh_.patchCount();
        even_.assign(n, 0), smooth_.assign(n, 0), samples_.clear();
        scene_.seePatches(view, room, slopes_, even_.data(), smooth_.data());
        scene_.seeSky(view, room, kSkyAngle, samples_);
        dvec3 lux(0);
        for (uint32_t j = 0; j < n; ++j) {
            if (smooth_[j] != 0) lux += double{smooth_[j]} * smooth(j);
            if (even_[j] > 0) lux += double{even_[j]} * reflectance(j) * dvec3(moment_.patches[j].sun);
        }
        for (const SkySample& sample : samples_)
            lux += dvec3(sample.weight) * sky_.luminance(dvec3(sample.direction));
        dvec3 known = smooth(cell.patch);
        for (const PatchSlopes::Term& term : slopes_.terms(cell.patch))
            known += glm::dot(cell.middle - scene_.patches()[cell.patch].centre, dvec3(term.weight)) *
                     smooth(term.patch);
        const dvec3 own(mesh_.materials[mesh_.material[cell.patch]].exitance);
        return own + reflectance(cell.patch) * lux - known;
    }

    const PointScene& scene_;
    const PatchSlopes& slopes_;
    const daylight::Sky& sky_;
    const Moment& moment_;
    const geometry::PatchMesh& mesh_;
    std::vector<Cell> cells_;
    std::vector<float> even_, smooth_;
    std::vector<SkySample> samples_;
};

} // namespace

std::vector<uint8_t> nearWalls(const PointScene& scene, const SensorGather& sensors) {
    const size_t n = scene.mesh().patchCount();
    std::vector<uint8_t> found(sensors.sensors.size(), 0);
    inParallel(found.size(), [&](size_t s) {
        for (uint32_t j = 0; j < n && !found[s]; ++j)
            if (sensors.even[s * n + j] >= kNear)
                forTriangles(scene.mesh(), j, [&](const std::array<dvec3, 3>& t) {
                    found[s] |= isInReach(scene, sensors.sensors[s].position, j, t);
                });
    });
    return found;
}

void lightNearWalls(const PointScene& scene, const PatchSlopes& slopes, const SensorGather& sensors,
                    const daylight::Sky& sky, Moment& moment) {
    const Stopwatch clock;
    inParallel(sensors.sensors.size(), [&](size_t s) {
        if (!sensors.nearWall[s]) return;
        Corner corner(scene, slopes, sky, moment);
        moment.sensors[s].interreflected += glm::vec3(corner.correction(sensors.sensors[s], sensors.room[s]));
    });
    moment.report.sensorSeconds += clock.seconds();
}

} // namespace heliodon::compute
