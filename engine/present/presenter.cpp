#include "engine/present/presenter.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

#include "compute/gpu/buffer.h"
#include "compute/gpu/commands.h"
#include "compute/gpu/error.h"
#include "compute/gpu/image.h"
#include "engine/present/swapchain.h"
#include "geometry/input_error.h"

#define GLFW_INCLUDE_VULKAN
#include <GLFW/glfw3.h>

namespace heliodon::present {

namespace {

// GLFW is one per process; it stays open as long as the process does.
void openWindowSystem() {
    static const bool open = glfwInit() == GLFW_TRUE;
    if (open) return;
    const char* why = nullptr;
    glfwGetError(&why);
    throw std::runtime_error(std::string("no display can be opened for windows: ") +
                             (why ? why : "no reason given"));
}

std::vector<GLFWmonitor*> monitors() {
    int count = 0;
    GLFWmonitor** list = glfwGetMonitors(&count);
    return {list, list + count};
}

GLFWmonitor* monitorNamed(const std::string& name) {
    if (name.empty()) return nullptr;
    std::string known;
    for (GLFWmonitor* monitor : monitors()) {
        if (name == glfwGetMonitorName(monitor)) return monitor;
        known += std::string(known.empty() ? "" : ", ") + glfwGetMonitorName(monitor);
    }
    throw geometry::InputError("display", name,
                               "is not connected, expected one of: " + (known.empty() ? "(none)" : known));
}

struct Window {
    GLFWwindow* handle = nullptr;
    std::unique_ptr<Swapchain> swapchain;
    std::string reason;
    gpu::Image upload; // for pictures from host memory
    gpu::Buffer staging, copy;
    VkExtent2D copied{};
    VkFormat copiedFormat = VK_FORMAT_UNDEFINED;

    Window() = default;
    Window(Window&&) = default;
    Window& operator=(Window&&) = delete;
    ~Window() { close(""); }
    void close(const std::string& why) {
        swapchain.reset();
        if (handle) glfwDestroyWindow(handle);
        handle = nullptr;
        if (reason.empty()) reason = why;
    }
    // Images of the right size; false while there is nothing to draw to.
    bool makeReady() {
        if (!handle) return false;
        int width = 0, height = 0;
        glfwGetFramebufferSize(handle, &width, &height);
        if (width <= 0 || height <= 0 || glfwGetWindowAttrib(handle, GLFW_ICONIFIED)) return false;
        return swapchain->ready() ||
               swapchain->rebuild(static_cast<uint32_t>(width), static_cast<uint32_t>(height));
    }
};

void moveLayout(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to,
                VkPipelineStageFlags2 stageBefore, VkAccessFlags2 accessBefore,
                VkPipelineStageFlags2 stageAfter, VkAccessFlags2 accessAfter) {
    VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
    barrier.srcStageMask = stageBefore;
    barrier.srcAccessMask = accessBefore;
    barrier.dstStageMask = stageAfter;
    barrier.dstAccessMask = accessAfter;
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

} // namespace

gpu::DeviceOptions withWindows(gpu::DeviceOptions options) {
    openWindowSystem();
    uint32_t count = 0;
    const char** names = glfwGetRequiredInstanceExtensions(&count);
    if (!names) throw std::runtime_error("the window system has no way to show Vulkan pictures");
    options.instanceExtensions.insert(options.instanceExtensions.end(), names, names + count);
    options.swapchains = true;
    return options;
}

std::vector<std::string> displayNames() {
    openWindowSystem();
    std::vector<std::string> names;
    for (GLFWmonitor* monitor : monitors()) names.emplace_back(glfwGetMonitorName(monitor));
    return names;
}

struct Presenter::State {
    explicit State(gpu::Device& d) : device(&d) {
        const VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
        for (VkSemaphore& semaphore : written)
            gpu::check(vkCreateSemaphore(d.handle(), &info, nullptr, &semaphore), "vkCreateSemaphore");
    }
    ~State() {
        windows.clear(); // waits for the queue
        vkQueueWaitIdle(device->queue());
        for (VkSemaphore semaphore : written) vkDestroySemaphore(device->handle(), semaphore, nullptr);
    }
    void addWindow(const WindowOptions& options);
    void record(gpu::Commands& commands, Window& window, const gpu::Image& picture, uint32_t index);

