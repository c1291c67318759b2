// Several windows of one process, each with a swapchain, shown together: one per projector, and more
// for an operator. Windows may be resized, minimised, closed by the user or lose their display at any time;
// the others go on. Once a member throws gpu::Error, or std::runtime_error as the display server is gone, a
// presenter is fit for nothing but destruction.
#pragma once

#include <array>
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

struct Display {
    std::string name;                        // as a rig's `display` may name it
    int x = 0, y = 0, width = 0, height = 0; // on the desktop, pixels
    bool operator==(const Display&) const = default;
};
// The connected ones; the first is the primary one.
std::vector<Display> displays();
// How much of the desktop both show.
long sharedPixels(const Display& a, const Display& b);

struct WindowOptions {
    std::string title = "heliodon";
    int width = 1024, height = 768; // of the picture, pixels; of the window unless it fills a display
    std::string display;            // fills this display while it is connected; empty: an ordinary window
    // Of the window's top left corner on the desktop; of one that is to fill a display, on the one that it is
    // shown on while that is missing. None: the system's choice.
    std::optional<std::array<int, 2>> position;
    bool waitForRefresh = true; // false: as fast as the machine goes, may tear
    // Takes a format without sRGB even where there is one, as on displays that have no other.
    bool codeBefore = false;
};

enum class WindowState {
    open,
    hidden, // minimised, or no display is left for it: nothing is shown until it comes back
    closed  // by the user, or its display went away; for good
};

// What the user did in one of the windows.
struct Event {
    enum class Kind { wheel, key } kind = Kind::key;
    size_t window = 0;
    double notches = 0; // of the wheel, away from the user positive
    int key = 0;        // capital letter, digit, ' ', or one of the constants below
    bool shift = false, control = false;
};
constexpr int kEscapeKey = 27, kLeftKey = 1, kRightKey = 2, kUpKey = 3, kDownKey = 4;

constexpr const char* kDisplayLost = "its display went away";

class Presenter {
public:
    // Throws gpu::Error when the device cannot present to a window or has no 8-bit format for it. A window
    // whose display is not connected is shown as an ordinary one on a display that none is to fill, is hidden
    // where there is none, and has a notice. Displays may come and go, change their size and be moved.
    Presenter(gpu::Device& device, const std::vector<WindowOptions>& windows);
    Presenter(Presenter&&) noexcept;
    Presenter& operator=(Presenter&&) noexcept;
    ~Presenter();

    size_t size() const;
    WindowState state(size_t window) const;
    // Why a window was closed, for the report; empty while it is open. kDisplayLost: nobody wanted it.
    const std::string& reason(size_t window) const;
    // What is not as it was wanted, now: names the display that is missing and those that are connected, or
    // the one that the window manager does not let it fill.
    const std::string& notice(size_t window) const;
    bool displayMissing(size_t window) const;
    // What of the desktop it covers, as of half a second ago; the name is that of the display that it fills.
    // None while it is not open, or on its way.
    std::optional<Display> covers(size_t window) const;
    // It has lost what it showed, or never showed anything: it wants a picture though there is no new one.
    bool damaged(size_t window) const;
    bool fullScreen(size_t window) const;

    // Handles what the user did and returns what concerns the program; waits up to so long for something to
    // happen. Call it about once a frame, from the thread that made the presenter.
    std::vector<Event> pollEvents(double waitSeconds = 0);
    void resize(size_t window, int width, int height);
    void setFullScreen(size_t window, bool full);
    void close(size_t window, const std::string& why = "closed by the program");

    // Shows one picture per window, all by a single presentation; null leaves a window as it is. Pictures are
    // 8-bit images in TRANSFER_SRC_OPTIMAL on the presenter's device, submitted before; their bytes are coded
    // for the display, by an sRGB format or, in UNORM ones, by whoever made them. They are stretched where a
    // window has another size. Returns how many windows show something new.
    size_t present(const std::vector<const gpu::Image*>& pictures);

    // What the window's swapchain image held at the latest presentation after `keepCopies(true)`.
    void keepCopies(bool keep);
    std::optional<passes::Image8> lastShown(size_t window) const;

    struct State; // of this folder
    State& internals() { return *state_; }

private:
    std::unique_ptr<State> state_;
};

// Ends the waiting of pollEvents. From any thread.
void wakeUp();

// A picture on the device, sRGB, in TRANSFER_SRC_OPTIMAL, finished.
gpu::Image uploaded(gpu::Device& device, const passes::Image8& picture, const std::string& name);

} // namespace heliodon::present
