#include "compute/gpu/commands.h"

#include <cassert>
#include <utility>
#include <vector>

#include "compute/gpu/buffer.h"
#include "compute/gpu/device.h"
#include "compute/gpu/error.h"
#include "compute/gpu/image.h"
#include "compute/gpu/kernel.h"

namespace heliodon::gpu {

struct Commands::Scope {
    VkPipelineStageFlags2 stage;
    VkAccessFlags2 access;
};

Commands::Scope Commands::scopeOf(Stage stage) {
    switch (stage) {
    case Stage::compute:
        return {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT};
    case Stage::transfer:
        return {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT};
    case Stage::fragment:
        return {VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT};
    case Stage::colour:
        return {VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT};
    case Stage::depth:
        return {VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
                VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
                    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT};
    case Stage::any:
        break;
    }
    return {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
}

Commands::Commands(Device& device) : device_(&device), buffer_(device.beginCommandBuffer()) {}

Commands::Commands(Commands&& other) noexcept
    : device_(other.device_), buffer_(std::exchange(other.buffer_, VK_NULL_HANDLE)) {}

Commands::~Commands() {
    if (buffer_) device_->abandonCommandBuffer(buffer_);
}

void Commands::dispatchBytes(const Kernel& kernel, std::span<const Binding> resources, const void* params,
                             size_t paramBytes, std::array<uint32_t, 3> groups) {
    const auto& most = device_->limits().maxComputeWorkGroupCount;
    for (int axis = 0; axis < 3; ++axis)
        if (groups[static_cast<size_t>(axis)] > most[axis])
            throw Error("dispatch of " + kernel.name() + ": more groups than the device allows");
    if (groups[0] == 0 || groups[1] == 0 || groups[2] == 0) return;
    vkCmdBindPipeline(buffer_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.handle());
    kernel.layout().push(buffer_, VK_PIPELINE_BIND_POINT_COMPUTE, resources, params, paramBytes);
    vkCmdDispatch(buffer_, groups[0], groups[1], groups[2]);
}

void Commands::barrier(Stage from, Stage to) {
    barrier(scopeOf(from), scopeOf(to));
}

void Commands::close() {
    const Scope all = scopeOf(Stage::any);
    barrier(all, {all.stage | VK_PIPELINE_STAGE_2_HOST_BIT, all.access});
    check(vkEndCommandBuffer(buffer_), "vkEndCommandBuffer");
}

void Commands::barrier(const Scope& source, const Scope& target) {
    VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    memory.srcStageMask = source.stage;
    memory.srcAccessMask = source.access;
    memory.dstStageMask = target.stage;
    memory.dstAccessMask = target.access;
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.memoryBarrierCount = 1;
    info.pMemoryBarriers = &memory;
    vkCmdPipelineBarrier2(buffer_, &info);
}

void Commands::transition(const Image& image, VkImageLayout from, VkImageLayout to, Stage before,
                          Stage after) {
    const Scope source = scopeOf(before), target = scopeOf(after);
    VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
    barrier.srcStageMask = source.stage;
    barrier.srcAccessMask = source.access;
    barrier.dstStageMask = target.stage;
    barrier.dstAccessMask = target.access;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image.handle();
    barrier.subresourceRange = {image.aspect(), 0, 1, 0, image.info().layers};
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.imageMemoryBarrierCount = 1;
    info.pImageMemoryBarriers = &barrier;
    vkCmdPipelineBarrier2(buffer_, &info);
}

void Commands::copy(const Buffer& from, size_t fromOffset, const Buffer& to, size_t toOffset, size_t bytes) {
    assert(fromOffset + bytes <= from.bytes() && toOffset + bytes <= to.bytes());
    if (bytes == 0) return;
    const VkBufferCopy region{fromOffset, toOffset, bytes};
    vkCmdCopyBuffer(buffer_, from.handle(), to.handle(), 1, &region);
}

void Commands::copyRows(const Buffer& from, size_t fromStride, const Buffer& to, size_t toOffset,
                        size_t toStride, size_t rowBytes, size_t rows) {
    if (rowBytes == 0 || rows == 0) return;
    assert((rows - 1) * fromStride + rowBytes <= from.bytes());
    assert(toOffset + (rows - 1) * toStride + rowBytes <= to.bytes());
    std::vector<VkBufferCopy> regions;
    regions.reserve(rows);
    for (size_t row = 0; row < rows; ++row)
        regions.push_back({row * fromStride, toOffset + row * toStride, rowBytes});
    vkCmdCopyBuffer(buffer_, from.handle(), to.handle(), static_cast<uint32_t>(rows), regions.data());
}

void Commands::fill(const Buffer& buffer, uint32_t word, size_t offset, size_t bytes) {
    vkCmdFillBuffer(buffer_, buffer.handle(), offset, bytes, word);
}

} // namespace heliodon::gpu