    gpu::Device* device;
    std::vector<Window> windows;
    // Signalled when a frame's images are written. A ring: the presentation that waits for one has ended long
    // before its turn comes again, as no swapchain has that many images.
    std::array<VkSemaphore, 16> written{};
    size_t turn = 0;
    bool keepCopies = false;
};

void Presenter::State::addWindow(const WindowOptions& options) {
    GLFWmonitor* monitor = monitorNamed(options.display);
    int width = options.width, height = options.height;
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE); // a projector keeps its picture while others are used
    glfwWindowHint(GLFW_FOCUS_ON_SHOW, monitor ? GLFW_FALSE : GLFW_TRUE);
    if (const GLFWvidmode* mode = monitor ? glfwGetVideoMode(monitor) : nullptr) {
        glfwWindowHint(GLFW_REFRESH_RATE, mode->refreshRate);
        width = mode->width, height = mode->height;
    }
    Window& window = windows.emplace_back();
    window.handle = glfwCreateWindow(width, height, options.title.c_str(), monitor, nullptr);
    const char* why = nullptr;
    if (!window.handle) {
        glfwGetError(&why);
        throw std::runtime_error(
            fmt::format("window '{}' cannot be opened: {}", options.title, why ? why : ""));
    }
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    gpu::check(glfwCreateWindowSurface(device->instance(), window.handle, nullptr, &surface),
               "glfwCreateWindowSurface");
    window.swapchain = std::make_unique<Swapchain>(*device, surface, options.waitForRefresh);
}

Presenter::Presenter(gpu::Device& device, const std::vector<WindowOptions>& windows) {
    openWindowSystem();
    state_ = std::make_unique<State>(device);
    state_->windows.reserve(windows.size());
    for (const WindowOptions& options : windows) state_->addWindow(options);
}
Presenter::Presenter(Presenter&&) noexcept = default;
Presenter& Presenter::operator=(Presenter&&) noexcept = default;
Presenter::~Presenter() = default;

size_t Presenter::size() const {
    return state_->windows.size();
}

WindowState Presenter::state(size_t i) const {
    const Window& window = state_->windows[i];
    if (!window.handle) return WindowState::closed;
    return glfwGetWindowAttrib(window.handle, GLFW_ICONIFIED) ? WindowState::hidden : WindowState::open;
}

bool Presenter::anyOpen() const {
    return std::any_of(state_->windows.begin(), state_->windows.end(),
                       [](const Window& w) { return w.handle; });
}

const std::string& Presenter::reason(size_t window) const {
    return state_->windows[window].reason;
}

void Presenter::pollEvents() {
    glfwPollEvents();
    for (Window& window : state_->windows) {
        if (!window.handle) continue;
        if (glfwWindowShouldClose(window.handle)) {
            window.close("closed by the user");
            continue;
        }
        int width = 0, height = 0;
        glfwGetFramebufferSize(window.handle, &width, &height);
        const VkExtent2D extent = window.swapchain->extent();
        if (static_cast<uint32_t>(width) != extent.width || static_cast<uint32_t>(height) != extent.height)
            window.swapchain->markStale();
    }
}

void Presenter::resize(size_t window, int width, int height) {
    if (state_->windows[window].handle) glfwSetWindowSize(state_->windows[window].handle, width, height);
}

void Presenter::close(size_t window) {
    state_->windows[window].close("closed by the program");
}

void Presenter::State::record(gpu::Commands& commands, Window& window, const gpu::Image& picture,
                              uint32_t index) {
    constexpr auto kCopy = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
    const VkCommandBuffer buffer = commands.handle();
    const VkImage image = window.swapchain->image(index);
    const VkExtent2D extent = window.swapchain->extent();
    moveLayout(buffer, image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, kCopy, 0,
               kCopy, VK_ACCESS_2_TRANSFER_WRITE_BIT);
    stretch(buffer, picture, image, extent);
    VkImageLayout layout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    if (keepCopies) {
        window.copy =
            gpu::Buffer(*device, size_t{4} * extent.width * extent.height, "shown", gpu::Place::host);
        window.copied = extent;
        window.copiedFormat = window.swapchain->format();
        moveLayout(buffer, image, layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, kCopy,
                   VK_ACCESS_2_TRANSFER_WRITE_BIT, kCopy, VK_ACCESS_2_TRANSFER_READ_BIT);
        layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
        VkBufferImageCopy region{};
        region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
        region.imageExtent = {extent.width, extent.height, 1};
        vkCmdCopyImageToBuffer(buffer, image, layout, window.copy.handle(), 1, &region);
        commands.barrier(gpu::Stage::transfer, gpu::Stage::host);
    }
    moveLayout(buffer, image, layout, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, kCopy,
               VK_ACCESS_2_TRANSFER_WRITE_BIT | VK_ACCESS_2_TRANSFER_READ_BIT, VK_PIPELINE_STAGE_2_NONE, 0);
}

size_t Presenter::present(const std::vector<const gpu::Image*>& pictures) {
    if (pictures.size() != size())
        throw std::invalid_argument(
            fmt::format("{} windows were given {} pictures", size(), pictures.size()));
    std::vector<Window*> shown;
    std::vector<VkSwapchainKHR> swapchains;
    std::vector<uint32_t> indices;
    gpu::Commands commands(*state_->device);
    for (size_t i = 0; i < pictures.size(); ++i) {
        Window& window = state_->windows[i];
        if (!pictures[i]) continue;
        uint32_t index = 0;
        VkResult result = VK_ERROR_OUT_OF_DATE_KHR;
        // A window that is being dragged may be out of date again at once: next frame, then.
        for (int attempt = 0; attempt < 3 && result == VK_ERROR_OUT_OF_DATE_KHR && window.makeReady();
             ++attempt) {
            result = window.swapchain->acquire(index);
            if (result == VK_ERROR_OUT_OF_DATE_KHR) window.swapchain->markStale();
        }
        if (result == VK_ERROR_SURFACE_LOST_KHR) window.close("its display went away");
        if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_ERROR_SURFACE_LOST_KHR) continue;
        gpu::check(result, "vkAcquireNextImageKHR");
        state_->record(commands, window, *pictures[i], index);
        shown.push_back(&window);
        swapchains.push_back(window.swapchain->handle());
        indices.push_back(index);
    }
    if (shown.empty()) return 0;
    VkSemaphore written = state_->written[state_->turn++ % state_->written.size()];
    const uint64_t ticket =
        state_->device->submit(std::move(commands), VK_NULL_HANDLE, VK_PIPELINE_STAGE_2_NONE, written);
    std::vector<VkResult> results(shown.size(), VK_SUCCESS);
    VkPresentInfoKHR info{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
    info.waitSemaphoreCount = 1;
    info.pWaitSemaphores = &written;
    info.swapchainCount = static_cast<uint32_t>(swapchains.size());
    info.pSwapchains = swapchains.data();
    info.pImageIndices = indices.data();
    info.pResults = results.data();
    const VkResult overall = vkQueuePresentKHR(state_->device->queue(), &info);
    if (overall == VK_ERROR_DEVICE_LOST) gpu::check(overall, "vkQueuePresentKHR");
    size_t count = 0;
    for (size_t i = 0; i < shown.size(); ++i) {
        if (results[i] == VK_ERROR_OUT_OF_DATE_KHR || results[i] == VK_SUBOPTIMAL_KHR)
            shown[i]->swapchain->markStale();
        else if (results[i] == VK_ERROR_SURFACE_LOST_KHR)
            shown[i]->close("its display went away");
        else
            gpu::check(results[i], "vkQueuePresentKHR");
        count += results[i] >= VK_SUCCESS;
    }
    state_->device->wait(ticket);
    return count;
}

size_t Presenter::present(const std::vector<passes::Image8>& pictures) {
    std::vector<const gpu::Image*> images(pictures.size(), nullptr);
    gpu::Commands commands(*state_->device);
    for (size_t i = 0; i < std::min(pictures.size(), size()); ++i) {
        const passes::Image8& picture = pictures[i];
        Window& window = state_->windows[i];
        if (!window.handle || picture.rgb.empty()) continue;
        const auto width = static_cast<uint32_t>(picture.width),
                   height = static_cast<uint32_t>(picture.height);
        if (!window.upload.valid() || window.upload.info().width != width ||
            window.upload.info().height != height) {
            window.upload = gpu::Image(*state_->device,
                                       {width, height, 1, VK_FORMAT_R8G8B8A8_SRGB,
                                        VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                                            VK_IMAGE_USAGE_SAMPLED_BIT},
                                       "window upload");
            window.staging =
                gpu::Buffer(*state_->device, size_t{4} * width * height, "window staging", gpu::Place::host);
        }
        uint8_t* to = window.staging.mapped<uint8_t>();
        for (size_t k = 0; k < picture.rgb.size(); k += 3, to += 4) {
            std::memcpy(to, &picture.rgb[k], 3);
            to[3] = 255;
        }
        using gpu::Stage;
        commands.transition(window.upload, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                            Stage::transfer, Stage::transfer);
        VkBufferImageCopy region{};
        region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
        region.imageExtent = {width, height, 1};
        vkCmdCopyBufferToImage(commands.handle(), window.staging.handle(), window.upload.handle(),
                               VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
        commands.transition(window.upload, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                            VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, Stage::transfer, Stage::transfer);
        images[i] = &window.upload;
    }
    state_->device->submit(std::move(commands));
    return present(images);
}

void Presenter::keepCopies(bool keep) {
    state_->keepCopies = keep;
}

std::optional<passes::Image8> Presenter::lastShown(size_t i) const {
    const Window& window = state_->windows[i];
    if (!window.copy.valid()) return std::nullopt;
    const bool blueFirst = window.copiedFormat == VK_FORMAT_B8G8R8A8_SRGB;
    passes::Image8 picture{static_cast<int>(window.copied.width), static_cast<int>(window.copied.height), {}};
    const uint8_t* from = window.copy.mapped<uint8_t>();
    const size_t count = size_t{window.copied.width} * window.copied.height;
    for (size_t k = 0; k < count; ++k, from += 4) {
        const std::array<uint8_t, 3> rgb{from[blueFirst ? 2 : 0], from[1], from[blueFirst ? 0 : 2]};
        picture.rgb.insert(picture.rgb.end(), rgb.begin(), rgb.end());
    }
    return picture;
}

} // namespace heliodon::present
