#include "engine/app/sky_tint.h"

#include <algorithm>
#include <utility>

#include <glm/common.hpp>

#include "compute/daylight/sky_colour.h"

namespace heliodon::app {

namespace {

struct Colours {
    glm::vec3 sun{1}, sky{1}, ground{1};
};

Colours coloursOf(const daylight::Sky& sky, const daylight::SkyPatches& patches) {
    const std::vector<double> luminances = patches.luminances(sky);
    const std::vector<glm::dvec3> coloured = daylight::colouredLuminances(sky, patches, luminances);
    glm::dvec3 onPlane(0);
    double lux = 0;
    for (size_t i = 0; i < patches.patchCount(); ++i) {
        onPlane += patches.projectedSolidAngle(i) * coloured[i];
        lux += patches.projectedSolidAngle(i) * luminances[i];
    }
    Colours colours;
    colours.sun = glm::vec3(daylight::SkyColour(sky).ofSun());
    if (lux > 0) colours.sky = glm::vec3(onPlane / lux);
    if (luminances.back() > 0) colours.ground = glm::vec3(coloured.back() / luminances.back());
    return colours;
}

// A source of a moment that is solved apart: its share of the light takes another colour than the rest.
struct Apart {
    size_t moment;
    glm::vec3 more; // its colour less the rest's
};

} // namespace

void tintLight(compute::DaylightTransport& transport, std::span<const daylight::Sky> skies,
               std::span<compute::Moment> moments) {
    const daylight::SkyPatches patches(2);
    std::vector<daylight::Sky> solved;
    std::vector<Apart> apart;
    std::vector<glm::vec3> rest; // per moment, the colour of what is not solved apart
    for (size_t m = 0; m < skies.size(); ++m) {
        compute::Lighting& light = moments[m].lighting;
        const Colours colours = coloursOf(skies[m], patches);
        // The sun, which costs most, or without any the ground.
        const bool hasSun = light.sunNormalIlluminance != glm::vec3(0),
                   hasGround = skies[m].ground.luminance > 0;
        rest.push_back(hasSun ? colours.sun : hasGround ? colours.ground : colours.sky);
        const auto solveApart = [&](glm::vec3 colour) -> daylight::Sky& {
            apart.push_back({m, colour - rest.back()});
            solved.push_back(skies[m]);
            solved.back().sun.normalIlluminance = 0;
            return solved.back();
        };
        if (skies[m].formula.scale > 0 && (hasSun || hasGround)) solveApart(colours.sky).ground.luminance = 0;
        if (hasSun && hasGround) solveApart(colours.ground).formula.scale = 0;
        light.sunNormalIlluminance *= colours.sun;
        for (glm::vec3& lux : light.sunIlluminance) lux *= colours.sun;
    }
    // What the room emits by itself keeps its colour, and is in everything that is solved.
    const bool emits =
        std::ranges::any_of(transport.mesh().materials, [](const geometry::Material& material) {
            return material.exitance != glm::vec3(0);
        });
    if (emits) {
        daylight::Sky dark = skies[0];
        dark.sun.normalIlluminance = dark.formula.scale = dark.ground.luminance = 0;
        solved.push_back(dark);
    }
    const std::vector<compute::Moment> parts = transport.light(solved);
    for (size_t m = 0; m < moments.size(); ++m) {
        compute::Lighting& light = moments[m].lighting;
        for (glm::vec3& lux : light.exitance) lux *= rest[m];
        light.detail.add(std::exchange(light.detail, {}), rest[m]);
    }
    for (size_t k = 0; k < apart.size(); ++k) {
        compute::Lighting& light = moments[apart[k].moment].lighting;
        compute::addTimes(light.exitance, apart[k].more, parts[k].lighting.exitance);
        light.detail.add(parts[k].lighting.detail, apart[k].more);
        if (emits) compute::addTimes(light.exitance, -apart[k].more, parts.back().lighting.exitance);
    }
    for (size_t m = 0; m < moments.size(); ++m) {
        std::vector<glm::vec3>& light = moments[m].lighting.exitance;
        if (emits) compute::addTimes(light, glm::vec3(1) - rest[m], parts.back().lighting.exitance);
        for (glm::vec3& lux : light) lux = glm::max(lux, glm::vec3(0)); // what the solver leaves
    }
}

} // namespace heliodon::app
