// Sensors a hair from walls: light changes fast towards a corner, faster than patches of a mesh tell, and
// what such a sensor sees is mostly the patch or two beside it. Here those patches are taken apart into
// triangles that shrink towards the sensor, whose light is gathered at their own places and exchanged among
// them until it settles (Nystroem's method on the corner alone, the rest of the room as the mesh has it).
// All of that is linear in light: what comes out are numbers that any moment's light is multiplied with.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/patch_slopes.h"
#include "compute/point_scene.h"
#include "compute/slat_lobes.h"

namespace heliodon::compute {

// What one sensor gets beyond what its rows of form factors say.
struct NearLight {
    struct Cell { // a piece of a near wall
        glm::dvec3 middle, normal;
        glm::vec3 answer; // lux at the sensor for each lux on the cell
    };
    // Per channel and patch, to be added to the sensor's rows: light that runs on smoothly (all but the sun's
    // first bounce), and the sun's first bounce, taken for even across its patch.
    std::vector<float> smooth[3], even[3];
    std::vector<SkySample> sky; // by way of the cells
    std::vector<float> slats[3]; // per channel and row of SlatLobes, by way of the cells
    glm::vec3 own{0};            // of what the cells emit themselves, lux
    std::vector<Cell> cells;    // where it matters where in a patch the sun shines (sunEdgesOnCells)

    bool isEmpty() const { return cells.empty(); }
    size_t bytes() const;
};

// Whether a patch so near that it is taken apart fills a fifth or more of what a sensor sees (`even`: its
// form factors), or several together 0.35 of it.
bool hasNearWall(const PointScene& scene, glm::dvec3 position, std::span<const float> even);

// For a sensor of a room. `channels`: 1 where all materials are grey. About 50 ms in a corner of 2000
// patches. Holds until glass or reflectances change.
NearLight nearLight(const PointScene& scene, const PatchSlopes& slopes, const SlatLobes& slats,
                    glm::dvec3 position, glm::dvec3 normal, uint32_t room, uint32_t channels);

} // namespace heliodon::compute
