// The first bounce of sunlight in corners, where it varies within a patch too much for a value per patch: a
// wall beside a sunlit floor is several times brighter at its foot than half a patch higher. Here is that
// part of a patch's light exactly at the mesh's corners, with its means over patches, so that who draws can
// take the means off, draw what is left smoothly, and add the values at corners.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/lighting.h"
#include "compute/near_pairs.h"
#include "compute/patch_points.h"
#include "compute/point_scene.h"
#include "compute/sun_patches.h"

namespace heliodon::compute {

class SunGlow {
public:
    // Both outlive this. What stands between two patches is taken to hide as much of a lit part as of all of
    // a patch. Cost: some 20 ms of one core for 2000 patches.
    SunGlow(const PointScene& scene, const NearPairs& pairs);

    // `light.sunIlluminance` as it is, `partly` those of its patches that are lit in part, for suns of
    // `strength`. Fills in sunGlow and cornerGlow; leaves both empty where no sunlit patch has another near.
    void addTo(Lighting& light, std::span<const SunlitParts> partly, double strength) const;

private:
    // What a sender lights: a patch, in the mean over it, or a place.
    struct Near {
        uint32_t to;
        float scale; // of form factors: a patch's, summed over its points, or a place's
        float whole; // scale times the factor of all of the sender
    };
    struct Sender {
        std::vector<Near> patches, places;
    };
    struct Place { // a corner of the mesh on one surface, a little inward
        glm::dvec3 position, normal;
    };
    void findPlaces();
    void findNear(size_t sender);
    double weight(glm::dvec3 point, size_t sender) const;
    std::span<const Viewpoint> pointsOf(uint32_t patch) const;
    // Of convex polygons, `light` times the form factor from a place or weighted points of a patch.
    glm::dvec3 atPlace(uint32_t place, std::span<const SunlitParts::Part> parts) const;
    glm::dvec3 onPatch(uint32_t patch, size_t sender, std::span<const SunlitParts::Part> parts) const;

    const PointScene* scene_;
    const NearPairs* pairs_;
    PatchViewpoints views_;
    double size_ = 0; // of a patch, mean
    std::vector<Place> places_;
    std::vector<uint32_t> placeOf_; // per corner of the mesh
    std::vector<Sender> senders_;   // per patch
};

} // namespace heliodon::compute
