// Where a window belongs on the desktop: it stays there while displays come, go, change their size and are
// moved. Internal to engine/present.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/present/presenter.h"

struct GLFWwindow;

namespace heliodon::present {

class Placement {
public:
    // Of a window that was opened hidden; follow() shows it. Both outlive this.
    Placement(GLFWwindow* window, const WindowOptions& options);

    // With the displays that there are now: a window that names a display fills that one, any other stays on
    // the one that it lies on. Whose display is gone is an ordinary window on `spare`, and hidden while that
    // is null. To be called again and again, as window managers may do something else, and later. True when
    // the window has been moved.
    bool follow(const std::vector<Display>& connected, const Display* spare);
    // On the display that it names, else the one that it lies on.
    void setFullScreen(bool full);

    bool away() const { return away_; }       // hidden
    bool missing() const { return missing_; } // its display
    const std::string& notice() const { return notice_; }
    // When follow() was called last; none where it had to move the window, which takes managers some time.
    std::optional<Display> covers() const { return settled_ ? std::optional(covers_) : std::nullopt; }

private:
    bool stayOn(const Display& own);
    bool retreat(const std::vector<Display>& connected, const Display* spare);
    void fill(const Display& display);
    void open(int x, int y, int width, int height); // as an ordinary window, there
    // The same where options say, but no pixel of it outside.
    void openWithin(const Display& display, int width, int height);
    void show();

    GLFWwindow* window_;
    const WindowOptions& options_;
    std::vector<Display> connected_; // when follow() was called last
    Display home_;                   // as it was then
    Display covers_;
    bool settled_ = false;
    int offsetX_ = 0, offsetY_ = 0; // of an ordinary window from its display's corner
    bool full_ = false;             // wanted
    bool missing_ = false, away_ = true;
    std::string refuge_; // the spare display that it is on meanwhile
    int attempts_ = 0;   // to get where it belongs, displays being as they are
    std::string notice_;
};

} // namespace heliodon::present
