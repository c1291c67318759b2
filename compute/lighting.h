// What the light solvers hand to drawing and to tables: one moment of light on a PatchMesh.
#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "geometry/luminance.h"

namespace heliodon::compute {

// Lux per linear Rec. 709 channel; one entry per patch.
struct Lighting {
    std::vector<glm::vec3> exitance;       // B = E + rho H, all light that leaves the patch into the room
    std::vector<glm::vec3> sunIlluminance; // direct sun on the patch, behind glass, averaged over the patch;
                                           // all zero without sun
    glm::dvec3 sunDirection{0};            // unit, world, towards the sun; zero when no sun is modelled
    glm::vec3 sunNormalIlluminance{0};     // outside, on a plane facing the sun
    // Of the exitance, what sunlit patches nearby light: illuminance, mean over each patch, and at each
    // corner of the mesh (compute/sun_glow.h). Empty where there is none, and with
    // TransportOptions::forPictures off.
    std::vector<glm::vec3> sunGlow, cornerGlow;
    std::vector<glm::vec3> ownScatter; // exitance that projectors leave out, as the physical model sends
                                       // it back by itself (engine/passes/own_scatter.h); or empty
};

using geometry::photometric;

} // namespace heliodon::compute
