// Several windows of one process, each with an sRGB swapchain, shown together: one per projector, and more
// for an operator. Windows may be resized, minimised, closed by the user or lose their display at any time;
// the others go on.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compute/gpu/device.h"
#include "engine/passes/picture.h"

namespace heliodon::gpu {
class Image;
}

namespace heliodon::present {

// `options` with what windows need of the instance and the device. Opens the connection to the display
// server; throws std::runtime_error, with the window system's own words, when there is none.
gpu::DeviceOptions withWindows(gpu::DeviceOptions options);

// Names of the connected displays, as a rig's `display` may name them; the first is the primary one.
std::vector<std::string> displayNames();

struct WindowOptions {
    std::string title = "heliodon";
    int width = 1024, height = 768; // of the picture, pixels; of the window unless it fills a display
    std::string display;            // fills this display; empty: an ordinary window
    bool waitForRefresh = true;     // false: as fast as the machine goes, may tear
};

enum class WindowState {
    open,
    hidden, // minimised: nothing is shown until it comes back
    closed  // by the user, or its display went away; for good
};

class Presenter {
public:
    // Throws geometry::InputError naming a display that is not connected (and those that are), gpu::Error
    // when the device cannot present to a window or has no sRGB format for it.
    Presenter(gpu::Device& device, const std::vector<WindowOptions>& windows);
    Presenter(Presenter&&) noexcept;
    Presenter& operator=(Presenter&&) noexcept;
    ~Presenter();

    size_t size() const;
    WindowState state(size_t window) const;
    bool anyOpen() const;
    // Why a window was closed, for the report; empty while it is open.
    const std::string& reason(size_t window) const;

    // Handles what the user did; call it about once a frame, from the thread that made the presenter.
    void pollEvents();
    void resize(size_t window, int width, int height);
    void close(size_t window);

    // Shows one picture per window, all by a single presentation; null leaves a window as it is. Pictures are
    // sRGB images in TRANSFER_SRC_OPTIMAL on the presenter's device, finished or submitted before; they are
    // stretched where a window has another size. Returns how many windows show something new.
    size_t present(const std::vector<const gpu::Image*>& pictures);
    // The same from host memory; sRGB-encoded.
    size_t present(const std::vector<passes::Image8>& pictures);

    // What the window's swapchain image held at the latest presentation after `keepCopies(true)`.
    void keepCopies(bool keep);
    std::optional<passes::Image8> lastShown(size_t window) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace heliodon::present
