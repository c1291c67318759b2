// What the light solvers hand to drawing and to tables: one moment of light on a PatchMesh.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/luminance.h"
#include "shaders/io/glow.io.h"

namespace heliodon::compute {

// Illuminance over a triangle, at the places of a grid: corner 0 + (i (corner 1 - corner 0) + j (corner 2 -
// corner 0)) / kCells, i + j <= kCells, row by row of j; linear between them.
struct PatchGlow {
    static constexpr int kCells = io::kGlowCells;
    uint32_t patch = 0;
    std::array<glm::vec3, io::kGlowPlaces> lux{};

    glm::vec3 mean() const {
        glm::vec3 sum(0);
        size_t place = 0;
        for (int j = 0; j <= kCells; ++j)
            for (int i = 0; i + j <= kCells; ++i) {
                const int sides = (i == 0) + (j == 0) + (i + j == kCells);
                sum += (sides == 0 ? 6.0f : sides == 1 ? 3.0f : 1.0f) * lux[place++]; // triangles around it
            }
        return sum / (3.0f * kCells * kCells);
    }
};

// Lux per linear Rec. 709 channel; one entry per patch.
struct Lighting {
    std::vector<glm::vec3> exitance;       // B = E + rho H, all light that leaves the patch into the room
    std::vector<glm::vec3> sunIlluminance; // direct sun on the patch, behind glass, averaged over the patch;
                                           // all zero without sun
    glm::dvec3 sunDirection{0};            // unit, world, towards the sun; zero when no sun is modelled
    glm::vec3 sunNormalIlluminance{0};     // outside, on a plane facing the sun
    // Of the exitance, what sunlit patches nearby light: illuminance, mean over each patch, and within those
    // triangles that have any (compute/sun_glow.h). Empty where there is none, and with
    // TransportOptions::forPictures off.
    std::vector<glm::vec3> sunGlow;
    std::vector<PatchGlow> glow;
    std::vector<glm::vec3> ownScatter; // exitance that projectors leave out, as the physical model sends
                                       // it back by itself (engine/passes/own_scatter.h); or empty
};

using geometry::photometric;

} // namespace heliodon::compute
