// Blinds scatter what falls on their windows from outside: the openings glow, evenly over each and in all
// directions alike (daylight/window.h). The glow is an exitance of patches, linear in the sky and the sun.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/daylight/sky_patches.h"
#include "compute/daylight/window.h"
#include "compute/sun_patches.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

class GlowingBlinds {
public:
    // Exterior openings with blinds; none, at no cost, where all stand open.
    explicit GlowingBlinds(const geometry::PatchMesh& mesh);
    bool empty() const { return groups_.empty(); }

    // Patches of one window state that look the same way glow alike under the sky.
    struct Group {
        daylight::Window window;
        glm::dvec3 normal; // into the room
        std::vector<uint32_t> patches;
    };
    std::span<const Group> groups() const { return groups_; }

    // Exitance of a group's patches by light from sky and ground, lux per channel: the sky's own formula in
    // some 8000 directions before the window, where nothing of the building is in the way.
    glm::vec3 bySky(size_t group, const daylight::Sky& sky) const;
    // The same as coefficients of sky elements: times pi times an element's luminance. channels x elements.
    std::vector<float> coefficients(size_t group, const daylight::SkyPatches& sky, uint32_t channels) const;
    // Exitance of one patch of a group over the sun's normal illuminance; the building's walls shade.
    glm::vec3 bySun(size_t group, uint32_t patch, const SunPatches& sun, glm::dvec3 towardsSun) const;

private:
    struct Sample {
        glm::vec3 direction;
        glm::vec3 weight; // lux per unit of luminance
    };
    std::vector<Group> groups_;
    std::vector<std::vector<Sample>> sky_; // per group; above the horizon
    std::vector<glm::dvec3> ground_;       // per group
};

} // namespace heliodon::compute
