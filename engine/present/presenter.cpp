#include "engine/present/presenter.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "compute/gpu/commands.h"
#include "compute/gpu/error.h"
#include "engine/present/desktop.h"
#include "engine/present/display_server.h"
#include "engine/present/presenter_state.h"

#define GLFW_INCLUDE_VULKAN
#include <GLFW/glfw3.h>

namespace heliodon::present {

namespace {

int keyOf(int key) {
    switch (key) {
    case GLFW_KEY_ESCAPE:
        return kEscapeKey;
    case GLFW_KEY_LEFT:
        return kLeftKey;
    case GLFW_KEY_RIGHT:
        return kRightKey;
    case GLFW_KEY_UP:
        return kUpKey;
    case GLFW_KEY_DOWN:
        return kDownKey;
    default:
        return key >= ' ' && key <= 'Z' ? key : 0; // GLFW's printable keys are their ASCII capitals
    }
}

// C callbacks of GLFW; nothing throws across them but std::bad_alloc.
Presenter::State* stateOf(GLFWwindow* handle) {
    return static_cast<Presenter::State*>(glfwGetWindowUserPointer(handle));
}

bool isDown(GLFWwindow* handle, int left, int right) {
    return glfwGetKey(handle, left) == GLFW_PRESS || glfwGetKey(handle, right) == GLFW_PRESS;
}

void onWheel(GLFWwindow* handle, double across, double down) {
    Presenter::State* state = stateOf(handle);
    // Some systems turn the wheel sideways while shift is held.
    state->events.push_back({Event::Kind::wheel, state->indexOf(handle), down != 0 ? down : across, 0,
                             isDown(handle, GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT),
                             isDown(handle, GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL)});
}

void onKey(GLFWwindow* handle, int key, int, int action, int modifiers) {
    Presenter::State* state = stateOf(handle);
    const int name = keyOf(key);
    const bool arrow = name >= kLeftKey && name <= kDownKey;
    if (name == 0 || !(action == GLFW_PRESS || (action == GLFW_REPEAT && arrow))) return;
    state->events.push_back({Event::Kind::key, state->indexOf(handle), 0, name,
                             (modifiers & GLFW_MOD_SHIFT) != 0, (modifiers & GLFW_MOD_CONTROL) != 0});
}

void onRefresh(GLFWwindow* handle) {
    Presenter::State* state = stateOf(handle);
    state->windows[state->indexOf(handle)].damaged = true;
}

} // namespace

gpu::DeviceOptions withWindows(gpu::DeviceOptions options) {
    openWindowSystem();
    uint32_t count = 0;
    const char** names = glfwGetRequiredInstanceExtensions(&count);
    if (!names)
        throw std::runtime_error(
            "no Vulkan driver here can show pictures in windows (heliodon devices lists what there is)");
    options.instanceExtensions.insert(options.instanceExtensions.end(), names, names + count);
    options.swapchains = true;
    return options;
}

Presenter::State::State(gpu::Device& d) : device(&d) {
    const VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    for (VkSemaphore& semaphore : written) {
        const VkResult result = vkCreateSemaphore(d.handle(), &info, nullptr, &semaphore);
        if (result == VK_SUCCESS) continue;
        destroySemaphores();
        gpu::check(result, "vkCreateSemaphore");
    }
}

Presenter::State::~State() {
    windows.clear(); // waits for the queue
    vkQueueWaitIdle(device->queue());
    destroySemaphores();
}

void Presenter::State::destroySemaphores() {
    for (VkSemaphore semaphore : written) vkDestroySemaphore(device->handle(), semaphore, nullptr);
}

size_t Presenter::State::indexOf(GLFWwindow* handle) const {
    const auto at = std::find_if(windows.begin(), windows.end(),
                                 [&](const Window& window) { return window.handle == handle; });
    return static_cast<size_t>(at - windows.begin());
}

void Presenter::State::followDisplays() {
    constexpr std::chrono::milliseconds kInterval{500};
    const auto now = std::chrono::steady_clock::now();
    if (followed == monitors() && now - followedAt < kInterval) return;
    const std::vector<Display> connected = displays();
    const auto isSpare = [&](const Display& display) {
        return std::ranges::none_of(windows,
                                    [&](const Window& w) { return w.options.display == display.name; });
    };
    const auto spare = std::ranges::find_if(connected, isSpare);
    for (Window& window : windows) {
        checkDisplayServer();
        window.place(connected, spare == connected.end() ? nullptr : &*spare);
    }
    followed = monitors();
    followedAt = now;
}

Presenter::Presenter(gpu::Device& device, const std::vector<WindowOptions>& windows) {
    openWindowSystem();
    state_ = std::make_unique<State>(device);
    for (const WindowOptions& options : windows) {
        GLFWwindow* handle = state_->windows.emplace_back(device, options).handle;
        glfwSetWindowUserPointer(handle, state_.get());
        glfwSetScrollCallback(handle, onWheel);
        glfwSetKeyCallback(handle, onKey);
        glfwSetWindowRefreshCallback(handle, onRefresh);
    }
    state_->followDisplays();
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
    return window.hidden() ? WindowState::hidden : WindowState::open;
}

const std::string& Presenter::reason(size_t window) const {
    return state_->windows[window].reason;
}

const std::string& Presenter::notice(size_t window) const {
    static const std::string none;
    const std::optional<Placement>& placement = state_->windows[window].placement;
    return placement ? placement->notice() : none;
}

bool Presenter::displayMissing(size_t window) const {
    const std::optional<Placement>& placement = state_->windows[window].placement;
    return placement && placement->missing();
}

std::optional<Display> Presenter::covers(size_t window) const {
    if (state(window) != WindowState::open) return std::nullopt;
    return state_->windows[window].placement->covers();
}

bool Presenter::damaged(size_t i) const {
    const Window& window = state_->windows[i];
    return window.handle && window.damaged;
}

bool Presenter::fullScreen(size_t window) const {
    return state_->windows[window].fullScreen();
}

std::vector<Event> Presenter::pollEvents(double waitSeconds) {
    if (waitSeconds > 0)
        glfwWaitEventsTimeout(waitSeconds);
    else
        glfwPollEvents();
    checkDisplayServer();
    for (Window& window : state_->windows) window.update();
    state_->followDisplays();
    return std::exchange(state_->events, {});
}

void Presenter::resize(size_t window, int width, int height) {
    if (state_->windows[window].handle) glfwSetWindowSize(state_->windows[window].handle, width, height);
}

void Presenter::setFullScreen(size_t window, bool full) {
    state_->windows[window].setFullScreen(full);
}

void Presenter::close(size_t window, const std::string& why) {
    state_->windows[window].close(why);
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
        const std::optional<uint32_t> index = window.acquire();
        if (!index) continue;
        window.record(commands, *pictures[i], *index, state_->keepCopies);
        shown.push_back(&window);
        swapchains.push_back(window.swapchain->handle());
        indices.push_back(*index);
    }
    if (shown.empty()) return 0;
    VkSemaphore written = state_->written[state_->turn++ % state_->written.size()];
    const uint64_t ticket = state_->device->submit(std::move(commands), written);
    std::vector<VkResult> results(shown.size(), VK_SUCCESS);
    VkPresentInfoKHR info{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
    info.waitSemaphoreCount = 1;
    info.pWaitSemaphores = &written;
    info.swapchainCount = static_cast<uint32_t>(swapchains.size());
    info.pSwapchains = swapchains.data();
    info.pImageIndices = indices.data();
    info.pResults = results.data();
    const VkResult overall = vkQueuePresentKHR(state_->device->queue(), &info);
    checkDisplayServer();
    // Errors that no single window explains; with them the windows' own results say nothing.
    if (overall != VK_ERROR_OUT_OF_DATE_KHR && overall != VK_ERROR_SURFACE_LOST_KHR)
        gpu::check(overall, "vkQueuePresentKHR");
    state_->device->wait(ticket);
    size_t count = 0;
    for (size_t i = 0; i < shown.size(); ++i) count += shown[i]->presented(results[i]);
    return count;
}

void Presenter::keepCopies(bool keep) {
    state_->keepCopies = keep;
}

std::optional<passes::Image8> Presenter::lastShown(size_t window) const {
    return state_->windows[window].copied();
}

void wakeUp() {
    if (!displayServerLost()) glfwPostEmptyEvent();
}

gpu::Image uploaded(gpu::Device& device, const passes::Image8& picture, const std::string& name) {
    const auto width = static_cast<uint32_t>(picture.width), height = static_cast<uint32_t>(picture.height);
    gpu::Image image(
        device,
        {width, height, 1, VK_FORMAT_R8G8B8A8_SRGB,
         VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT},
        name);
    const gpu::Buffer staging(device, size_t{4} * width * height, name + " staging", gpu::Place::host);
    uint8_t* to = staging.mapped<uint8_t>();
    for (size_t k = 0; k < picture.rgb.size(); k += 3, to += 4) {
        std::memcpy(to, &picture.rgb[k], 3);
        to[3] = 255;
    }
    using gpu::Stage;
    gpu::Commands commands(device);
    commands.transition(image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                        Stage::transfer, Stage::transfer);
    VkBufferImageCopy region{};
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageExtent = {width, height, 1};
    vkCmdCopyBufferToImage(commands.handle(), staging.handle(), image.handle(),
                           VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
    commands.transition(image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                        Stage::transfer, Stage::transfer);
    device.submitAndWait(std::move(commands));
    return image;
}

} // namespace heliodon::present
