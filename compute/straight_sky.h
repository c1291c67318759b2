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
#include "compute/vector_width.h"

namespace heliodon::compute {

// Skies of many hours, made ready once for any number of sensors.
class StraightHours {
public:
    static constexpr size_t kTables = 2; // of skies that are looked up together
    static constexpr size_t kTableBytes = 32 << 20;

    // `skies` outlive this. 10 us an hour; its table, 4 kB, is kept of as many as `tableBytes` hold, 8000
    // hours, and made anew for all others in each StraightSky::addTo.
    StraightHours(std::span<const daylight::Sky> skies, std::vector<uint32_t> hours,
                  size_t tableBytes = kTableBytes);
    StraightHours(const StraightHours&) = delete; // blocks of hours look into it
    StraightHours& operator=(const StraightHours&) = delete;

    std::span<const daylight::Sky> skies() const { return skies_; }
    const daylight::SkyGrid& grid() const { return grid_; }
    size_t count() const { return hours_.size(); }
    size_t bytes() const; // of what is kept

    struct Block { // hours that are looked up together
        std::span<const uint32_t> hours;
        bool bySamples; // too steep for nodes
        std::vector<daylight::SkyTables> tables;
    };
    size_t blocks() const { return blocks_.size(); }
    // work(block), its tables there.
    void withBlock(size_t block, const std::function<void(const Block&)>& work) const;

private:
    std::vector<daylight::SkyTables> tablesOf(std::span<const uint32_t> hours) const;

    std::span<const daylight::Sky> skies_;
    daylight::SkyGrid grid_;
    std::vector<uint32_t> hours_; // block by block
    std::vector<Block> blocks_;
};

class StraightSky {
public:
    struct Node {
        glm::vec3 direction;
        float heightIndex; // of SkyTables
    };
    struct Share {
        uint32_t node;
        float weight; // photometric
    };

    // `near`: of the view's points; empty ones have no such walls. All must outlive this. What the nodes of
    // SkyGrid tell of samples is off by as much as stated there for a sensor that sees little of the sky. Of
    // those on each patch of an L-shaped sketch in Chicago's weather, by 6e-4 of a sensor's light at the
    // worst hour, 5e-6 in the root mean square.
    StraightSky(const StraightHours& hours, const SkyView& view, std::span<const NearLight> near);

    // Adds each sensor's photometric lux in these hours to `lux`, sensors x skies. 0.1 ns an hour and node
    // that a sensor sees, some hundred beside a window; 1.5 ns an hour and node that any sees. Steep skies:
    // 1.5 ns an hour and sample. `done`: how many hours are.
    void addTo(std::span<float> lux, const std::function<void(size_t)>& done = {},
               VectorWidth width = widestVectors()) const;

private:
    void addByNodes(std::span<float> lux, const StraightHours::Block& block, VectorWidth width) const;
    void addBySamples(std::span<float> lux, const StraightHours::Block& block, VectorWidth width) const;
    std::array<std::span<const SkySample>, 2> samplesOf(size_t sensor) const {
        return {view_->of(sensor), near_[sensor].sky};
    }

    const StraightHours* hours_;
    const SkyView* view_;
    std::span<const NearLight> near_;
    std::vector<Node> nodes_; // that any sensor sees
    std::vector<Share> shares_;
    std::vector<size_t> first_{0}; // of each sensor's shares
    std::vector<float> ground_;    // weight of each sensor's ground
};

} // namespace heliodon::compute
