#include "compute/patch_slopes.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"

namespace heliodon::compute {

using glm::dvec3;

PatchSlopes::PatchSlopes(const geometry::PatchMesh& mesh) {
    const size_t n = mesh.patchCount();
    std::vector<dvec3> centre(n);
    std::vector<std::vector<uint32_t>> atVertex(mesh.vertices.size());
    for (size_t i = 0; i < n; ++i) {
        centre[i] = geometry::patchCentroid(mesh, i);
        for (uint32_t v : mesh.patch(i)) atVertex[v].push_back(static_cast<uint32_t>(i));
    }
    std::vector<uint32_t> around;
    for (size_t i = 0; i < n; ++i) {
        around.clear();
        for (uint32_t v : mesh.patch(i))
            for (uint32_t j : atVertex[v])
                if (j != i && mesh.surface[j] == mesh.surface[i] && mesh.material[j] == mesh.material[i])
                    around.push_back(j);
        std::sort(around.begin(), around.end());
        around.erase(std::unique(around.begin(), around.end()), around.end());

        const dvec3 normal = geometry::patchNormal(mesh, i);
        const dvec3 u = geometry::perpendicular(normal), v = glm::cross(normal, u);
        double uu = 0, uv = 0, vv = 0;
        struct Place {
            double u, v, importance;
        };
        std::vector<Place> places;
        for (uint32_t j : around) {
            const dvec3 d = centre[j] - centre[i];
            const double length = glm::length(d), du = glm::dot(d, u), dv = glm::dot(d, v);
            const double flat = std::hypot(du, dv);
            // A curved surface is rolled out: true distance, direction in the plane.
            const double stretch = flat > 0 ? length / flat : 0;
            const Place place{du * stretch, dv * stretch, length > 0 ? 1 / (length * length) : 0};
            uu += place.importance * place.u * place.u;
            uv += place.importance * place.u * place.v;
            vv += place.importance * place.v * place.v;
            places.push_back(place);
        }
        // Where the neighbours lie in a row, as along a strip, the slope is that along the row.
        const double trace = uu + vv, determinant = uu * vv - uv * uv;
        const bool inRow = !(determinant > 0.01 * trace * trace);
        const double turn = 0.5 * std::atan2(2 * uv, uu - vv), rowU = std::cos(turn), rowV = std::sin(turn);
        if (trace > 0) {
            dvec3 own(0);
            for (size_t k = 0; k < around.size(); ++k) {
                const Place& p = places[k];
                double a = p.importance * (vv * p.u - uv * p.v) / determinant,
                       b = p.importance * (uu * p.v - uv * p.u) / determinant;
                if (inRow) {
                    const double along = p.importance * (p.u * rowU + p.v * rowV) / trace;
                    a = along * rowU, b = along * rowV;
                }
                const dvec3 weight = a * u + b * v;
                own -= weight;
                terms_.push_back({around[k], glm::vec3(weight)});
            }
            terms_.push_back({static_cast<uint32_t>(i), glm::vec3(own)});
        }
        first_.push_back(terms_.size());
    }
}

} // namespace heliodon::compute
