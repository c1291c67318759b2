// What sensors get of sky and ground straight through openings, and by way of walls taken apart beside them,
// for many skies: by each sky's own luminance at nodes so close (SkyGrid) that nothing of its course round
// the sun is lost, as it is to sky elements. Skies that are too steep above the horizon for nodes are looked
// up at each sample; not those with a ribbon there (RibbonLight).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "compute/daylight/sky_grid.h"
#include "compute/daylight/sky_table.h"
#include "compute/near_light.h"
#include "compute/sensor_gather.h"

namespace heliodon::compute {

class StraightSky {
public:
    static constexpr size_t kTables = 2; // of skies that are looked up together

    struct Node {
        glm::vec3 direction;
        float heightIndex; // of SkyTables
    };
    struct Share {
        uint32_t node;
        float weight; // photometric
    };

    // `near`: of the view's points; empty ones have no such walls. Both must outlive this. What the nodes of
    // SkyGrid tell of samples is off by as much as stated there for a sensor that sees little of the sky. Of
    // those on each patch of an L-shaped sketch in Chicago's weather, by 6e-4 of a sensor's light at the
    // worst hour, 5e-6 in the root mean square.
    StraightSky(const SkyView& view, std::span<const NearLight> near);

    // Adds each sensor's photometric lux in these hours to `lux`, sensors x skies. 0.1 ns an hour and node
    // that a sensor sees, some hundred beside a window; 1.5 ns an hour and node that any sees, and 40 us an
    // hour. Steep skies: 1.5 ns an hour and sample. `done`: how many hours are.
    void addTo(std::span<float> lux, std::span<const daylight::Sky> skies, std::span<const uint32_t> hours,
               const std::function<void(size_t)>& done = {}) const;

private:
    // At most as many hours as are looked up together.
    void addByNodes(std::span<float> lux, std::span<const daylight::Sky> skies,
                    std::span<const uint32_t> hours) const;
    void addBySamples(std::span<float> lux, std::span<const daylight::Sky> skies,
                      std::span<const uint32_t> hours) const;
    std::array<std::span<const SkySample>, 2> samplesOf(size_t sensor) const {
        return {view_->of(sensor), near_[sensor].sky};
    }

    const SkyView* view_;
    std::span<const NearLight> near_;
    daylight::SkyGrid grid_;
    std::vector<Node> nodes_; // that any sensor sees
    std::vector<Share> shares_;
    std::vector<size_t> first_{0}; // of each sensor's shares
    std::vector<float> ground_;    // weight of each sensor's ground
};

} // namespace heliodon::compute
