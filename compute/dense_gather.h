// H = F B of a dense F by whichever side is faster: few columns on the device, many on the host's cores where F
// lies in their memory.
#pragma once

#include <optional>
#include <span>

#include "compute/form_factor_operator.h"
#include "compute/host_gather.h"
#include "compute/radiosity_gather.h"

namespace heliodon::compute {

class DenseGather : public FormFactorOperator {
public:
    static constexpr uint32_t kMostHostPatches = 8000; // 256 MB of form factors once more

    // `factors` as RadiosityGather takes them.
    DenseGather(gpu::Device& device, const gpu::Buffer& factors, uint32_t patchCount)
        : factors_(&factors), device_(device, factors, patchCount) {}

    uint32_t patchCount() const override { return device_.patchCount(); }
    // The first call with many columns copies F.
    void gather(std::span<const float> in, std::span<float> out, uint32_t columns) override;

    // To be called when `factors` hold other values than before.
    void forgetFactors() { host_.reset(); }
    size_t hostBytes() const { return host_ ? host_->bytes() : 0; }

private:
    const gpu::Buffer* factors_;
    RadiosityGather device_;
    std::optional<HostGather> host_;
};

} // namespace heliodon::compute
