// What a Presenter holds. Internal to engine/present.
#pragma once

#include <array>
#include <chrono>
#include <deque>
#include <vector>

#include "engine/present/window.h"

struct GLFWmonitor;

namespace heliodon::present {

struct Presenter::State {
    explicit State(gpu::Device& device);
    ~State();
    size_t indexOf(GLFWwindow* handle) const;
    void destroySemaphores();
    // Windows keep to their displays: at once when one comes or goes, else about every half second, as asking
    // takes the server some time.
    void followDisplays();

    gpu::Device* device;
    std::deque<Window> windows; // each stays where it is
    std::vector<GLFWmonitor*> followed;
    std::chrono::steady_clock::time_point followedAt{};
    std::vector<Event> events; // since the last pollEvents
    // Signalled when a frame's images are written. A ring: the presentation that waits for one has ended long
    // before its turn comes again, as no swapchain has that many images.
    std::array<VkSemaphore, 16> written{};
    size_t turn = 0;
    bool keepCopies = false;
};

} // namespace heliodon::present
