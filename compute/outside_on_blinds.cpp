#include "compute/outside_on_blinds.h"

#include "compute/parallel.h"

namespace heliodon::compute {

OutsideOnBlinds::OutsideOnBlinds(const PointScene& scene, const GlowingBlinds& blinds) {
    if (scene.outside().cells().empty()) return;
    constexpr double kAngle = 0.2; // radians, of one sample
    std::vector<size_t> group;     // of patches_
    size_t row = 0;
    for (size_t g = 0; g < blinds.groups().size(); ++g)
        for (const uint32_t patch : blinds.groups()[g].patches) {
            patches_.push_back({patch, row++, {}});
            group.push_back(g);
        }
    inParallel(patches_.size(), [&](size_t k) {
        Patch& at = patches_[k];
        const GlowingBlinds::Group& of = blinds.groups()[group[k]];
        scene.seeWallsBefore(at.patch, kAngle, [&](uint32_t cell, glm::dvec3 towards, double factor) {
            at.shares.push_back({cell, glm::vec3(factor * of.window.scattered(towards, of.normal))});
        });
        mergeShares(at.shares);
    });
    std::erase_if(patches_, [](const Patch& p) { return p.shares.empty(); });
}

} // namespace heliodon::compute
