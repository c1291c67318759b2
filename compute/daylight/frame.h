// From compass angles to world directions. World: y up; the plan's (x, y) lies at world (x, 0, -y), so seen
// from above x is to the right and y (world -z) up the picture. North is a direction in the plan: `northDeg`
// degrees counter-clockwise from +x as seen from above, 90 = world -z (a sketch's arrow,
// `geometry::Building::northDeg`). Azimuth runs from north clockwise, altitude up from the horizon; degrees.
#pragma once

#include <numbers>

#include <glm/vec3.hpp>

#include "geometry/model_file.h"

namespace heliodon::daylight {

constexpr double kPi = std::numbers::pi;
constexpr double radians(double degrees) {
    return degrees * (kPi / 180.0);
}
constexpr double degrees(double radians) {
    return radians * (180.0 / kPi);
}

struct SkyAngles {
    double azimuthDeg = 0;  // [0, 360), from north clockwise
    double altitudeDeg = 0; // [-90, 90], above the horizon positive
};

// Unit vector towards a point of the sky.
glm::dvec3 directionInWorld(SkyAngles angles, double northDeg);

// A direction given in a model's own axes, in world axes: (x, y, z) -> (x, z, -y) for a model with z up.
constexpr glm::dvec3 directionFromModel(glm::dvec3 d, geometry::UpAxis up) {
    return up == geometry::UpAxis::y ? d : glm::dvec3(d.x, d.z, -d.y);
}

} // namespace heliodon::daylight
