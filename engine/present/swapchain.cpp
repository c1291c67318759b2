#include "engine/present/swapchain.h"

#include <algorithm>

#include "compute/gpu/device.h"
#include "compute/gpu/enumerate.h"
#include "compute/gpu/error.h"

namespace heliodon::present {

using gpu::check;

Swapchain::Swapchain(gpu::Device& device, VkSurfaceKHR surface, bool waitForRefresh, bool codeBefore)
    : device_(&device), surface_(surface), waitForRefresh_(waitForRefresh) {
    try {
        VkBool32 supported = VK_FALSE;
        check(vkGetPhysicalDeviceSurfaceSupportKHR(device.physical(), device.queueFamily(), surface,
                                                   &supported),
              "vkGetPhysicalDeviceSurfaceSupportKHR");
        if (!supported)
            throw gpu::Error("the device " + device.info().name + " cannot present to this window");
        chooseFormat(codeBefore);
        const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
        check(vkCreateFence(device.handle(), &fence, nullptr, &acquired_), "vkCreateFence");
    } catch (...) {
        vkDestroySurfaceKHR(device.instance(), surface, nullptr);
        throw;
    }
}

Swapchain::~Swapchain() {
    // Presentation is no submission, so the device's tickets say nothing about it.
    vkQueueWaitIdle(device_->queue());
    vkDestroySwapchainKHR(device_->handle(), swapchain_, nullptr);
    vkDestroyFence(device_->handle(), acquired_, nullptr);
    vkDestroySurfaceKHR(device_->instance(), surface_, nullptr);
}

void Swapchain::chooseFormat(bool codeBefore) {
    const auto formats = gpu::enumerate<VkSurfaceFormatKHR>(
        "vkGetPhysicalDeviceSurfaceFormatsKHR", [&](uint32_t* count, VkSurfaceFormatKHR* list) {
            return vkGetPhysicalDeviceSurfaceFormatsKHR(device_->physical(), surface_, count, list);
        });
    const auto find = [&](VkFormat blueFirst, VkFormat redFirst) {
        return std::find_if(formats.begin(), formats.end(), [&](const VkSurfaceFormatKHR& f) {
            return (f.format == blueFirst || f.format == redFirst) &&
                   f.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR;
        });
    };
    const auto srgb = find(VK_FORMAT_B8G8R8A8_SRGB, VK_FORMAT_R8G8B8A8_SRGB),
               plain = find(VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM);
    if (srgb == formats.end() && plain == formats.end())
        throw gpu::Error("the window offers no 8-bit format for sRGB pictures");
    format_ = *(srgb == formats.end() || (codeBefore && plain != formats.end()) ? plain : srgb);
}

VkPresentModeKHR Swapchain::choosePresentMode() const {
    const auto modes = gpu::enumerate<VkPresentModeKHR>(
        "vkGetPhysicalDeviceSurfacePresentModesKHR", [&](uint32_t* count, VkPresentModeKHR* list) {
            return vkGetPhysicalDeviceSurfacePresentModesKHR(device_->physical(), surface_, count, list);
        });
    const bool immediate =
        !waitForRefresh_ && std::count(modes.begin(), modes.end(), VK_PRESENT_MODE_IMMEDIATE_KHR);
    return immediate ? VK_PRESENT_MODE_IMMEDIATE_KHR : VK_PRESENT_MODE_FIFO_KHR;
}

bool Swapchain::rebuild(uint32_t width, uint32_t height) {
    VkSurfaceCapabilitiesKHR can{};
    check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_->physical(), surface_, &can),
          "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
    VkExtent2D extent = can.currentExtent;
    if (extent.width == UINT32_MAX) // the swapchain decides
        extent = {std::clamp(width, can.minImageExtent.width, can.maxImageExtent.width),
                  std::clamp(height, can.minImageExtent.height, can.maxImageExtent.height)};
    if (extent.width == 0 || extent.height == 0) {
        stale_ = true;
        return false;
    }
    if (!(can.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT))
        throw gpu::Error("pictures cannot be copied into the window's images (TRANSFER_DST)");
    canBeRead_ = can.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    VkSwapchainCreateInfoKHR info{VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
    info.surface = surface_;
    info.minImageCount = can.minImageCount + 1;
    if (can.maxImageCount > 0) info.minImageCount = std::min(info.minImageCount, can.maxImageCount);
    info.imageFormat = format_.format;
    info.imageColorSpace = format_.colorSpace;
    info.imageExtent = extent;
    info.imageArrayLayers = 1;
    info.imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    if (canBeRead_) info.imageUsage |= VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    info.imageSharingMode = VK_SHARING_MODE_EXCLUSIVE;
    info.preTransform = can.currentTransform;
    // Opaque, the lowest bit, where there is that; there is always one.
    info.compositeAlpha = static_cast<VkCompositeAlphaFlagBitsKHR>(can.supportedCompositeAlpha &
                                                                   (~can.supportedCompositeAlpha + 1));
    info.presentMode = choosePresentMode();
    info.clipped = VK_TRUE;
    info.oldSwapchain = swapchain_;
    vkQueueWaitIdle(device_->queue());
    VkSwapchainKHR fresh = VK_NULL_HANDLE;
    check(vkCreateSwapchainKHR(device_->handle(), &info, nullptr, &fresh), "vkCreateSwapchainKHR");
    vkDestroySwapchainKHR(device_->handle(), swapchain_, nullptr);
    swapchain_ = fresh;
    extent_ = extent;
    stale_ = false;
    images_ = gpu::enumerate<VkImage>("vkGetSwapchainImagesKHR", [&](uint32_t* count, VkImage* list) {
        return vkGetSwapchainImagesKHR(device_->handle(), swapchain_, count, list);
    });
    return true;
}

VkResult Swapchain::acquire(uint32_t& index) {
    constexpr uint64_t kLongest = 100'000'000; // ns; several refreshes of any display
    const VkResult result =
        vkAcquireNextImageKHR(device_->handle(), swapchain_, kLongest, VK_NULL_HANDLE, acquired_, &index);
    if (result == VK_NOT_READY) return VK_TIMEOUT;
    if (result != VK_SUCCESS && result != VK_SUBOPTIMAL_KHR) return result;
    check(vkWaitForFences(device_->handle(), 1, &acquired_, VK_TRUE, UINT64_MAX), "vkWaitForFences");
    check(vkResetFences(device_->handle(), 1, &acquired_), "vkResetFences");
    return result;
}

} // namespace heliodon::present
