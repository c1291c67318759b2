#include "compute/reference/sun.h"

#include <cmath>

#include <glm/geometric.hpp>

#include "compute/daylight/glazing.h"
#include "compute/reference/inside.h"

namespace heliodon::compute::reference {

namespace {

glm::dvec3 alongRay(const geometry::PatchMesh& mesh, size_t self, glm::dvec3 origin, glm::dvec3 sun) {
    glm::dvec3 through(1);
    bool leaves = false;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        if (i == self) continue;
        const glm::dvec3 normal = geometry::patchNormal(mesh, i);
        const double slope = glm::dot(normal, sun);
        const double t = glm::dot(mesh.vertices[mesh.patch(i)[0]] - origin, normal) / slope;
        if (!(t > 1e-7)) continue;
        if (!isInside(mesh, i, normal, origin + t * sun)) continue;
        const geometry::Material& material = mesh.materials[mesh.material[i]];
        if (!material.isOpening()) return glm::dvec3(0);
        leaves |= slope < 0;
        if (slope < 0 || mesh.twin[i] == geometry::kNoTwin) // an interior window is two patches, one pane
            through *= daylight::glazingOf(material).transmittance(std::abs(slope));
    }
    return leaves ? through : glm::dvec3(0);
}

} // namespace

glm::dvec3 sunOnPatch(const geometry::PatchMesh& mesh, size_t patch, glm::dvec3 sun, uint32_t samples) {
    const double cosine = glm::dot(geometry::patchNormal(mesh, patch), sun);
    if (cosine <= 0) return glm::dvec3(0);
    const auto corners = mesh.patch(patch);
    glm::dvec3 sum(0);
    double weight = 0;
    for (size_t k = 1; k + 1 < corners.size(); ++k) {
        const glm::dvec3 a = mesh.vertices[corners[0]], b = mesh.vertices[corners[k]],
                         c = mesh.vertices[corners[k + 1]];
        const double area = glm::length(glm::cross(b - a, c - a));
        // Roberts' R2 sequence, folded into the triangle.
        for (uint32_t s = 0; s < samples; ++s) {
            double u = std::fmod(0.5 + 0.7548776662466927 * (s + 1), 1.0),
                   v = std::fmod(0.5 + 0.5698402909980532 * (s + 1), 1.0);
            if (u + v > 1) u = 1 - u, v = 1 - v;
            sum += area / samples * alongRay(mesh, patch, a + u * (b - a) + v * (c - a), sun);
        }
        weight += area;
    }
    return sum / weight * cosine;
}

} // namespace heliodon::compute::reference
