#include "compute/daylight/frame.h"

#include <cmath>

namespace heliodon::daylight {

glm::dvec3 directionInWorld(SkyAngles angles, double northDeg) {
    const double inPlan = radians(northDeg - angles.azimuthDeg);
    const double up = radians(angles.altitudeDeg);
    return {std::cos(up) * std::cos(inPlan), std::sin(up), -std::cos(up) * std::sin(inPlan)};
}

} // namespace heliodon::daylight
