#include "compute/gpu/image.h"

#include <utility>

#include <fmt/format.h>

#include "compute/gpu/device.h"
#include "compute/gpu/error.h"

namespace heliodon::gpu {

Image::Image(Device& device, const ImageInfo& info, const std::string& name) : device_(&device), info_(info) {
    const uint32_t most = device.limits().maxImageDimension2D;
    if (info.width > most || info.height > most)
        throw Error(VK_ERROR_FORMAT_NOT_SUPPORTED,
                    fmt::format("{}: a picture of {} x {} pixels is drawn, the device takes {} along an edge",
                                name, info.width, info.height, most));
    VkImageCreateInfo create{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    create.flags = info.flags;
    create.imageType = VK_IMAGE_TYPE_2D;
    create.format = info.format;
    create.extent = {info.width, info.height, 1};
    create.mipLevels = 1;
    create.arrayLayers = info.layers;
    create.samples = info.samples;
    create.tiling = VK_IMAGE_TILING_OPTIMAL;
    create.usage = info.usage;
    create.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
    check(vkCreateImage(device.handle(), &create, nullptr, &image_), "vkCreateImage");
    VkMemoryRequirements need{};
    vkGetImageMemoryRequirements(device.handle(), image_, &need);
    try {
        allocation_ = device.memory().allocate(need, Place::device, true);
        check(vkBindImageMemory(device.handle(), image_, allocation_.memory, allocation_.offset),
              "vkBindImageMemory");
        device.setName(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<uint64_t>(image_), name);
        VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
        view.image = image_;
        view.viewType = info.layers > 1 ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D;
        view.format = info.format;
        view.subresourceRange = {aspect(), 0, 1, 0, info.layers};
        check(vkCreateImageView(device.handle(), &view, nullptr, &view_), "vkCreateImageView");
    } catch (...) {
        reset();
        throw;
    }
}

VkImageAspectFlags Image::aspect() const {
    switch (info_.format) {
    case VK_FORMAT_D16_UNORM:
    case VK_FORMAT_X8_D24_UNORM_PACK32:
    case VK_FORMAT_D32_SFLOAT:
        return VK_IMAGE_ASPECT_DEPTH_BIT;
    case VK_FORMAT_D16_UNORM_S8_UINT:
    case VK_FORMAT_D24_UNORM_S8_UINT:
    case VK_FORMAT_D32_SFLOAT_S8_UINT:
        return VK_IMAGE_ASPECT_DEPTH_BIT | VK_IMAGE_ASPECT_STENCIL_BIT;
    default:
        return VK_IMAGE_ASPECT_COLOR_BIT;
    }
}

Image& Image::operator=(Image&& other) noexcept {
    if (this == &other) return *this;
    reset();
    device_ = std::exchange(other.device_, nullptr);
    image_ = std::exchange(other.image_, VK_NULL_HANDLE);
    view_ = std::exchange(other.view_, VK_NULL_HANDLE);
    allocation_ = other.allocation_;
    info_ = other.info_;
    return *this;
}

void Image::reset() {
    if (!image_) return;
    device_->retire([device = device_, image = image_, view = view_, allocation = allocation_] {
        vkDestroyImageView(device->handle(), view, nullptr);
        vkDestroyImage(device->handle(), image, nullptr);
        if (allocation.memory) device->memory().free(allocation);
    });
    image_ = VK_NULL_HANDLE;
}

} // namespace heliodon::gpu
