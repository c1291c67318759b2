// A buffer on the device, for every use that the program has for one: storage, texels to read, vertices,
// indices, transfer.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

#include "compute/gpu/memory.h"

namespace heliodon::gpu {

class Device;

class Buffer {
public:
    Buffer() = default;
    // `bytes` of zero is allowed and makes a small buffer, so that empty input needs no special case in a
    // kernel. What it holds is not set. Throws Error where the device has no room or takes none so large.
    Buffer(Device& device, size_t bytes, const std::string& name, Place place = Place::device);
    Buffer(Buffer&& other) noexcept { *this = std::move(other); }
    Buffer& operator=(Buffer&& other) noexcept;
    ~Buffer() { reset(); }

    template<class T> static Buffer from(Device& device, std::span<const T> values, const std::string& name) {
        Buffer buffer(device, values.size_bytes(), name);
        buffer.upload(values);
        return buffer;
    }
    template<class T>
    static Buffer from(Device& device, const std::vector<T>& values, const std::string& name) {
        return from(device, std::span<const T>(values), name);
    }

    VkBuffer handle() const { return buffer_; }
    size_t bytes() const { return bytes_; }
    // What it really has: up to the next 16 bytes, so that texels of four floats cover it whole. What stands
    // beyond bytes() is not set.
    size_t roundedBytes() const { return std::max<size_t>((bytes_ + 15) / 16 * 16, 16); }
    bool valid() const { return buffer_ != VK_NULL_HANDLE; }
    // Null when the host cannot see the memory. Reading or writing it while the device uses it is a race.
    template<class T = std::byte> T* mapped() const { return static_cast<T*>(allocation_.mapped); }

    // Copies to the device; waits for it. Not for inner loops: record a copy instead.
    template<class T> void upload(std::span<const T> values, size_t byteOffset = 0) {
        uploadBytes(values.data(), values.size_bytes(), byteOffset);
    }
    template<class T> void upload(const std::vector<T>& values, size_t byteOffset = 0) {
        upload(std::span<const T>(values), byteOffset);
    }
    // Copies `count` values back; the work that writes them must have been waited for.
    template<class T> std::vector<T> download(size_t count, size_t byteOffset = 0) const {
        std::vector<T> values(count);
        downloadBytes(values.data(), count * sizeof(T), byteOffset);
        return values;
    }

    // A view for texelFetch and imageLoad; made once per format and range.
    VkBufferView texelView(VkFormat format, size_t byteOffset = 0, size_t bytes = VK_WHOLE_SIZE) const;

    // A part of it in memory that the host sees; the work that writes it must have been waited for.
    Buffer hostCopy(size_t bytes, size_t byteOffset = 0) const;

private:
    void reset();
    void uploadBytes(const void* data, size_t bytes, size_t byteOffset);
    void downloadBytes(void* data, size_t bytes, size_t byteOffset) const;

    struct TexelView {
        VkFormat format;
        size_t offset, bytes;
        VkBufferView view;
    };

    Device* device_ = nullptr;
    VkBuffer buffer_ = VK_NULL_HANDLE;
    Allocation allocation_;
    size_t bytes_ = 0;
    mutable std::vector<TexelView> views_;
};

// `count` values of a buffer, for the host to read while this lives: the buffer's own memory where the host
// sees it, else a copy, which it waits for. Cheaper than download(): nothing is copied twice, and no new
// memory is touched. The buffer must outlive it; the work that writes must have been waited for; `byteOffset`
// is a multiple of sizeof(T). Throws Error.
template<class T> class HostView {
public:
    HostView(const Buffer& buffer, size_t count, size_t byteOffset = 0)
        : copy_(buffer.mapped() ? Buffer() : buffer.hostCopy(count * sizeof(T), byteOffset)),
          data_(buffer.mapped() ? buffer.mapped<T>() + byteOffset / sizeof(T) : copy_.mapped<T>()) {}
    const T* data() const { return data_; }
    const T& operator[](size_t i) const { return data_[i]; }

private:
    Buffer copy_;
    const T* data_;
};

} // namespace heliodon::gpu
