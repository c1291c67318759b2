// What points see, as numbers that light is multiplied with: exact form factors of patches (PointView), the
// sky and ground through openings, and sunlit parts of patches. Everything depends on geometry and glass
// alone; light comes in with each moment. Runs on all cores of the host.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/daylight/sky_patches.h"
#include "compute/near_light.h"
#include "compute/patch_slopes.h"
#include "compute/point_scene.h"
#include "compute/slat_lobes.h"
#include "compute/sun_patches.h"

namespace heliodon::compute {

struct Sensor {
    glm::dvec3 position{0}, normal{0, 1, 0}; // world metres; unit
};

// What points see of the outside through exterior openings.
struct SkyView {
    std::vector<size_t> first{0}; // of each point's samples
    std::vector<SkySample> samples;

    std::span<const SkySample> of(size_t point) const {
        return {samples.data() + first[point], first[point + 1] - first[point]};
    }
};

// Coefficients of sky elements, 1/pi of the lux per unit of luminance: means over patches, from four points
// on each, 16 or 64 where light changes fast.
struct PatchSky {
    std::vector<float> coefficients; // patches x channels x elements
    std::vector<float> error; // per patch, estimate: share of its light from the sky that these points miss
    std::vector<float>
        range; // per patch, under an even sky: by how much four of them differ, as a share of it
    // Per patch, means of the same points; in three channels. Empty where nothing outside reflects light.
    std::vector<std::vector<OutsideShare>> walls;
};
PatchSky patchSkyCoefficients(const PointScene& scene, const daylight::SkyPatches& sky, uint32_t channels);

// Rows of sensors.
struct SensorGather {
    std::vector<Sensor> sensors;
    NearWalls nearWalls;
    std::vector<uint32_t> room; // geometry::kNoRoom: outside, sees nothing
    std::vector<float> even;    // sensors x patches: form factors
    std::vector<float> smooth;  // the same for light that runs on linearly between patches (PatchSlopes)
    std::vector<std::vector<TintedShare>> tinted; // per sensor: to be added to both, channel by channel
    std::vector<uint8_t> nearWall;                // whether a patch beside it is taken apart
    std::vector<NearLight> near;                  // of these; until findNearLight, and of all others, empty
    // Per sensor, in one channel for all or three: rows of SlatLobes.
    std::vector<std::array<std::vector<float>, 3>> slats;
    SkyView sky;
    std::vector<std::vector<OutsideShare>> walls; // per sensor
    // Per sensor: light of rooms that comes back to it from outside, to be added to both rows; with `near`.
    std::vector<std::vector<TintedShare>> returned;
};
SensorGather gatherSensors(const PointScene& scene, const PatchSlopes& slopes, const SlatLobes& slats,
                           const NearWalls& nearWalls, std::vector<Sensor> sensors, uint32_t channels);

// Makes gather.near, which holds until reflectances change. `done` is told how many
// sensors have been looked at.
void findNearLight(const PointScene& scene, const PatchSlopes& slopes, const SlatLobes& slats,
                   uint32_t channels, SensorGather& gather, const std::function<void(size_t)>& done = {});

// What sunlit parts of patches send to a sensor beyond what their mean light would, lux. `strength`: the
// sun's normal illuminance; `firstBounce`: per patch, reflectance times its mean sunlight.
glm::vec3 sunEdges(const PointScene& scene, const SensorGather& gather, size_t sensor,
                   std::span<const SunlitParts> partly, double strength,
                   std::span<const glm::vec3> firstBounce);

} // namespace heliodon::compute
