// Sunlight ends within patches. What such a patch sends to another one depends on where on it the light lies,
// most of all in corners: at 600 triangles patches beside the edge of a beam are up to 20 % off when the
// light is spread evenly. Here is the difference, to be added to light on patches before it is solved for:
// by the form factors of the lit polygons at points of patches nearby, by how much nearer and squarer the
// middle of the light stands for others. Each patch sends out as much as before: what patches nearby get
// more, as of light that ends at the top of a slot, all others get less in proportion.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/near_pairs.h"
#include "compute/patch_points.h"
#include "compute/point_scene.h"
#include "compute/sun_patches.h"

namespace heliodon::compute {

class SunBounce {
public:
    // All outlive this; `rowSums` of form factors. What stands between two patches is taken to hide what is
    // lit of one as it hides all of it; to other rooms, through panes, light is spread evenly.
    SunBounce(const PointScene& scene, const NearPairs& pairs, std::span<const float> rowSums);

    // Adds lux to patches, and to `sent` exitance by which what each sends to all differs from its mean,
    // which form factors are still to be applied to. `strength`: the sun's normal illuminance. About 10 us
    // for each patch lit in part.
    void addTo(std::span<glm::vec3> onPatches, std::span<glm::vec3> sent, std::span<const SunlitParts> partly,
               double strength) const;

private:
    struct Fluxes {
        double area = 0;                  // of the lit patch
        glm::dvec3 mean{0};               // of the light on it
        double even = 0, evenFarther = 0; // to patches nearby and to other pairs, of 1 evenly spread
        glm::dvec3 nearby{0}, farther{0}; // the same of the light where it is
    };
    struct Shares { // of patches nearby, other pairs, and all that is in no pair
        glm::dvec3 near{1}, far{1}, others{1};
    };
    glm::dvec3 seenNearby(uint32_t to, const SunlitParts& lit) const;
    double shareNearby(const SunlitParts& lit) const;
    Shares sharesOf(const SunlitParts& lit, const Fluxes& flux) const;

    const PointScene* scene_;
    const NearPairs* pairs_;
    std::span<const float> rowSums_;
    PatchViewpoints views_;
    // Of pairs, those of a sender from first_ on: what all of the sender is to the other patch, by its
    // points' form factors for the nearest, by nearness for the rest.
    std::vector<size_t> first_;
    std::vector<float> whole_;
};

} // namespace heliodon::compute
