#include "compute/reference/monte_carlo.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "compute/monte_carlo.h"
#include "geometry/perpendicular.h"

namespace heliodon::compute::reference {

namespace {

using glm::dvec2;
using glm::dvec3;

uint32_t hashOf(uint32_t x) {
    x = x * 747796405u + 2891336453u;
    x = ((x >> ((x >> 28) + 4)) ^ x) * 277803737u;
    return (x >> 22) ^ x;
}

double unitOf(uint32_t bits) {
    return (bits >> 8) * 0x1p-24;
}

dvec3 pointOn(const geometry::PatchMesh& mesh, uint32_t patch, dvec2 place) {
    const auto c = mesh.patch(patch);
    const dvec3 a = mesh.vertices[c[0]];
    const double area = geometry::patchArea(mesh, patch);
    double before = 0;
    for (size_t k = 1;; ++k) {
        const dvec3 e = mesh.vertices[c[k]] - a, f = mesh.vertices[c[k + 1]] - a;
        const double upTo = k + 2 == c.size() ? 1 : before + 0.5 * glm::length(glm::cross(e, f)) / area;
        if (place.x < upTo || k + 2 == c.size()) {
            const double x = (place.x - before) / (upTo - before), y = place.y;
            return y > x ? a + 0.5 * x * e + (y - 0.5 * x) * f : a + (x - 0.5 * y) * e + 0.5 * y * f;
        }
        before = upTo;
    }
}

dvec3 cosineDirection(dvec2 s) {
    const dvec2 c = 2.0 * s - 1.0;
    const bool wide = std::abs(c.x) > std::abs(c.y);
    const double r = wide ? c.x : c.y, ratio = r == 0 ? 0 : (wide ? c.y : c.x) / r;
    const double angle = std::numbers::pi / 4 * ratio;
    const dvec2 d = wide ? dvec2(std::cos(angle), std::sin(angle)) : dvec2(std::sin(angle), std::cos(angle));
    return {r * d.x, r * d.y, std::sqrt(std::max(0.0, 1 - r * r))};
}

// The patch met first, or -1; `front` says which side: of two back to back, as far apart as doubles round,
// the front.
int64_t nearest(const geometry::PatchMesh& mesh, uint32_t self, dvec3 o, dvec3 d, bool& front) {
    double reach = std::numeric_limits<double>::infinity();
    int64_t result = -1;
    for (size_t j = 0; j < mesh.patchCount(); ++j) {
        if (j == self || mesh.room[j] != mesh.room[self]) continue;
        const auto c = mesh.patch(j);
        for (size_t k = 1; k + 1 < c.size(); ++k) {
            const dvec3 a = mesh.vertices[c[0]], e = mesh.vertices[c[k]] - a, f = mesh.vertices[c[k + 1]] - a;
            const dvec3 p = glm::cross(d, f), q = glm::cross(o - a, e);
            const double determinant = glm::dot(e, p);
            const double u = glm::dot(o - a, p) / determinant, v = glm::dot(d, q) / determinant;
            const double t = glm::dot(f, q) / determinant;
            const bool isFront = determinant > 0;
            const double tie = result >= 0 && isFront != front ? 1e-10 * reach : 0;
            if (!(u >= 0 && v >= 0 && u + v <= 1 && t > 1e-9 && t < reach + (isFront ? tie : -tie))) continue;
            reach = t;
            result = static_cast<int64_t>(j);
            front = isFront;
        }
    }
    return result;
}

} // namespace

MonteCarloRow monteCarloRow(const geometry::PatchMesh& mesh, uint32_t row, uint32_t rays) {
    MonteCarloRow result;
    const uint32_t half = rays / 2;
    const std::vector<glm::uvec4> points = monteCarloPoints(half);
    const dvec3 normal = geometry::patchNormal(mesh, row), u = geometry::perpendicular(normal),
                v = glm::cross(normal, u);
    for (uint32_t second = 0; second < 2; ++second) {
        result.hits[second].assign(mesh.patchCount(), 0);
        const uint32_t seed = hashOf(2 * row + second + 1), mask = 0xffffffffu >> monteCarloKeptBits(half);
        const glm::uvec4 shift{hashOf(seed) & mask, hashOf(seed + 0x9e3779b9u) & mask,
                               hashOf(seed + 0x3c6ef372u), hashOf(seed + 0xdaa66d2bu)};
        for (const glm::uvec4& point : points) {
            const glm::uvec4 bits = point ^ shift;
            const dvec3 local = cosineDirection({unitOf(bits.x), unitOf(bits.y)});
            bool front = false;
            const int64_t seen = nearest(mesh, row, pointOn(mesh, row, {unitOf(bits.z), unitOf(bits.w)}),
                                         local.x * u + local.y * v + local.z * normal, front);
            if (seen >= 0 && front)
                ++result.hits[second][static_cast<size_t>(seen)];
            else
                ++result.lost;
        }
    }
    return result;
}

} // namespace heliodon::compute::reference
