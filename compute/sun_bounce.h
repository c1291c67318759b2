// Sunlight ends within patches. What such a patch sends to another one depends on where on it the light lies,
// most of all in corners: at 600 triangles patches beside the edge of a beam are up to 20 % off when the
// light is spread evenly. Here is the difference, to be added to light on patches before it is solved for:
// by the form factors of the lit polygons at points of patches nearby, by how much nearer and squarer the
// middle of the light stands for others. Each patch sends out as much as before.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <glm/vec3.hpp>

#include "compute/near_pairs.h"
#include "compute/patch_points.h"
#include "compute/point_scene.h"
#include "compute/sun_patches.h"

namespace heliodon::compute {

class SunBounce {
public:
    // Both outlive this. What stands between two patches is taken to hide what is lit of one as it hides all
    // of it; to other rooms, through panes, light is spread evenly.
    SunBounce(const PointScene& scene, const NearPairs& pairs);

    // Adds lux to patches. `strength`: the sun's normal illuminance. About 10 us for each patch lit in part.
    void addTo(std::span<glm::vec3> onPatches, std::span<const SunlitParts> partly, double strength) const;

private:
    std::optional<glm::dvec3> seenNearby(uint32_t to, const SunlitParts& lit,
                                         std::span<const glm::dvec3> corners) const;

    const PointScene* scene_;
    const NearPairs* pairs_;
    PatchViewpoints views_;
};

} // namespace heliodon::compute
