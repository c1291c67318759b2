// The first bounce of sunlight near sunlit spots, where it varies within a patch too much for a value per
// patch, or for values at its corners: a wall beside a sunlit floor is several times brighter at its foot
// than half a patch higher. Here is that part of a patch's light over a grid on the patch, exactly.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/lighting.h"
#include "compute/near_pairs.h"
#include "compute/point_scene.h"
#include "compute/sun_patches.h"

namespace heliodon::compute {

class SunGlow {
public:
    // Both outlive this.
    SunGlow(const PointScene& scene, const NearPairs& pairs);

    // `light.sunIlluminance` as it is, `partly` those of its patches that are lit in part, for suns of
    // `strength`. Grids of triangles only; nothing where no sunlit patch has one near.
    // Cost: 1 to 5 ms of one core.
    LightDetail of(const Lighting& light, std::span<const SunlitParts> partly, double strength) const;

private:
    struct Lit { // what the sun lights of a patch
        uint32_t patch;
        std::vector<SunlitParts::Part> parts; // `light`: what leaves it, lux
    };
    std::vector<Lit> litPatches(const Lighting& light, std::span<const SunlitParts> partly,
                                double strength) const;
    double weight(glm::dvec3 point, size_t sender) const;
    void fillGrid(uint32_t patch, std::span<const Lit* const> lit, std::span<glm::vec3> grid) const;

    const PointScene* scene_;
    double size_ = 0;                            // of a patch, mean
    std::vector<std::vector<uint32_t>> senders_; // per patch: those that light it when the sun is on them
};

} // namespace heliodon::compute
