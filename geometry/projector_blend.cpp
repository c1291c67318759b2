#include "geometry/projector_blend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/segment_distance.h"

namespace heliodon::geometry {

namespace {

constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

double smooth(double x) {
    return x * x * (3 - 2 * x);
}

// By the distances to where another goes on, and to where the surface ends before what lies behind.
double fadeAt(double distance, double end) {
    const double beyond = std::max(distance - kBlendGuard, 0.0) / (kBlendFalloff - kBlendGuard),
                 x = std::clamp(beyond + kBlendLeastSlope * distance / kBlendFalloff, kBlendLeastFade, 1.0);
    return smooth(x) * glm::mix(kBlendEndFade, 1.0, smooth(end / kBlendFalloff));
}

// Per side of each triangle, the triangle of the surface beyond it, or kNone.
std::vector<std::array<uint32_t, 3>> neighboursOf(const ProjectorMesh& mesh) {
    std::vector<std::array<uint32_t, 3>> beyond(mesh.triangleCount(), {kNone, kNone, kNone});
    std::unordered_map<uint64_t, uint32_t> sides; // directed edge -> 3 triangle + side
    sides.reserve(mesh.triangles.size());
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const uint32_t first = i - i % 3, a = mesh.triangles[i], b = mesh.triangles[first + (i + 1) % 3];
        sides.emplace(uint64_t{a} << 32 | b, i);
        const auto other = sides.find(uint64_t{b} << 32 | a);
        if (other == sides.end()) continue;
        beyond[i / 3][i % 3] = other->second / 3;
        beyond[other->second / 3][other->second % 3] = i / 3;
    }
    return beyond;
}

// The smallest sphere round the middle of a triangle.
struct Ball {
    glm::dvec3 middle{};
    double radius = 0;
};

Ball ballOf(const ProjectorMesh& mesh, size_t triangle) {
    const uint32_t* corner = &mesh.triangles[3 * triangle];
    Ball ball;
    for (size_t k = 0; k < 3; ++k) ball.middle += mesh.vertices[corner[k]] / 3.0;
    for (size_t k = 0; k < 3; ++k)
        ball.radius = std::max(ball.radius, glm::length(mesh.vertices[corner[k]] - ball.middle));
    return ball;
}

bool isBorder(uint32_t left, uint32_t right) {
    return left != 0 && right != 0 && left != right;
}

// Where two surfaces meet in an edge that juts out into the air, under each of the two.
struct Ridge {
    glm::dvec3 from{}, to{}, beyond{}; // beyond: normal of the other surface
};

std::unordered_map<uint32_t, std::vector<Ridge>> ridgesOf(const PatchMesh& mesh) {
    std::unordered_map<uint64_t, uint32_t> sides; // directed edge -> patch
    sides.reserve(mesh.corners.size());
    std::unordered_map<uint32_t, std::vector<Ridge>> ridges;
    for (uint32_t p = 0; p < mesh.patchCount(); ++p) {
        const auto corner = mesh.patch(p);
        for (size_t k = 0; k < corner.size(); ++k) {
            const uint32_t a = corner[k], b = corner[(k + 1) % corner.size()];
            sides.emplace(uint64_t{a} << 32 | b, p);
            const auto other = sides.find(uint64_t{b} << 32 | a);
            if (other == sides.end() || mesh.surface[other->second] == mesh.surface[p]) continue;
            const uint32_t q = other->second;
            const glm::dvec3 from = mesh.vertices[a], to = mesh.vertices[b], normal = patchNormal(mesh, p);
            const glm::dvec3 across = patchCentroid(mesh, q) - from;
            if (glm::dot(normal, across) > -1e-6 * glm::length(across)) continue;
            ridges[mesh.surface[p]].push_back({from, to, patchNormal(mesh, q)});
            ridges[mesh.surface[q]].push_back({from, to, normal});
        }
    }
    return ridges;
}

// Of the projectors `seeing` a surface at `middle` of one of its ends, those that see past it.
uint32_t seeingPast(std::span<const Ridge> ridges, glm::dvec3 middle, uint32_t seeing,
                    std::span<const glm::dvec3> centres) {
    constexpr double kOnRidge = 1e-6; // metres: rounding of points that were put on it
    uint32_t past = 0;
    for (const Ridge& ridge : ridges) {
        if (distanceToSegment(middle, ridge.from, ridge.to) > kOnRidge) continue;
        for (size_t p = 0; p < centres.size(); ++p)
            if (glm::dot(ridge.beyond, centres[p] - middle) < 0) past |= 1u << p;
    }
    return past & seeing;
}

// Triangles that a border comes near, found by walking from it over the surface.
class NearTriangles {
public:
    explicit NearTriangles(const ProjectorMesh& mesh)
        : beyond(neighboursOf(mesh)), visited_(mesh.triangleCount(), kNone) {
        for (size_t t = 0; t < mesh.triangleCount(); ++t) balls_.push_back(ballOf(mesh, t));
    }

