#include "engine/present/window.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "compute/gpu/commands.h"
#include "compute/gpu/device.h"
#include "compute/gpu/error.h"
#include "engine/present/display_server.h"

#define GLFW_INCLUDE_VULKAN
#include <GLFW/glfw3.h>

namespace heliodon::present {

namespace {

bool isSrgb(VkFormat format) {
    return format == VK_FORMAT_B8G8R8A8_SRGB || format == VK_FORMAT_R8G8B8A8_SRGB;
}
bool isBlueFirst(VkFormat format) {
    return format == VK_FORMAT_B8G8R8A8_SRGB || format == VK_FORMAT_B8G8R8A8_UNORM;
}
VkFormat eightBit(bool blueFirst, bool srgb) {
    return blueFirst ? (srgb ? VK_FORMAT_B8G8R8A8_SRGB : VK_FORMAT_B8G8R8A8_UNORM)
                     : (srgb ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R8G8B8A8_UNORM);
}

bool areSame(VkExtent2D a, VkExtent2D b) {
    return a.width == b.width && a.height == b.height;
}

constexpr auto kCopyStage = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
constexpr auto kCopyAccess = VK_ACCESS_2_TRANSFER_WRITE_BIT | VK_ACCESS_2_TRANSFER_READ_BIT;

// Between copies; to PRESENT_SRC for nobody but the semaphore that presentation waits for.
void moveLayout(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to) {
    VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
    const bool shown = to == VK_IMAGE_LAYOUT_PRESENT_SRC_KHR;
    barrier.srcStageMask = kCopyStage;
    barrier.srcAccessMask = kCopyAccess;
    barrier.dstStageMask = shown ? VK_PIPELINE_STAGE_2_NONE : kCopyStage;
    barrier.dstAccessMask = shown ? 0 : kCopyAccess;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.imageMemoryBarrierCount = 1;
    info.pImageMemoryBarriers = &barrier;
    vkCmdPipelineBarrier2(commands, &info);
}

void stretch(VkCommandBuffer commands, const gpu::Image& from, VkImage to, VkExtent2D extent) {
    const auto& size = from.info();
    VkImageBlit region{};
    region.srcSubresource = region.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.srcOffsets[1] = {static_cast<int32_t>(size.width), static_cast<int32_t>(size.height), 1};
    region.dstOffsets[1] = {static_cast<int32_t>(extent.width), static_cast<int32_t>(extent.height), 1};
    const bool same = size.width == extent.width && size.height == extent.height;
    vkCmdBlitImage(commands, from.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region,
                   same ? VK_FILTER_NEAREST : VK_FILTER_LINEAR);
}

void copySame(VkCommandBuffer commands, VkImage from, VkImage to, VkExtent2D extent) {
    VkImageCopy region{};
    region.srcSubresource = region.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.extent = {extent.width, extent.height, 1};
    vkCmdCopyImage(commands, from, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
}

} // namespace

Window::Window(gpu::Device& d, const WindowOptions& o) : device(&d), options(o) {
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE); // a projector keeps its picture while others are used
    glfwWindowHint(GLFW_FOCUS_ON_SHOW, options.display.empty() ? GLFW_TRUE : GLFW_FALSE);
    handle = glfwCreateWindow(options.width, options.height, options.title.c_str(), nullptr, nullptr);
    if (!handle) {
        const char* why = nullptr;
        glfwGetError(&why);
        throw std::runtime_error(
            fmt::format("window '{}' cannot be opened: {}", options.title, why ? why : ""));
    }
    placement.emplace(handle, this->options);
    try {
        openSurface();
    } catch (...) {
        close("");
        throw;
    }
}

void Window::openSurface() {
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    gpu::check(glfwCreateWindowSurface(device->instance(), handle, nullptr, &surface),
               "glfwCreateWindowSurface");
    swapchain = std::make_unique<Swapchain>(*device, surface, options.waitForRefresh, options.codeBefore);
}

// A surface may be lost without its window, as when a display is plugged in again: once more, then.
void Window::surfaceLost() {
    swapchain.reset();
    damaged = true;
    if (std::exchange(surfaceLost_, true)) {
        close(kDisplayLost);
        return;
    }
    try {
        openSurface();
    } catch (const gpu::Error& error) {
        if (error.deviceLost()) throw;
        close(kDisplayLost);
    }
}

void Window::close(const std::string& why) {
    if (handle && beforeClose) std::exchange(beforeClose, {})();
    swapchain.reset();
    if (handle && !displayServerLost()) glfwDestroyWindow(handle);
    handle = nullptr;
    placement.reset();
    if (reason.empty()) reason = why;
}

void Window::place(const std::vector<Display>& connected, const Display* spare) {
    if (handle && placement->follow(connected, spare)) damaged = true;
}

void Window::setFullScreen(bool full) {
    if (!handle) return;
    placement->setFullScreen(full);
    damaged = true;
}

bool Window::fullScreen() const {
    return handle && glfwGetWindowMonitor(handle);
}

std::optional<VkExtent2D> Window::askSize() const {
    int width = 0, height = 0;
    const unsigned before = sizesRefused();
    glfwGetFramebufferSize(handle, &width, &height);
    checkDisplayServer(); // a broken connection leaves any size
    if (sizesRefused() != before) return std::nullopt;
    return VkExtent2D{static_cast<uint32_t>(std::max(width, 0)), static_cast<uint32_t>(std::max(height, 0))};
}

bool Window::hidden() const {
    const bool hidden = handle && (placement->away() || glfwGetWindowAttrib(handle, GLFW_ICONIFIED));
    checkDisplayServer();
    return hidden;
}

std::optional<uint32_t> Window::acquire() {
    // A window that is being dragged may be out of date again at once: next frame, then.
    constexpr int kAttempts = 3;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
        uint32_t index = 0;
        VkResult result = VK_SUCCESS;
        try {
            if (!makeReady()) return std::nullopt;
            result = swapchain->acquire(index);
        } catch (const gpu::Error& error) { // making images may find the surface lost, too
            if (error.code != VK_ERROR_SURFACE_LOST_KHR) throw;
            result = error.code;
        }
        if (result == VK_ERROR_SURFACE_LOST_KHR) {
            surfaceLost();
        } else if (result == VK_ERROR_OUT_OF_DATE_KHR) {
            swapchain->markStale();
        } else if (result == VK_TIMEOUT) {
            // Not one image free within a moment: a window that nobody sees. The others do not wait for it.
            return std::nullopt;
        } else {
            gpu::check(result, "vkAcquireNextImageKHR");
            return index;
        }
    }
    return std::nullopt;
}

