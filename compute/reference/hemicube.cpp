#include "compute/reference/hemicube.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "compute/reference/inside.h"
#include "geometry/bounds.h"

namespace heliodon::compute::reference {

namespace {

struct Hit {
    size_t patch = SIZE_MAX;
    bool front = false;
};

// Nearest patch along a ray; both sides block.
Hit trace(const geometry::PatchMesh& mesh, const Viewpoint& view, glm::dvec3 direction, double flatness) {
    Hit hit;
    double nearest = 1e300;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        if (i == view.patch || (view.room != io::kHemicubeAnyRoom && mesh.room[i] != view.room)) continue;
        const glm::dvec3 normal = geometry::patchNormal(mesh, i);
        const double height = glm::dot(normal, view.position - mesh.vertices[mesh.patch(i)[0]]);
        const double slope = glm::dot(normal, direction);
        if (std::abs(height) <= flatness || slope == 0) continue;
        const double t = -height / slope;
        if (t <= 0 || t >= nearest) continue;
        if (!isInside(mesh, i, normal, view.position + t * direction)) continue;
        nearest = t;
        hit = {i, slope < 0};
    }
    return hit;
}

} // namespace

HemicubeRow hemicubeRow(const geometry::PatchMesh& mesh, const Viewpoint& view, uint32_t R) {
    const double flatness = 1e-6 * geometry::boundsOf(mesh.vertices).diagonal();
    HemicubeRow row;
    row.factors.assign(mesh.patchCount(), 0);
    const glm::dvec3 helper = std::abs(view.normal.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    const glm::dvec3 u0 = glm::normalize(glm::cross(helper, view.normal)), v0 = glm::cross(view.normal, u0);
    const glm::dvec3 u = std::cos(view.turn) * u0 + std::sin(view.turn) * v0, v = glm::cross(view.normal, u);
    const std::vector<double> deltas = hemicubeDeltas(R);
    for (uint32_t face = 0; face < 5; ++face)
        for (uint32_t j = 0; j < (face == 0 ? R : R / 2); ++j)
            for (uint32_t i = 0; i < R; ++i) {
                const double x = (2.0 * i + 1) / R - 1, y = (2.0 * j + 1) / R - (face == 0 ? 1 : 0);
                const glm::dvec3 across[]{u, v, -v, -u, u},
                    up[]{v, view.normal, view.normal, view.normal, view.normal},
                    forward[]{view.normal, u, -u, v, -v};
                const glm::dvec3 direction = glm::normalize(x * across[face] + y * up[face] + forward[face]);
                const double delta = deltas[(face == 0 ? 0 : size_t{R} * R) + size_t{j} * R + i];
                const Hit hit = trace(mesh, view, direction, flatness);
                (hit.front ? row.factors[hit.patch] : row.lost) += delta;
            }
    return row;
}

} // namespace heliodon::compute::reference
