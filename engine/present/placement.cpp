#include "engine/present/placement.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/present/desktop.h"
#include "engine/present/window_manager.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace heliodon::present {

namespace {

// Window managers take their time, and may have a will of their own.
constexpr int kAttempts = 6;

} // namespace

Placement::Placement(GLFWwindow* window, const WindowOptions& options)
    : window_(window), options_(options), full_(!options.display.empty()) {
    home_.name = options.display;
    if (options.position && options.display.empty())
        glfwSetWindowPos(window, (*options.position)[0], (*options.position)[1]);
}

bool Placement::follow(const std::vector<Display>& connected, const Display* spare) {
    const bool sameDesktop = std::exchange(connected_, connected) == connected;
    covers_ = partCoveredBy(window_);
    if (options_.display.empty() && !missing_ && (sameDesktop || home_.name.empty())) {
        if (const Display* under = findUnder(connected, covers_)) { // its user may have moved it
            home_ = *under;
        } else if (home_.name.empty() && !connected.empty()) { // it was asked for where nobody would see it
            home_ = spare ? *spare : connected.front();
            openWithin(home_, options_.width, options_.height);
            covers_ = partCoveredBy(window_);
        }
        if (away_ && !home_.name.empty()) show();
    }
    if (sameDesktop && !full_ && !missing_) offsetX_ = covers_.x - home_.x, offsetY_ = covers_.y - home_.y;
    const Display* own = findNamed(connected, home_.name);
    settled_ = !(own ? stayOn(*own) : retreat(connected, spare));
    return !settled_;
}

bool Placement::stayOn(const Display& own) {
    const bool returned = std::exchange(missing_, false);
    if (returned) full_ = !options_.display.empty(), notice_.clear();
    const bool changed = returned || own != home_;
    home_ = own;
    if (changed) attempts_ = 0;
    if (!full_) {
        notice_.clear();
        if (changed) open(own.x + offsetX_, own.y + offsetY_, covers_.width, covers_.height);
        return changed;
    }
    if (covers_ == own) {
        notice_.clear();
        return false;
    }
    if (attempts_ == kAttempts) {
        notice_ = fmt::format("display '{}' is not filled: the window manager keeps the window at {} x {} "
                              "pixels from ({}, {}) on",
                              own.name, covers_.width, covers_.height, covers_.x, covers_.y);
        return false;
    }
    ++attempts_;
    fill(own);
    return true;
}

bool Placement::retreat(const std::vector<Display>& connected, const Display* spare) {
    const std::string refuge = spare ? spare->name : "";
    const bool changed = !std::exchange(missing_, true) || refuge != refuge_;
    if (changed) attempts_ = 0;
    const Display* under = findUnder(connected, covers_);
    const bool elsewhere = !away_ && under && under->name != refuge && !full_; // where it spoils a picture
    if (!changed && !elsewhere) return false;
    refuge_ = refuge;
    full_ = false;
    // A window that is shown anew is full-screen for no window manager.
    glfwSetWindowMonitor(window_, nullptr, 0, 0, options_.width, options_.height, GLFW_DONT_CARE);
    glfwHideWindow(window_);
    away_ = true;
    if (spare && attempts_++ < kAttempts)
        openWithin(*spare, spare->width / 2, spare->height / 2); // beside others
    if (home_.name.empty()) return true; // an ordinary window of a desktop that had no display at the start
    std::vector<std::string> names;
    for (const Display& display : connected) names.push_back(display.name);
    notice_ = fmt::format("display '{}' is not connected (connected: {}): {}", home_.name,
                          names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", ")),
                          away_ ? "not shown meanwhile" : "shown in a window on '" + refuge + "'");
    return true;
}

// Window managers fill the display that a window lies on, whatever else they are told; so it is put there
// first, well within, where none has reason to move it from.
void Placement::fill(const Display& display) {
    open(display.x + display.width / 4, display.y + display.height / 4, display.width / 2,
         display.height / 2);
    GLFWmonitor* monitor = monitorNamed(display.name);
    const GLFWvidmode* mode = monitor ? glfwGetVideoMode(monitor) : nullptr;
    if (!mode) return;
    glfwSetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
    askToFill(window_, display);
}

void Placement::open(int x, int y, int width, int height) {
    glfwSetWindowMonitor(window_, nullptr, x, y, width, height, GLFW_DONT_CARE);
    if (away_) glfwSetWindowPos(window_, x, y); // says that it is the user's wish, unlike the call before
    show();
}

void Placement::openWithin(const Display& display, int width, int height) {
    width = std::min({width, options_.width, display.width});
    height = std::min({height, options_.height, display.height});
    const auto [x, y] = options_.position.value_or(std::array<int, 2>{});
    open(display.x + std::clamp(x, 0, display.width - width),
         display.y + std::clamp(y, 0, display.height - height), width, height);
}

void Placement::show() {
    if (std::exchange(away_, false)) glfwShowWindow(window_);
}

void Placement::setFullScreen(bool full) {
    const Display* display = findNamed(connected_, options_.display);
    if (!display) display = findUnder(connected_, partCoveredBy(window_));
    full_ = full && display;
    attempts_ = 0;
    if (full_)
        fill(*display);
    else if (display)
        open(display->x + 60, display->y + 60, options_.width, options_.height);
}

} // namespace heliodon::present