    template<class F> void visit(const BlendBorder& border, uint32_t start, F found) {
        ++walk_;
        front_.assign(1, start);
        visited_[start] = walk_;
        while (!front_.empty()) {
            const uint32_t t = front_.back();
            front_.pop_back();
            const Ball& ball = balls_[t];
            if (distanceToSegment(ball.middle, border.from, border.to) > kBlendFalloff + ball.radius)
                continue;
            found(t);
            for (const uint32_t next : beyond[t])
                if (next != kNone && visited_[next] != walk_) {
                    visited_[next] = walk_;
                    front_.push_back(next);
                }
        }
    }

    const std::vector<std::array<uint32_t, 3>> beyond;

private:
    std::vector<Ball> balls_;
    std::vector<uint32_t> visited_, front_;
    uint32_t walk_ = 0;
};

// Of the triangles' borders, one after the other, those that `chosen` makes one of.
template<class F> void select(ProjectorBlend& blend, F chosen) {
    std::vector<BlendBorder> kept;
    uint32_t from = 0;
    for (size_t t = 0; t < blend.visible.size(); ++t) {
        const uint32_t to = blend.first[t + 1];
        for (uint32_t i = from; i < to; ++i)
            if (chosen(blend.borders[i])) kept.push_back(blend.borders[i]);
        from = to;
        blend.first[t + 1] = static_cast<uint32_t>(kept.size());
    }
    blend.borders = std::move(kept);
}

} // namespace

ProjectorBlend blendProjectors(const ProjectorMesh& mesh, const PatchMesh& patches,
                               std::span<const glm::dvec3> centres) {
    NearTriangles near(mesh);
    const auto ridges = ridgesOf(patches);
    std::vector<std::pair<uint32_t, BlendBorder>> pairs; // triangle, border
    for (uint32_t t = 0; t < mesh.triangleCount(); ++t)
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t other = near.beyond[t][k];
            BlendBorder border{mesh.vertices[mesh.triangles[3 * t + k]],
                               mesh.vertices[mesh.triangles[3 * t + (k + 1) % 3]], mesh.visible[t], 0};
            if (other == kNone) {
                const auto own = ridges.find(patches.surface[mesh.sourcePatch[t]]);
                if (own == ridges.end()) continue;
                border.left = seeingPast(own->second, 0.5 * (border.from + border.to), border.left, centres);
                if (border.left == 0) continue;
            } else {
                border.right = mesh.visible[other];
                if (other < t || !isBorder(border.left, border.right)) continue;
            }
            near.visit(border, t, [&](uint32_t reached) {
                if (mesh.visible[reached]) pairs.emplace_back(reached, border);
            });
        }
    ProjectorBlend blend{std::vector<double>(centres.size(), 1.0),
                         mesh.visible,
                         std::vector<uint32_t>(mesh.triangleCount() + 1),
                         {}};
    for (const auto& [t, border] : pairs) ++blend.first[t + 1];
    for (size_t t = 0; t < mesh.triangleCount(); ++t) blend.first[t + 1] += blend.first[t];
    std::vector<uint32_t> at = blend.first;
    blend.borders.resize(pairs.size());
    for (const auto& [t, border] : pairs) blend.borders[at[t]++] = border;
    return blend;
}

void keepOnly(ProjectorBlend& blend, uint32_t projectors) {
    for (uint32_t& seen : blend.visible) seen &= projectors;
    select(blend, [&](BlendBorder& border) {
        const bool end = border.right == 0;
        border.left &= projectors;
        border.right &= projectors;
        return end ? border.left != 0 : isBorder(border.left, border.right);
    });
}

double steepnessAt(glm::dvec3 point, glm::dvec3 normal, glm::dvec3 centre) {
    const glm::dvec3 towards = centre - point;
    const double r2 = glm::dot(towards, towards), cosine = glm::dot(normal, towards) / std::sqrt(r2);
    return std::max(cosine, kBlendLeastCosine) / r2;
}

std::vector<double> blendShares(const ProjectorBlend& blend, size_t triangle, glm::dvec3 point,
                                glm::dvec3 normal, std::span<const glm::dvec3> centres) {
    std::vector<double> shares(centres.size(), 0);
    double sum = 0;
    for (size_t p = 0; p < centres.size(); ++p) {
        if (!blend.sees(p, triangle)) continue;
        double distance = kBlendFalloff, end = kBlendFalloff;
        for (const BlendBorder& border : blend.near(triangle))
            if ((border.left ^ border.right) >> p & 1u) {
                double& nearest = border.right == 0 ? end : distance;
                nearest = std::min(nearest, distanceToSegment(point, border.from, border.to));
            }
        shares[p] = fadeAt(distance, end) * blend.candela[p] * steepnessAt(point, normal, centres[p]);
        sum += shares[p];
    }
    for (double& share : shares)
        if (sum > 0) share /= sum;
    return shares;
}

} // namespace heliodon::geometry
