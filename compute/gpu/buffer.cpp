#include "compute/gpu/buffer.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include <fmt/format.h>

#include "compute/gpu/commands.h"
#include "compute/gpu/device.h"
#include "compute/gpu/error.h"

namespace heliodon::gpu {

Buffer::Buffer(Device& device, size_t bytes, const std::string& name, Place place)
    : device_(&device), bytes_(bytes) {
    VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    info.size = roundedBytes();
    if (const VkDeviceSize most = device.memory().largestBuffer(); info.size > most)
        throw Error(VK_ERROR_OUT_OF_DEVICE_MEMORY,
                    fmt::format("{}: a buffer of {} bytes, the device takes {}", name, info.size, most));
    info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
                 VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT |
                 VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    info.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
    check(vkCreateBuffer(device.handle(), &info, nullptr, &buffer_), "vkCreateBuffer");
    VkMemoryRequirements need{};
    vkGetBufferMemoryRequirements(device.handle(), buffer_, &need);
    try {
        allocation_ = device.memory().allocate(need, place, false);
        check(vkBindBufferMemory(device.handle(), buffer_, allocation_.memory, allocation_.offset),
              "vkBindBufferMemory");
    } catch (...) {
        reset();
        throw;
    }
    device.setName(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<uint64_t>(buffer_), name);
}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
    if (this == &other) return *this;
    reset();
    device_ = std::exchange(other.device_, nullptr);
    buffer_ = std::exchange(other.buffer_, VK_NULL_HANDLE);
    allocation_ = other.allocation_;
    bytes_ = std::exchange(other.bytes_, 0);
    views_ = std::move(other.views_);
    other.views_.clear();
    return *this;
}

void Buffer::reset() {
    if (!buffer_) return;
    device_->retire(
        [device = device_, buffer = buffer_, allocation = allocation_, views = std::move(views_)] {
            for (const TexelView& view : views) vkDestroyBufferView(device->handle(), view.view, nullptr);
            vkDestroyBuffer(device->handle(), buffer, nullptr);
            if (allocation.memory) device->memory().free(allocation);
        });
    buffer_ = VK_NULL_HANDLE;
    views_.clear();
}

void Buffer::uploadBytes(const void* data, size_t bytes, size_t byteOffset) {
    assert(byteOffset + bytes <= bytes_);
    if (bytes == 0) return;
    if (allocation_.mapped) {
        std::memcpy(mapped<std::byte>() + byteOffset, data, bytes);
        return;
    }
    Buffer staging(*device_, bytes, "upload", Place::host);
    std::memcpy(staging.mapped(), data, bytes);
    Commands commands(*device_);
    commands.copy(staging, 0, *this, byteOffset, bytes);
    device_->submitAndWait(std::move(commands));
}

void Buffer::downloadBytes(void* data, size_t bytes, size_t byteOffset) const {
    if (bytes == 0) return;
    if (allocation_.mapped) {
        assert(byteOffset + bytes <= bytes_);
        std::memcpy(data, mapped<std::byte>() + byteOffset, bytes);
    } else
        std::memcpy(data, hostCopy(bytes, byteOffset).mapped(), bytes);
}

Buffer Buffer::hostCopy(size_t bytes, size_t byteOffset) const {
    assert(byteOffset + bytes <= bytes_);
    Buffer copy(*device_, bytes, "host copy", Place::host);
    if (bytes == 0) return copy;
    Commands commands(*device_);
    commands.copy(*this, byteOffset, copy, 0, bytes);
    device_->submitAndWait(std::move(commands));
    return copy;
}

VkBufferView Buffer::texelView(VkFormat format, size_t byteOffset, size_t bytes) const {
    for (const TexelView& view : views_)
        if (view.format == format && view.offset == byteOffset && view.bytes == bytes) return view.view;
    VkBufferViewCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
    info.buffer = buffer_;
    info.format = format;
    info.offset = byteOffset;
    info.range = bytes;
    VkBufferView view = VK_NULL_HANDLE;
    check(vkCreateBufferView(device_->handle(), &info, nullptr, &view), "vkCreateBufferView");
    views_.push_back({format, byteOffset, bytes, view});
    return view;
}

} // namespace heliodon::gpu
