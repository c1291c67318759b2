// What the light solvers hand to drawing and to tables: one moment of light on a PatchMesh.
#pragma once

#include <vector>

#include <glm/vec3.hpp>

namespace heliodon::compute {

// Lux per linear Rec. 709 channel (Y = 0.2126 R + 0.7152 G + 0.0722 B is the photometric value); one entry
// per patch.
struct Lighting {
    std::vector<glm::vec3> exitance;       // B = E + rho H, all light that leaves the patch into the room
    std::vector<glm::vec3> sunIlluminance; // direct sun on the patch, behind glass, averaged over the patch;
                                           // all zero without sun
    glm::dvec3 sunDirection{0};            // unit, world, towards the sun; zero when no sun is modelled
    glm::vec3 sunNormalIlluminance{0};     // outside, on a plane facing the sun
};

// 0.2126 R + 0.7152 G + 0.0722 B
inline double photometric(glm::vec3 rgb) {
    return 0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z;
}

} // namespace heliodon::compute
