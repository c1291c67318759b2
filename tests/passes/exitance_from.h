// What a projector's picture does on the physical model.
#pragma once

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "engine/passes/picture.h"
#include "engine/passes/projector_light.h"
#include "geometry/rig.h"

namespace heliodon::test {

// What falls on a physical point from one projector, times the surface's reflectance. Nothing is in the way.
inline glm::dvec3 exitanceFrom(const geometry::Projector& projector, const passes::ImageF& picture,
                               glm::dvec3 point, glm::dvec3 normal, double reflectance) {
    const auto pixel = projector.pixelFromWorld(point);
    if (!pixel) return glm::dvec3(0);
    const glm::dvec3 towards = projector.centre() - point;
    const double r2 = glm::dot(towards, towards), cosine = glm::dot(normal, towards) / std::sqrt(r2);
    const int x = int(std::lround(pixel->x)), y = int(std::lround(pixel->y));
    if (cosine <= 0 || x < 0 || y < 0 || x >= picture.width || y >= picture.height) return glm::dvec3(0);
    const float* drive = picture.pixel(x, y);
    return glm::dvec3(drive[0], drive[1], drive[2]) * passes::fullIntensity(projector) * reflectance *
           cosine / r2;
}

} // namespace heliodon::test
