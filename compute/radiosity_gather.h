// Illuminance from radiosity through a dense F: host half of shaders/radiosity_gather.comp.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compute/form_factor_operator.h"
#include "compute/gpu/buffer.h"
#include "compute/gpu/commands.h"
#include "compute/gpu/kernel.h"

namespace heliodon::compute {

class RadiosityGather : public FormFactorOperator {
public:
    static constexpr uint32_t kMostColumns = 4;

    // `factors`: float32, patchCount^2, row-major, a whole buffer; must outlive this.
    RadiosityGather(gpu::Device& device, const gpu::Buffer& factors, uint32_t patchCount);

    uint32_t patchCount() const override { return patchCount_; }

    // At n = 2000 about 1 ms for three columns on two cores; F is read once per four columns.
    void gather(std::span<const float> in, std::span<float> out, uint32_t columns) override;

    // `light` as io::RadiosityGatherParams describes it, `gathered` columns x patchCount floats; 1 to
    // kMostColumns columns.
    void record(gpu::Commands& commands, const gpu::Buffer& light, const gpu::Buffer& gathered,
                uint32_t columns);

private:
    void packLight(std::span<const float> in, uint32_t columns);

    gpu::Device* device_;
    const gpu::Buffer* factors_;
    uint32_t patchCount_, texelsPerColumn_;
    std::vector<gpu::Kernel> kernels_; // by columns - 1
    std::vector<float> packed_;
    gpu::Buffer light_, gathered_;
};

} // namespace heliodon::compute
