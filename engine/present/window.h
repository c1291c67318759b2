// One window: its handle, its swapchain and what became of its display. Internal to engine/present.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "compute/gpu/buffer.h"
#include "compute/gpu/image.h"
#include "engine/present/placement.h"
#include "engine/present/presenter.h"
#include "engine/present/swapchain.h"

struct GLFWwindow;

namespace heliodon::gpu {
class Commands;
}

namespace heliodon::present {

class Window {
public:
    // Opens it, hidden until it is placed.
    Window(gpu::Device& device, const WindowOptions& options);
    Window(const Window&) = delete; // listeners know its address
    Window& operator=(const Window&) = delete;
    ~Window() { close(""); }
    void close(const std::string& why); // for good; the first reason is kept

    // An image to write into; none while there is nothing to draw to.
    std::optional<uint32_t> acquire();
    // What came of showing it. True when it is shown.
    bool presented(VkResult result);
    // Closes it when the user wants that; follows its size.
    void update();
    void place(const std::vector<Display>& connected, const Display* spare); // see Placement::follow
    void setFullScreen(bool full);
    bool fullScreen() const;
    bool hidden() const;
    VkExtent2D pixels() const { return askSize().value_or(VkExtent2D{}); } // of one that is open

    // Writes `picture` into the swapchain's image, stretched, and keeps a copy for the host if wanted. The
    // picture's bytes are taken as coded for the display, whichever of the two has an sRGB format.
    void record(gpu::Commands& commands, const gpu::Image& picture, uint32_t index, bool keepCopy);
    std::optional<passes::Image8> copied() const;

    gpu::Device* device;
    WindowOptions options;
    GLFWwindow* handle = nullptr;
    std::unique_ptr<Swapchain> swapchain;
    std::string reason;                 // why it was closed
    std::optional<Placement> placement; // while it is open
    std::function<void()> beforeClose;  // of whoever listens to the handle
    bool damaged = true;                // shows nothing, or not what it was last given

private:
    std::optional<VkExtent2D> askSize() const; // none of one that another program has destroyed
    void openSurface();
    bool makeReady(); // images of the right size
    void surfaceLost();

    bool surfaceLost_ = false; // since it was presented last
    // What images were asked for last, and the size at which they were made anew for fitting badly: systems
    // may give others, and go on calling them suboptimal.
    VkExtent2D asked_{}, suboptimal_{};
    gpu::Image coded_; // where picture and swapchain differ in format, a picture of the window's size between
    gpu::Buffer copy_;
    VkExtent2D copiedExtent_{};
    VkFormat copiedFormat_ = VK_FORMAT_UNDEFINED;
};

} // namespace heliodon::present
