// What the building itself hides of the sky and the ground before its windows with blinds, as wings round a
// court do. GlowingBlinds takes windows for open to half of everything; here is what is to be taken off
// again: the hidden share of each sky element before each patch, by the same exact clipping as the sun's
// (SunPatches::onOutside) towards the element's middle. What walls reflect counts elsewhere; light that comes
// through the building's other windows is dimmed by their glass.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/daylight/sky_patches.h"
#include "compute/glowing_blinds.h"
#include "compute/sun_patches.h"

namespace heliodon::compute {

class HiddenSky {
public:
    // Nothing, at no cost, where nothing stands before windows with blinds; else about 10 us of one core for
    // each of their patches and of the elements that it faces.
    HiddenSky(const geometry::PatchMesh& mesh, const SunScene& scene, const GlowingBlinds& blinds,
              const daylight::SkyPatches& sky);

    struct Patch {
        uint32_t patch;
        size_t group;              // of blinds
        size_t row;                // place among all patches of blinds, in the order of their groups
        size_t slats;              // place among those of slats (SlatLobes::windows), where it is one
        std::vector<float> hidden; // per element, 0 to 1
    };
    std::span<const Patch> patches() const { return patches_; }

    // What GlowingBlinds' coefficients and lobeCoefficients have too much, in three channels: per element,
    // and per node and element.
    const std::vector<float>& coefficients(size_t group) const { return groups_[group].even; }
    const std::vector<float>& lobeCoefficients(size_t group) const { return groups_[group].lobes; }

    // The same under one sky, whose elements' luminances are given: exitance, lux; and of slats.
    glm::vec3 glow(const Patch& patch, std::span<const double> luminances) const;
    daylight::Window::Lobes lobes(const Patch& patch, std::span<const double> luminances) const;

private:
    // Light of each element that does not arrive: pi times luminance.
    static std::vector<float> lost(const Patch& patch, std::span<const double> luminances);

    struct Group { // empty where nothing is hidden
        std::vector<float> even, lobes;
    };
    std::vector<Group> groups_;
    std::vector<Patch> patches_;
};

} // namespace heliodon::compute
