// A 2-D image, possibly with layers, on the device.
#pragma once

#include <cstdint>
#include <string>

#include <vulkan/vulkan.h>

#include "compute/gpu/memory.h"

namespace heliodon::gpu {

class Device;

struct ImageInfo {
    uint32_t width = 1, height = 1, layers = 1;
    VkFormat format = VK_FORMAT_R8G8B8A8_UNORM;
    VkImageUsageFlags usage = 0;
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
    VkImageCreateFlags flags = 0;
};

// Optimally tiled, in device memory; freed when the device has done what it was last submitted for. Throws
// Error when it is larger than the device's limits or Vulkan refuses.
class Image {
public:
    Image() = default;
    Image(Device& device, const ImageInfo& info, const std::string& name);
    Image(Image&& other) noexcept { *this = std::move(other); }
    Image& operator=(Image&& other) noexcept;
    ~Image() { reset(); }

    VkImage handle() const { return image_; }
    const ImageInfo& info() const { return info_; }
    VkImageAspectFlags aspect() const;
    VkImageView view() const { return view_; } // all layers, as a 2-D array when there are several
    bool valid() const { return image_ != VK_NULL_HANDLE; }

private:
    void reset();

    Device* device_ = nullptr;
    VkImage image_ = VK_NULL_HANDLE;
    VkImageView view_ = VK_NULL_HANDLE;
    Allocation allocation_;
    ImageInfo info_;
};

} // namespace heliodon::gpu
