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
    std::vector<SkySample> sky;      // by way of the cells
    std::vector<OutsideShare> walls; // that stand outside, by way of the cells
    std::vector<float> slats[3];     // per channel and row of SlatLobes, by way of the cells
    glm::vec3 own{0};                // of what the cells emit themselves, lux
    std::vector<Cell> cells;         // where it matters where in a patch the sun shines (sunEdgesOnCells)

    bool isEmpty() const { return cells.empty(); }
    size_t bytes() const;
};

// Which sensors get this: a patch so near that it is taken apart fills at least this share of their view, or
// several together do. More of them where errors must be small on meshes that are coarse.
struct NearWalls {
    double one = 0.2, together = 0.35;
    double reach = 0.7; // patches nearer than this times their size are taken apart
};
// `even`: the sensor's form factors.
bool hasNearWall(const PointScene& scene, const NearWalls& walls, glm::dvec3 position,
                 std::span<const float> even);

// A sensor in a room.
struct NearPlace {
    glm::dvec3 position, normal;
    uint32_t room;
};
// What it gets of its near walls. `channels`: 1 where all materials are grey. About 20 ms in a corner of 2000
// patches. Holds until glass or reflectances change.
NearLight nearLight(const PointScene& scene, const PatchSlopes& slopes, const SlatLobes& slats,
                    const NearWalls& walls, const NearPlace& place, uint32_t channels);

} // namespace heliodon::compute
