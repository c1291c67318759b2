// The images of one window. Internal to the presenter.
#pragma once

#include <cstdint>
#include <vector>

#include <vulkan/vulkan.h>

namespace heliodon::gpu {
class Device;
}

namespace heliodon::present {

class Swapchain {
public:
    // Takes the surface over. Prefers an sRGB format unless `codeBefore` asks for one without.
    Swapchain(gpu::Device& device, VkSurfaceKHR surface, bool waitForRefresh, bool codeBefore);
    Swapchain(const Swapchain&) = delete;
    Swapchain& operator=(const Swapchain&) = delete;
    ~Swapchain();

    // Makes new images of the window's size. False when the window has no area: then there are none.
    bool rebuild(uint32_t width, uint32_t height);
    bool ready() const { return swapchain_ != VK_NULL_HANDLE && !stale_; }
    void markStale() { stale_ = true; }

    // Index of an image that is free to be written now; waits for it, VK_TIMEOUT after 0.1 s.
    // VK_ERROR_OUT_OF_DATE_KHR: rebuild first.
    VkResult acquire(uint32_t& index);

    bool canBeRead() const { return canBeRead_; } // copied from
    VkSwapchainKHR handle() const { return swapchain_; }
    VkImage image(uint32_t index) const { return images_[index]; }
    VkExtent2D extent() const { return extent_; }
    VkFormat format() const { return format_.format; }

private:
    void chooseFormat(bool codeBefore);
    VkPresentModeKHR choosePresentMode() const;

    gpu::Device* device_;
    VkSurfaceKHR surface_;
    bool waitForRefresh_, stale_ = false, canBeRead_ = false;
    VkSurfaceFormatKHR format_{};
    VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
    VkFence acquired_ = VK_NULL_HANDLE;
    VkExtent2D extent_{};
    std::vector<VkImage> images_;
};

} // namespace heliodon::present
