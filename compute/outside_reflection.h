// The externally reflected component of daylight: what stands outside of a building and the outer sides of
// its rooms (PointScene::outside), in cells that sky, ground and sun light and that send light to one another
// and into windows. Each cell is lit as its centre is, and by the sun as far as it is in it. All of them hide
// sky, ground and sun from it; glass sends it nothing. The ground is as in an open field.
//   E = G L + sun + F M,  M = rho E
// Hopkinson, Petherbridge, Longmore: Daylighting, 1966, chapter 5, has the name; there one luminance, a tenth
// of the sky's, stands for all of M.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/daylight/sky_patches.h"
#include "compute/outside_cells.h"
#include "compute/point_scene.h"
#include "compute/sun_patches.h"

namespace heliodon::compute {

class OutsideReflection {
public:
    // Nothing, at no cost, without cells; else 0.1 to 0.3 ms of one core a cell. `scene` and its mesh outlive
    // this; reflectances are read when light is asked for.
    OutsideReflection(const PointScene& scene, const daylight::SkyPatches& sky);

    bool isEmpty() const { return cells_->cells().empty(); }
    std::span<const OutsideCell> cells() const { return cells_->cells(); }
    bool isGrey() const;
    // For reports: what is modelled, or why nothing is.
    std::string inWords() const;

    // Lux on a cell for each cd/m2 of the elements of the sky; the last is the ground.
    std::span<const float> bySky(size_t cell) const { return {&bySky_[cell * elements_], elements_}; }
    // Lux straight from sky and ground, on each cell.
    std::vector<float> skyLight(std::span<const double> luminances) const;
    // The same of a sun of normal illuminance 1; `sun` made to clip anyway. 10 us a cell.
    std::vector<glm::vec3> sunlight(const SunPatches& sun) const;

    // Exitance of cells that get this light straight, with what they send to one another.
    std::vector<glm::vec3> exitance(std::span<const glm::vec3> straight) const;
    // The other way round: in place, what someone gets for each lux of the cells' exitance becomes what it
    // gets for each lux that falls straight on them, in one channel.
    void answer(uint32_t channel, std::span<float> answers) const;

private:
    struct Share {
        uint32_t cell;
        float factor;
    };
    std::span<const Share> seenFrom(size_t cell) const {
        return {shares_.data() + first_[cell], first_[cell + 1] - first_[cell]};
    }
    std::vector<glm::vec3> reflectances() const; // of cells, glass black

    const geometry::PatchMesh* mesh_;
    const OutsideCells* cells_;
    size_t elements_ = 0;
    std::vector<float> bySky_;     // cells x elements
    std::vector<size_t> first_{0}; // of each cell's shares
    std::vector<Share> shares_;    // of other cells, form factors
};

} // namespace heliodon::compute
