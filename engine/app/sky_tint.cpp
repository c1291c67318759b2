#include "engine/app/sky_tint.h"

#include <array>

#include <glm/common.hpp>

#include "compute/daylight/sky_colour.h"

namespace heliodon::app {

namespace {

struct Source {
    daylight::Sky sky;
    glm::vec3 colour{1};
};

// Sun, sky and ground of one sky, and what the room emits by itself, which is in each of them.
std::array<Source, 4> sourcesOf(const daylight::Sky& sky, const daylight::SkyPatches& patches) {
    const std::vector<double> luminances = patches.luminances(sky);
    const std::vector<glm::dvec3> coloured = daylight::colouredLuminances(sky, patches, luminances);
    glm::dvec3 onPlane(0);
    double lux = 0;
    for (size_t i = 0; i < patches.patchCount(); ++i) {
        onPlane += patches.projectedSolidAngle(i) * coloured[i];
        lux += patches.projectedSolidAngle(i) * luminances[i];
    }
    std::array<Source, 4> sources;
    auto& [ofSun, ofSky, ofGround, own] = sources;
    ofSun = {sky, glm::vec3(daylight::SkyColour(sky).ofSun())};
    ofSun.sky.formula.scale = 0, ofSun.sky.ground.luminance = 0;
    ofSky.sky = ofGround.sky = own.sky = sky;
    ofSky.sky.sun.normalIlluminance = 0, ofSky.sky.ground.luminance = 0;
    if (lux > 0) ofSky.colour = glm::vec3(onPlane / lux);
    ofGround.sky.sun.normalIlluminance = 0, ofGround.sky.formula.scale = 0;
    if (luminances.back() > 0) ofGround.colour = glm::vec3(coloured.back() / luminances.back());
    own.sky.sun.normalIlluminance = 0, own.sky.formula.scale = 0, own.sky.ground.luminance = 0;
    return sources;
}

} // namespace

void tintLight(compute::DaylightTransport& transport, std::span<const daylight::Sky> skies,
               std::span<compute::Moment> moments) {
    const daylight::SkyPatches patches(2);
    for (size_t m = 0; m < skies.size(); ++m) {
        const std::array<Source, 4> sources = sourcesOf(skies[m], patches);
        std::vector<daylight::Sky> apart;
        for (const Source& source : sources) apart.push_back(source.sky);
        const std::vector<compute::Moment> parts = transport.light(apart);
        compute::Lighting& light = moments[m].lighting;
        light.sunNormalIlluminance *= sources[0].colour;
        for (std::vector<glm::vec3>* glow : {&light.sunGlow, &light.cornerGlow})
            for (glm::vec3& lux : *glow) lux *= sources[0].colour;
        for (size_t i = 0; i < light.exitance.size(); ++i) {
            light.sunIlluminance[i] *= sources[0].colour;
            const glm::vec3 own = parts[3].lighting.exitance[i];
            light.exitance[i] = own;
            for (size_t k = 0; k < 3; ++k)
                light.exitance[i] +=
                    sources[k].colour * glm::max(parts[k].lighting.exitance[i] - own, glm::vec3(0));
        }
    }
}

} // namespace heliodon::app
