// Blinds scatter what falls on their windows from outside: the openings glow, evenly over each; fabrics in
// all directions alike, slats up or down (daylight/window.h). The glow is an exitance of patches and, for
// slats, how its light in each direction differs from that; both linear in the sky and the sun.
#pragma once

#include <array>
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
    // some 8000 directions before the window, as if nothing of the building were in the way (HiddenSky).
    glm::vec3 bySky(size_t group, const daylight::Sky& sky) const;
    // The same as coefficients of sky elements: times pi times an element's luminance. channels x elements.
    std::vector<float> coefficients(size_t group, const daylight::SkyPatches& sky, uint32_t channels) const;
    // Of slats: how the glow in each direction differs from that exitance, luminance x pi, lux; by sky and
    // ground, and as coefficients like the above, nodes x channels x elements. The sun's: Window::lobes.
    daylight::Window::Lobes lobesBySky(size_t group, const daylight::Sky& sky) const;
    std::vector<float> lobeCoefficients(size_t group, const daylight::SkyPatches& sky,
                                        uint32_t channels) const;

    // Exitance of one patch of a group over the sun's normal illuminance; the building's walls shade.
    glm::vec3 bySun(size_t group, uint32_t patch, const SunPatches& sun, glm::dvec3 towardsSun) const;

private:
    static constexpr size_t kProfiles = 64; // of incoming light, even in the angle
    struct Sample {
        glm::vec3 direction;
        glm::vec3 weight;   // lux per unit of luminance
        glm::vec3 inside;   // of slats: lux that the glass lets in, per unit of luminance
        size_t profile = 0; // of slats
    };
    using LitProfiles = std::array<glm::dvec3, kProfiles>;
    daylight::Window::Lobes lobesOf(size_t group, const LitProfiles& inside) const;
    std::vector<Group> groups_;
    std::vector<std::vector<daylight::Window::Lobes>>
        profiles_; // per group with slats, of one lux inside each
    std::vector<LitProfiles> groundInside_;
    std::vector<std::vector<Sample>> sky_; // per group; above the horizon
    std::vector<glm::dvec3> ground_;       // per group
};

} // namespace heliodon::compute
