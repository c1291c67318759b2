// What sensors get of sky and ground straight through openings, and by way of walls taken apart beside them,
// for many skies: by each sky's own luminance in the directions of the samples, so that nothing of its course
// round the sun is lost to sky elements; not of skies with a ribbon at the horizon (RibbonLight).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "compute/near_light.h"
#include "compute/sensor_gather.h"

namespace heliodon::compute {

class StraightSky {
public:
    struct Sample {
        glm::vec3 direction;
        float heightIndex, weight; // of SkyTables; photometric
    };

    // `near`: of the view's points; empty ones have no such walls. Their samples are taken together by
    // direction, off by about 1e-4 of a sensor's light at the worst hour of a year, 2e-6 in the root mean
    // square.
    StraightSky(const SkyView& view, std::span<const NearLight> near);

    // Adds each sensor's photometric lux in these hours to `lux`, sensors x skies. 1.5 ns an hour and sample,
    // of which a sensor beside a window has some hundred, and 20 us an hour. `done`: how many hours are.
    void addTo(std::span<float> lux, std::span<const daylight::Sky> skies, std::span<const uint32_t> hours,
               const std::function<void(size_t)>& done = {}) const;

private:
    void addTogether(std::span<float> lux, std::span<const daylight::Sky> skies,
                     std::span<const uint32_t> hours) const;

    std::vector<Sample> samples_; // of the sky
    std::vector<size_t> first_{0};
    std::vector<float> ground_; // weight of each sensor's ground
};

} // namespace heliodon::compute
