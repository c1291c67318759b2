// Light that runs from patch to patch through windows that one can see through: interior windows, and windows
// to the outside that look at other windows of the building.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/form_factor_operator.h"
#include "compute/gpu/buffer.h"
#include "compute/outside_return.h"
#include "compute/point_scene.h"

namespace heliodon::compute {

// Form factors through panes, times their photometric transmittance, put into a matrix whose rooms do not see
// one another; what tints make of that is kept beside it (TintedFactors). From one point a patch, the mean of
// both ends: A_i F_ij = A_j F_ji holds.
class WindowLinks {
public:
    // F: float32, patchCount^2, row-major; from now on with the links. Nothing, at no cost, where no room
    // sees another. About 0.5 ms for each patch that sees a pane, of 2000, on two cores.
    WindowLinks(const PointScene& scene, gpu::Buffer& factors);

    // Takes them out again, to the bit.
    void remove(gpu::Buffer& factors) const;

    // Per patch and channel: sum of its links; empty where there are none.
    const std::vector<glm::vec3>& rowSums() const { return rowSums_; }

    // By how much a row's links in the channel that gets most exceed their photometric sum, which is in F;
    // of rowSums() that are not empty.
    float mostTint(size_t i) const;

    // Whether any pane on the way is tinted.
    bool areTinted() const { return !tints_.empty(); }
    // out += what links make of in, in one channel.
    void addLinks(uint32_t channel, std::span<const float> in, std::span<float> out) const;
    // out += what tints add to or take from F in, in one channel.
    void addTints(uint32_t channel, std::span<const float> in, std::span<float> out) const;

private:
    struct Entry {
        size_t at;
        float before, factor;
    };
    std::vector<Entry> entries_;
    std::vector<glm::vec3> rowSums_;
    std::vector<size_t> firstTint_; // of each patch
    std::vector<TintedShare> tints_;
};

// F with links that differ from channel to channel, and with what comes back from outside. `factors` has the
// links already; all must outlive this.
class TintedFactors : public FormFactorOperator {
public:
    TintedFactors(FormFactorOperator& factors, const WindowLinks& links, const OutsideReturn& returned)
        : factors_(&factors), links_(&links), returned_(&returned) {}
    uint32_t patchCount() const override { return factors_->patchCount(); }
    void gather(std::span<const float> in, std::span<float> out, uint32_t columns) override {
        factors_->gather(in, out, columns);
    }
    void gatherIn(std::span<const uint32_t> channel, std::span<const float> in,
                  std::span<float> out) override;

private:
    FormFactorOperator* factors_;
    const WindowLinks* links_;
    const OutsideReturn* returned_;
};

} // namespace heliodon::compute
