#include "compute/daylight/frame.h"

#include <cmath>

namespace heliodon::daylight {

glm::dvec3 directionInWorld(SkyAngles angles, double northDeg) {
    const double inPlan = radians(northDeg - angles.azimuthDeg);
    const double up = radians(angles.altitudeDeg);
    return {std::cos(up) * std::cos(inPlan), std::sin(up), -std::cos(up) * std::sin(inPlan)};
}

SkyAngles anglesInWorld(glm::dvec3 d, double northDeg) {
    const double level = std::hypot(d.x, d.z);
    SkyAngles angles;
    angles.altitudeDeg = degrees(std::atan2(d.y, level));
    if (level < 1e-12 * std::abs(d.y)) return angles;
    angles.azimuthDeg = std::fmod(northDeg - degrees(std::atan2(-d.z, d.x)), 360.0);
    if (angles.azimuthDeg < 0) angles.azimuthDeg += 360.0;
    if (angles.azimuthDeg >= 360.0) angles.azimuthDeg = 0; // -tiny + 360 rounds up
    return angles;
}

} // namespace heliodon::daylight
