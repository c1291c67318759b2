// What blinds scatter of the light that what stands outside reflects on to their windows. Slats shine with it
// as brightly as they let it in, alike in all directions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compute/glowing_blinds.h"
#include "compute/outside_cells.h"
#include "compute/point_scene.h"

namespace heliodon::compute {

class OutsideOnBlinds {
public:
    // Nothing, at no cost, without blinds or where nothing reflects light on to them; else about 50 us of one
    // core for each of their patches and regions that it sees, from its middle.
    OutsideOnBlinds(const PointScene& scene, const GlowingBlinds& blinds);

    struct Patch {
        uint32_t patch;
        size_t row;                       // place among all patches of blinds, in the order of their groups
        std::vector<OutsideShare> shares; // exitance into the room for each lux of exitance of a cell
    };
    std::span<const Patch> patches() const { return patches_; }

private:
    std::vector<Patch> patches_;
};

} // namespace heliodon::compute
