// Simple skies for tests.
#pragma once

#include <glm/geometric.hpp>

#include "compute/daylight/sky.h"

namespace heliodon::test {

// A clear sky with its sun towards `direction` (any length), over ground of albedo 0.2.
inline daylight::Sky sunny(glm::dvec3 direction = {0.2, 0.5, -0.8}, double normalIlluminance = 80000) {
    direction = glm::normalize(direction);
    daylight::Sky sky = daylight::cieClearSky(direction, 3000);
    sky.sun = {direction, normalIlluminance};
    daylight::lightGround(sky, 0.2);
    return sky;
}

inline daylight::Sky overcast() {
    daylight::Sky sky = daylight::cieGeneralSky(16, {0, 1, 0}, 5000);
    daylight::lightGround(sky, 0.2);
    return sky;
}

} // namespace heliodon::test