bool Window::presented(VkResult result) {
    if (result == VK_ERROR_SURFACE_LOST_KHR) {
        surfaceLost();
        return false;
    }
    if (result == VK_ERROR_OUT_OF_DATE_KHR) {
        swapchain->markStale();
        damaged = true;
        return false;
    }
    if (result == VK_SUBOPTIMAL_KHR && !areSame(suboptimal_, asked_)) {
        swapchain->markStale();
        suboptimal_ = asked_;
    }
    gpu::check(result, "vkQueuePresentKHR");
    damaged = surfaceLost_ = false;
    return true;
}

bool Window::makeReady() {
    if (!handle || hidden()) return false;
    const VkExtent2D size = pixels();
    if (size.width == 0 || size.height == 0) return false;
    if (swapchain->ready()) return true;
    asked_ = size;
    return swapchain->rebuild(size.width, size.height);
}

void Window::update() {
    if (!handle) return;
    if (glfwWindowShouldClose(handle)) {
        close("closed by the user");
        return;
    }
    const std::optional<VkExtent2D> size = askSize();
    if (!size) {
        close("closed by another program");
        return;
    }
    if (!areSame(*size, asked_)) swapchain->markStale();
    if (!swapchain->ready()) damaged = true;
}

void Window::record(gpu::Commands& commands, const gpu::Image& picture, uint32_t index, bool keepCopy) {
    const VkCommandBuffer buffer = commands.handle();
    const VkImage image = swapchain->image(index);
    const VkExtent2D extent = swapchain->extent();
    const VkFormat format = swapchain->format();
    VkImageLayout layout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    moveLayout(buffer, image, VK_IMAGE_LAYOUT_UNDEFINED, layout);
    if (picture.info().format == format && picture.info().width == extent.width &&
        picture.info().height == extent.height) {
        copySame(buffer, picture.handle(), image, extent);
    } else if (isSrgb(picture.info().format) == isSrgb(format)) {
        stretch(buffer, picture, image, extent);
    } else { // a blit would convert; a copy does not
        const VkFormat between = eightBit(isBlueFirst(format), isSrgb(picture.info().format));
        if (!coded_.valid() || coded_.info().width != extent.width || coded_.info().height != extent.height ||
            coded_.info().format != between)
            coded_ = gpu::Image(*device,
                                {extent.width, extent.height, 1, between,
                                 VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                                     VK_IMAGE_USAGE_SAMPLED_BIT},
                                "coded picture");
        moveLayout(buffer, coded_.handle(), VK_IMAGE_LAYOUT_UNDEFINED, layout);
        stretch(buffer, picture, coded_.handle(), extent);
        moveLayout(buffer, coded_.handle(), layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
        copySame(buffer, coded_.handle(), image, extent);
    }
    if (keepCopy) {
        if (!swapchain->canBeRead())
            throw gpu::Error("the window's images cannot be copied for the host (TRANSFER_SRC)");
        copy_ = gpu::Buffer(*device, size_t{4} * extent.width * extent.height, "shown", gpu::Place::host);
        copiedExtent_ = extent;
        copiedFormat_ = format;
        moveLayout(buffer, image, layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
        layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
        VkBufferImageCopy region{};
        region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
        region.imageExtent = {extent.width, extent.height, 1};
        vkCmdCopyImageToBuffer(buffer, image, layout, copy_.handle(), 1, &region);
    }
    moveLayout(buffer, image, layout, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR);
}

std::optional<passes::Image8> Window::copied() const {
    if (!copy_.valid()) return std::nullopt;
    const bool blueFirst = isBlueFirst(copiedFormat_);
    passes::Image8 picture{static_cast<int>(copiedExtent_.width), static_cast<int>(copiedExtent_.height), {}};
    const uint8_t* from = copy_.mapped<uint8_t>();
    const size_t count = size_t{copiedExtent_.width} * copiedExtent_.height;
    picture.rgb.reserve(3 * count);
    for (size_t k = 0; k < count; ++k, from += 4) {
        const std::array<uint8_t, 3> rgb{from[blueFirst ? 2 : 0], from[1], from[blueFirst ? 0 : 2]};
        picture.rgb.insert(picture.rgb.end(), rgb.begin(), rgb.end());
    }
    return picture;
}

} // namespace heliodon::present
