#include "compute/radiosity_gather.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "compute/gpu/device.h"
#include "compute/gpu/error.h"
#include "shaders/io/radiosity_gather.io.h"
#include "spirv/radiosity_gather_comp.h"

namespace heliodon::compute {

RadiosityGather::RadiosityGather(gpu::Device& device, const gpu::Buffer& factors, uint32_t patchCount)
    : device_(&device), factors_(&factors), patchCount_(patchCount),
      texelsPerColumn_((patchCount + 3) / 4 + 1) {
    for (uint32_t columns = 1; columns <= kMostColumns; ++columns)
        kernels_.emplace_back(device, radiosity_gather_comp, "radiosity gather",
                              gpu::Specialization{{"kColumns", columns}});
    packed_.resize(size_t{kMostColumns} * 16 * texelsPerColumn_);
    light_ = gpu::Buffer(device, packed_.size() * sizeof(float), "gather light");
    gathered_ =
        gpu::Buffer(device, size_t{kMostColumns} * patchCount * sizeof(float), "gathered", gpu::Place::host);
    // The last row's last texel may reach beyond F. No light is there, but nought times what stands in unused
    // memory need not be nought.
    const size_t end = size_t{patchCount} * patchCount * sizeof(float);
    if (end % 16 == 0) return;
    gpu::Commands commands(device);
    commands.fill(factors, 0, end, factors.roundedBytes() - end);
    device.submitAndWait(std::move(commands));
}

void RadiosityGather::packLight(std::span<const float> in, uint32_t columns) {
    const uint32_t shifts = patchCount_ % 4 == 0 ? 1 : 4;
    for (uint32_t c = 0; c < columns; ++c)
        for (uint32_t shift = 0; shift < shifts; ++shift)
            std::memcpy(&packed_[(size_t{c} * 4 + shift) * 4 * texelsPerColumn_ + shift],
                        &in[size_t{c} * patchCount_], patchCount_ * sizeof(float));
}

void RadiosityGather::record(gpu::Commands& commands, const gpu::Buffer& light, const gpu::Buffer& gathered,
                             uint32_t columns) {
    constexpr VkFormat kVec4 = VK_FORMAT_R32G32B32A32_SFLOAT;
    const size_t rowBytes = size_t{patchCount_} * sizeof(float);
    // Windows within the device's limit on texels, of as many rows as begin where the device wants texel
    // buffers to begin.
    const VkPhysicalDeviceLimits& limits = device_->limits();
    const size_t unit = std::max<size_t>(limits.minTexelBufferOffsetAlignment, 16) / sizeof(float);
    const size_t most =
        std::min<size_t>(size_t{limits.maxTexelBufferElements} * 16 / rowBytes,
                         UINT32_MAX / patchCount_) / // of entries: the shader counts in 32 bits
        unit *
        unit;
    if (most == 0)
        throw gpu::Error(fmt::format("{} rows of {} form factors are over the device's {} texels of a buffer",
                                     unit, patchCount_, limits.maxTexelBufferElements));
    const auto window = static_cast<uint32_t>(most);
    const uint32_t blocksPerGroup = io::kGatherGroup / std::max(1u, device_->subgroupSize());
    for (uint32_t first = 0; first < patchCount_; first += window) {
        const uint32_t rows = std::min(window, patchCount_ - first);
        const size_t texels = (rows * rowBytes + 15) / 16;
        const io::RadiosityGatherParams params{patchCount_, rows, first, texelsPerColumn_};
        commands.dispatch(
            kernels_[columns - 1],
            {gpu::texel(*factors_, kVec4, first * rowBytes, texels * 16), gpu::texel(light, kVec4), gathered},
            params, gpu::groupsFor(4 * gpu::groupsFor(rows, 4 * io::kGatherRows), blocksPerGroup));
    }
}

void RadiosityGather::gather(std::span<const float> in, std::span<float> out, uint32_t columns) {
    if (patchCount_ == 0) return;
    for (uint32_t first = 0; first < columns; first += kMostColumns) {
        const uint32_t count = std::min(kMostColumns, columns - first);
        packLight(in.subspan(size_t{first} * patchCount_, size_t{count} * patchCount_), count);
        light_.upload(packed_);
        gpu::Commands commands(*device_);
        record(commands, light_, gathered_, count);
        device_->submitAndWait(std::move(commands));
        std::memcpy(&out[size_t{first} * patchCount_], gathered_.mapped(),
                    size_t{count} * patchCount_ * sizeof(float));
    }
}

} // namespace heliodon::compute
