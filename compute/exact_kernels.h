// The compute kernels of `exact`, by what they do. Made at their first use, unless prepared before. The
// device outlives them; throws gpu::Error where one cannot be made.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "compute/gpu/kernel.h"

namespace heliodon::gpu {
class Device;
}

namespace heliodon::compute {

class ExactKernels {
public:
    ExactKernels() = default;
    // `mostCorners` of a piece.
    ExactKernels(gpu::Device& device, uint32_t mostCorners) : device_(&device), corners_(mostCorners) {}

    // Kernels take longer to make than many scenes to compute: begins those that are likely to have work
    // together, in the order of their use.
    void prepare(bool byLines, uint32_t blockers) const;

    const gpu::Kernel& sides() const { return made(sidesSource()); }
    const gpu::Kernel& blocks() const { return made(blocksSource()); }
    const gpu::Kernel& pairs(bool clear) const { return made(pairsSource(clear)); }
    const gpu::Kernel& lines() const { return made(linesSource()); }
    const gpu::Kernel& few(uint32_t blockers) const { return made(fewSource(blockers)); }
    const gpu::Kernel& many() const { return made(manySource()); }
    const gpu::Kernel& finish() const { return made(finishSource()); }

private:
    struct Source {
        std::span<const uint32_t> spirv;
        std::string name;
        gpu::Specialization values;
    };
    static Source sidesSource();
    static Source blocksSource();
    static Source linesSource();
    static Source manySource();
    static Source finishSource();
    Source pairsSource(bool clear) const;
    Source fewSource(uint32_t blockers) const;
    const gpu::Kernel& made(const Source& source) const;

    gpu::Device* device_ = nullptr;
    uint32_t corners_ = 3;
};

} // namespace heliodon::compute
