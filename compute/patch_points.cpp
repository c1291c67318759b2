#include "compute/patch_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace heliodon::compute {

namespace {

constexpr double kGolden = std::numbers::phi - 1; // steps of this share, modulo one, spread evenly

// Barycentric centroids of a regular subdivision into m^2 triangles.
std::vector<glm::dvec3> trianglePoints(uint32_t m) {
    std::vector<glm::dvec3> result;
    for (uint32_t i = 0; i < m; ++i)
        for (uint32_t j = 0; i + j < m; ++j) {
            const double u = (i + 1. / 3) / m, v = (j + 1. / 3) / m;
            result.push_back({1 - u - v, u, v});
            if (i + j + 1 < m) {
                const double p = (i + 2. / 3) / m, q = (j + 2. / 3) / m;
                result.push_back({1 - p - q, p, q});
            }
        }
    return result;
}

// `count` points by area over a fan of triangles about the first corner: equal steps of the area, which also
// say how far across its triangle a point lies; out from the first corner, golden-ratio steps.
std::vector<glm::dvec3> fanPoints(const std::vector<glm::dvec3>& corners, uint32_t count) {
    std::vector<double> upTo{0};
    for (size_t k = 1; k + 1 < corners.size(); ++k)
        upTo.push_back(upTo.back() +
                       glm::length(glm::cross(corners[k] - corners[0], corners[k + 1] - corners[0])));
    std::vector<glm::dvec3> result;
    for (uint32_t i = 0; i < count; ++i) {
        const double area = (i + 0.5) / count * upTo.back();
        const auto k = static_cast<size_t>(std::clamp<std::ptrdiff_t>(
            std::ranges::upper_bound(upTo, area) - upTo.begin(), 1, std::ptrdiff_t(upTo.size()) - 1));
        const double across = (area - upTo[k - 1]) / std::max(upTo[k] - upTo[k - 1], 1e-300);
        const double out = std::sqrt(std::fmod(kGolden * (i + 0.5), 1.0));
        result.push_back(corners[0] + out * ((1 - across) * (corners[k] - corners[0]) +
                                             across * (corners[k + 1] - corners[0])));
    }
    return result;
}

std::vector<glm::dvec3> pointsOnPatch(const geometry::PatchMesh& mesh, size_t patch, uint32_t m) {
    if (m <= 1) return {geometry::patchCentroid(mesh, patch)};
    const std::vector<glm::dvec3> corners = geometry::patchCorners(mesh, patch);
    std::vector<glm::dvec3> result;
    if (corners.size() > 4) return fanPoints(corners, m * m);
    if (corners.size() == 3) {
        for (const glm::dvec3 w : trianglePoints(m))
            result.push_back(w.x * corners[0] + w.y * corners[1] + w.z * corners[2]);
        return result;
    }
    for (uint32_t i = 0; i < m * m; ++i) {
        const double u = (i % m + 0.5) / m, v = (i / m + 0.5) / m;
        result.push_back((1 - v) * ((1 - u) * corners[0] + u * corners[1]) +
                         v * ((1 - u) * corners[3] + u * corners[2]));
    }
    return result;
}

} // namespace

std::vector<glm::dvec3> spreadPoints(const geometry::PatchMesh& mesh, size_t patch, uint32_t count) {
    return fanPoints(geometry::patchCorners(mesh, patch), count);
}

PatchViewpoints patchViewpoints(const geometry::PatchMesh& mesh, uint32_t points) {
    return patchViewpoints(mesh, points, 0, static_cast<uint32_t>(mesh.patchCount()));
}

PatchViewpoints patchViewpoints(const geometry::PatchMesh& mesh, uint32_t points, uint32_t first,
                                uint32_t count) {
    const auto m = static_cast<uint32_t>(std::ceil(std::sqrt(std::max(points, 1u))));
    PatchViewpoints result;
    result.pointsPerPatch = m * m;
    result.viewpoints.reserve(size_t{count} * m * m);
    size_t number = size_t{first} * m * m;
    for (size_t i = first; i < size_t{first} + count; ++i) {
        Viewpoint view;
        view.normal = geometry::patchNormal(mesh, i);
        view.patch = static_cast<uint32_t>(i);
        view.room = mesh.room[i];
        for (const glm::dvec3& position : pointsOnPatch(mesh, i, m)) {
            view.position = position;
            // Golden-ratio turns: grids that line up with the walls would alias all in the same way. None is
            // zero, where edges run through the middles of pixels, and rounding would say who has them.
            view.turn = std::fmod(kGolden * static_cast<double>(++number), 1.0) * (std::numbers::pi / 2);
            result.viewpoints.push_back(view);
        }
    }
    return result;
}

} // namespace heliodon::compute
