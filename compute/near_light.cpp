// E. Nystroem, Ueber die praktische Aufloesung von Integralgleichungen, Acta Mathematica 54, 1930.
#include "compute/near_light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

#include "geometry/segment_distance.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

constexpr double kAngle = 2.2;    // of a triangle, seen from the sensor
constexpr double kFinest = 0.01;  // of a patch's size: smallest distance that counts
constexpr double kSkyAngle = 0.4; // radians, of one sample of sky
constexpr SlopeDetail kDetail{.angle = 0.8, .farSize = 0.2}; // of many cells, whose errors differ
constexpr int kRounds = 12; // of light to and fro: what is left is reflectance to this power

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

bool isInReach(const PointScene& scene, const NearWalls& walls, dvec3 sensor, uint32_t patch,
               const std::array<dvec3, 3>& triangle) {
    const double reach = walls.reach * scene.patches()[patch].size;
    // No point of a triangle lies farther from a corner than another corner: most are seen so to be too far.
    const auto& [a, b, c] = triangle;
    if (glm::length(sensor - a) - std::max(glm::length(b - a), glm::length(c - a)) > 1.001 * reach)
        return false;
    return distanceTo(sensor, triangle) < reach;
}

// Fans of triangles.
template<class Take> void forTriangles(const geometry::PatchMesh& mesh, uint32_t patch, const Take& take) {
    const auto corners = mesh.patch(patch);
    for (size_t k = 1; k + 1 < corners.size(); ++k)
        take(std::array<dvec3, 3>{mesh.vertices[corners[0]], mesh.vertices[corners[k]],
                                  mesh.vertices[corners[k + 1]]});
}

std::vector<Cell> cellsAround(const PointScene& scene, const NearWalls& walls, dvec3 sensor, uint32_t room) {
    const geometry::PatchMesh& mesh = scene.mesh();
    std::vector<Cell> cells;
    for (uint32_t j = 0; j < mesh.patchCount(); ++j) {
        if (mesh.room[j] != room || mesh.materials[mesh.material[j]].isOpening()) continue;
        forTriangles(mesh, j, [&](const std::array<dvec3, 3>& t) {
            if (isInReach(scene, walls, sensor, j, t))
                takeApart(sensor, j, kFinest * scene.patches()[j].size, t, 24, cells);
        });
    }
    return cells;
}

// Lux at the sensor for each lux that the rest of the room sends to a cell, light to and fro included.
std::vector<dvec3> answersOf(const PointScene& scene, const std::vector<Cell>& cells, const PointView& sensor,
                             std::span<const PointView> views, std::span<const dvec3> reflectance) {
    const size_t count = cells.size();
    const auto faces = [&](const Cell& cell, dvec3 point) {
        return glm::dot(scene.patches()[cell.patch].normal, point - cell.middle) >
               scene.blockers().tolerance();
    };
    std::vector<double> exchange(count * count, 0); // [p][q]: what reaches p of what leaves q
    std::vector<dvec3> seen(count, dvec3(0)), answer, next(count);
    for (size_t p = 0; p < count; ++p) {
        if (faces(cells[p], sensor.position())) seen[p] = dvec3(sensor.factor(cells[p].corners));
        for (size_t q = 0; q < count; ++q)
            if (faces(cells[q], cells[p].middle)) exchange[p * count + q] = views[p].factor(cells[q].corners);
    }
    answer = seen;
    for (int round = 0; round < kRounds; ++round) {
        next = seen;
        for (size_t p = 0; p < count; ++p) {
            const dvec3 sent = reflectance[p] * answer[p];
            for (size_t q = 0; q < count; ++q) next[q] += exchange[p * count + q] * sent;
        }
        answer.swap(next);
    }
    return answer;
}

} // namespace

size_t NearLight::bytes() const {
    size_t floats = 0;
    for (int c = 0; c < 3; ++c) floats += smooth[c].size() + even[c].size() + slats[c].size();
    return floats * sizeof(float) + sky.size() * sizeof(SkySample) + walls.size() * sizeof(OutsideShare) +
           cells.size() * sizeof(Cell);
}

