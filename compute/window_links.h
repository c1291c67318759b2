// Light that runs from patch to patch through windows that one can see through: interior windows, and windows
// to the outside that look at other windows of the building.
#pragma once

#include <cstdint>
#include <vector>

#include "compute/gpu/buffer.h"
#include "compute/point_scene.h"

namespace heliodon::compute {

// Form factors through panes, times their transmittance, put into a matrix whose rooms do not see one
// another. From one point a patch, the mean of both ends: A_i F_ij = A_j F_ji holds.
class WindowLinks {
public:
    // F: float32, patchCount^2, row-major; from now on with the links. Nothing, at no cost, where no room
    // sees another. About 0.5 ms for each patch that sees a pane, of 2000, on two cores.
    WindowLinks(const PointScene& scene, gpu::Buffer& factors);

    // Takes them out again, to the bit.
    void remove(gpu::Buffer& factors) const;

    // Per patch: sum of its links; empty where there are none.
    const std::vector<float>& rowSums() const { return rowSums_; }

private:
    struct Entry {
        size_t at;
        float before;
    };
    std::vector<Entry> entries_;
    std::vector<float> rowSums_;
};

} // namespace heliodon::compute