bool hasNearWall(const PointScene& scene, const NearWalls& walls, dvec3 position,
                 std::span<const float> even) {
    double together = 0;
    for (uint32_t j = 0; j < even.size(); ++j) {
        if (even[j] <= 0) continue;
        bool near = false;
        forTriangles(scene.mesh(), j,
                     [&](const std::array<dvec3, 3>& t) { near |= isInReach(scene, walls, position, j, t); });
        if (!near) continue;
        together += double{even[j]};
        if (double{even[j]} >= walls.one || together >= walls.together) return true;
    }
    return false;
}

NearLight nearLight(const PointScene& scene, const PatchSlopes& slopes, const SlatLobes& slats,
                    const NearWalls& walls, const NearPlace& place, uint32_t channels) {
    const auto& [position, normal, room] = place;
    const geometry::PatchMesh& mesh = scene.mesh();
    const size_t n = mesh.patchCount();
    const std::vector<Cell> cells = cellsAround(scene, walls, position, room);
    std::vector<PointView> views;
    std::vector<dvec3> reflectance;
    for (const Cell& cell : cells) {
        views.emplace_back(scene.blockers(), cell.middle, scene.patches()[cell.patch].normal, room);
        reflectance.emplace_back(mesh.materials[mesh.material[cell.patch]].reflectance);
    }
    const std::vector<dvec3> answers =
        answersOf(scene, cells, PointView(scene.blockers(), position, normal, room), views, reflectance);
    NearLight result;
    for (uint32_t c = 0; c < channels; ++c) {
        result.smooth[c].assign(n, 0), result.even[c].assign(n, 0);
        result.slats[c].assign(slats.rows(), 0);
    }
    std::vector<float> even, smooth;
    std::vector<TintedShare> tinted;
    dvec3 own(0);
    for (size_t p = 0; p < cells.size(); ++p) {
        const Cell& cell = cells[p];
        const dvec3 answer = answers[p], reflected = answer * reflectance[p];
        own += answer * dvec3(mesh.materials[mesh.material[cell.patch]].exitance);
        even.assign(n, 0), smooth.assign(n, 0), tinted.clear();
        scene.seePatches(views[p], room, slopes, even.data(), smooth.data(), tinted, kDetail);
        for (uint32_t c = 0; c < channels; ++c) {
            const auto axis = static_cast<int>(c);
            const auto times = static_cast<float>(reflected[axis]);
            for (size_t j = 0; j < n; ++j) {
                result.even[c][j] += times * even[j];
                result.smooth[c][j] += times * smooth[j];
            }
            if (channels == 3)
                for (const TintedShare& share : tinted) {
                    result.even[c][share.patch] += times * share.more[axis];
                    result.smooth[c][share.patch] += times * share.more[axis];
                }
            // What the mesh has there already.
            result.smooth[c][cell.patch] -= static_cast<float>(answer[axis]);
            const dvec3 away = cell.middle - scene.patches()[cell.patch].centre;
            for (const PatchSlopes::Term& term : slopes.terms(cell.patch))
                result.smooth[c][term.patch] -=
                    static_cast<float>(answer[axis] * glm::dot(away, dvec3(term.weight)));
        }
        slats.see(views[p], room, glm::vec3(reflected), {result.slats, channels});
        const size_t first = result.sky.size(), firstWall = result.walls.size();
        scene.seeSky(views[p], room, kSkyAngle, result.sky, &result.walls);
        for (size_t k = first; k < result.sky.size(); ++k) result.sky[k].weight *= glm::vec3(reflected);
        for (size_t k = firstWall; k < result.walls.size(); ++k)
            result.walls[k].weight *= glm::vec3(reflected);
        result.cells.push_back({cell.middle, scene.patches()[cell.patch].normal, glm::vec3(reflected)});
    }
    mergeShares(result.walls);
    result.own = glm::vec3(own);
    return result;
}

} // namespace heliodon::compute
